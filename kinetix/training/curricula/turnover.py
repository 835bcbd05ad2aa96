"""What an update did to a buffer of levels, and what is known about the levels in it now."""

import dataclasses
from typing import Any, Final, Literal, Protocol, TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Int

Kind: TypeAlias = Literal["new", "mutated", "refilled"]
"""How levels came in: drawn anew, edited from a level of the buffer, chosen among many."""
KINDS: Final[tuple[Kind, ...]] = ("new", "mutated", "refilled")


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Turnover:
    """What one update did. Axis `m` is slots of the buffer, `n` the batch that was played."""

    kind: Kind
    source: Int[np.ndarray, " m"]
    """Which row of the batch is in each slot now; −1: the slot kept its level."""
    slot: Int[np.ndarray, " n"]
    """Which slot each row of the batch was played from, or edited from; −1: none."""
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
    """What the curriculum keeps levels by."""
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
