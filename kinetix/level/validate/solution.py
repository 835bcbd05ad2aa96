"""Recorded solutions that this release cannot play as they are."""

from collections.abc import Iterator

from kinetix.engine.names import PHYSICS
from kinetix.level.model import MOTOR_BINDINGS, Level
from kinetix.level.validate.issue import Issue, issue


def solution_issues(level: Level) -> Iterator[Issue]:
    """Yield what a recorded solution names and nothing here has (W214).

    The level itself is as good as without it, so that it still opens.
    """
    solution = level.solution
    if solution is None:
        return
    if solution.physics not in PHYSICS:
        message = (
            f"The recorded solution is of unknown physics {solution.physics!r}; "
            f"expected one of {', '.join(PHYSICS)}."
        )
        yield issue("W214", message, path="$.solution.physics")
    for run, (_, channels) in enumerate(solution.actions):
        for channel, choice in enumerate(channels):
            if channel >= MOTOR_BINDINGS and choice > 1:
                message = (
                    f"Thruster {channel - MOTOR_BINDINGS} of the recorded solution: "
                    f"expected 0 or 1, got {choice}, which counts as 0."
                )
                path = f"$.solution.actions[{run}][1][{channel}]"
                yield issue("W214", message, path=path)
                return
