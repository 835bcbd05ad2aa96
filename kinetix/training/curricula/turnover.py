"""Changes of a buffer of levels by an update, and facts about the levels in it now."""

import dataclasses
from typing import Any, Final, Literal, Protocol, TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Int

Kind: TypeAlias = Literal["new", "mutated", "refilled"]
"""Origin of levels: newly sampled, edited from a level of the buffer, chosen among many."""
KINDS: Final[tuple[Kind, ...]] = ("new", "mutated", "refilled")


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Turnover:
    """Changes by one update. Axis `m` is slots of the buffer, `n` the batch that was played."""

    kind: Kind
    source: Int[np.ndarray, " m"]
    """Row of the batch in each slot now; −1: the slot kept its level."""
    slot: Int[np.ndarray, " n"]
    """Slot from which each row of the batch was played or edited; −1: none."""
    episodes: Int[np.ndarray, " n"]
    """Episodes that ended on each row's level."""
    solved: Int[np.ndarray, " n"]


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class BufferView:
    """The buffer as it stands."""

    levels: Any
    """States with a leading axis `m`, on the device."""
    filled: Bool[np.ndarray, " m"]
    score: Float[np.ndarray, " m"]
    """Score by which the curriculum keeps levels."""
    episodes: Int[np.ndarray, " m"] | None = None
    """Episodes counted of each level, where the buffer counts them itself."""
    solved: Int[np.ndarray, " m"] | None = None


class Curriculum(Protocol):
    """A trainer that keeps levels."""

    turnover: Turnover | None
    """Of the last update; None: the buffer stayed as it was."""

    def buffer(self, state: Any) -> BufferView:
        """Return the buffer of a state."""
        ...
