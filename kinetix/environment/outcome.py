"""The four ways in which an episode ends."""

from collections.abc import Mapping
from typing import Any, Final, Literal, TypeAlias, get_args

Outcome: TypeAlias = Literal["won", "lost", "timeout", "broken"]
"""Green touched blue; green touched red; neither in time; the physics became NaN before either."""

OUTCOMES: Final[tuple[Outcome, ...]] = get_args(Outcome)


def outcome_of(info: Mapping[str, Any]) -> Outcome | None:
    """Return how a step ended its episode, or None where the episode goes on.

    Args:
        info: From `KinetixEnv.step`, of one world.
    """
    index = int(outcome_index(info))
    return OUTCOMES[index - 1] if index else None


def outcome_index(info: Mapping[str, Any]) -> Any:
    """Return 0 where episodes go on, otherwise 1 + the place of the ending in `OUTCOMES`.

    A touch counts before the breakdown that follows it in the same step.

    Args:
        info: From `KinetixEnv.step`; of one world or of many, traced or not.
    """
    won = info["GoalR"]
    lost = info["terminated"] & ~won
    broken = info["nan"] & ~info["terminated"]
    return won * 1 + lost * 2 + info["truncated"] * 3 + broken * 4
