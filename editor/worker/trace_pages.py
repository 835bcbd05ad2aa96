"""Episodes of the editor as self-contained pages that any browser plays."""

import numpy as np

from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Mind, Snapshot, Trace
from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS, Level
from kinetix.pages.facts import draws_of, facts_of
from kinetix.pages.film import Film

SUFFIX = ".html"
_NOTHING = (0.0,) * (MOTOR_BINDINGS + THRUSTER_BINDINGS)


def film_of_trace(trace: Trace, level: Level) -> Film:
    """Return an episode as a page plays it.

    Args:
        trace: The episode.
        level: Its level.
    """
    moments = trace.snapshots
    first = moments[0].step * moments[0].frame_skip
    minds = [_thinking(moment) for moment in moments]
    return Film(
        level=level,
        title=trace.player or "A person",
        seconds=np.array([m.step * m.frame_skip - first for m in moments])
        / ENGINE_STEPS_PER_SECOND,
        position=np.stack([moment.position for moment in moments]),
        angle=np.stack([moment.angle for moment in moments]),
        actions=np.array([moment.action or _NOTHING for moment in moments]),
        value=np.array([np.nan if mind is None else mind.value for mind in minds]),
        entropy=np.array([np.nan if mind is None else mind.entropy for mind in minds]),
        outcome=moments[-1].outcome or "",
        facts=facts_of(
            level,
            trace.physics,
            player=trace.player,
            digest=trace.digest,
            draws=draws_of(trace.seed, trace.attempt, deterministic=trace.deterministic),
            perturbed=trace.perturbed,
        ),
    )


def _thinking(moment: Snapshot) -> Mind | None:
    """Return a network's outputs; None where none plays."""
    return None if moment.mind is None or moment.mind.scripted else moment.mind
