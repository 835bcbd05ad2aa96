"""A win by hand, ready to become its level's solution."""

import dataclasses
import itertools
from typing import Any

from editor.play.mode import Mode
from editor.play.playback_view import Show
from kinetix.level.model import Level, Solution


@dataclasses.dataclass(frozen=True, kw_only=True)
class Win:
    """A level that a person has won from its start, with keys alone."""

    level: Level
    """As it was played."""
    solution: Solution
    """The actions that won it, and the physics they were played under."""
    tailored: bool
    """True if it was played in the step for this level alone."""

    @classmethod
    def of(cls, playback: Show) -> "Win | None":
        """Return the win on show; None where it is not one, or is an agent's or the mouse's too."""
        trace, level = playback.trace, playback.level
        if playback.mode is not Mode.ENDED or playback.outcome != "won":
            return None
        if playback.casting is not None or playback.perturbed or trace is None or level is None:
            return None
        if trace.snapshots[0].step != 0:
            return None
        last = trace.snapshots[-1]
        runs: Any = tuple((len(list(run)), each) for each, run in itertools.groupby(trace.actions))
        solution = Solution(physics=trace.physics, frame_skip=last.frame_skip, actions=runs)
        return cls(level=level, solution=solution, tailored=last.tailored)
