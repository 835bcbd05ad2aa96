"""Episodes of the editor as self-contained pages that any browser plays."""

import numpy as np

from editor.worker.recording import ENGINE_STEPS_PER_SECOND, Mind, Snapshot, Trace
from kinetix.level.codec import level_hash
from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS, Level
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
    who = trace.player or "A person"
    mode = "likeliest actions" if trace.deterministic else "actions drawn from the policy"
    facts = [("level", f"{level.name}, {level_hash(level)[:12]}"), ("physics", trace.physics)]
    if trace.player:
        draws = f"attempt {trace.attempt}, seed {trace.seed}, {mode}"
        facts += [("player", f"{who} {trace.digest[:12]}".strip()), ("draws", draws)]
    if trace.perturbed:
        facts.append(("note", "somebody pulled at a body or took over"))
    return Film(
        level=level,
        title=who,
        seconds=np.array([m.step * m.frame_skip - first for m in moments])
        / ENGINE_STEPS_PER_SECOND,
        position=np.stack([moment.position for moment in moments]),
        angle=np.stack([moment.angle for moment in moments]),
        actions=np.array([moment.action or _NOTHING for moment in moments]),
        value=np.array([np.nan if mind is None else mind.value for mind in minds]),
        entropy=np.array([np.nan if mind is None else mind.entropy for mind in minds]),
        outcome=moments[-1].outcome or "",
        facts=tuple(facts),
    )


def _thinking(moment: Snapshot) -> Mind | None:
    """Return a network's outputs; None where none plays."""
    return None if moment.mind is None or moment.mind.scripted else moment.mind
