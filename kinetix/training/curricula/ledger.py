"""Identities in a buffer of levels: serial numbers, ages, ancestors, last results. Plain numpy."""

import dataclasses
from typing import Final

import numpy as np
from jaxtyping import Bool, Float, Int

from kinetix.training.curricula.turnover import KINDS, BufferView, Turnover

ANCESTORS: Final = 6
"""Serial numbers of ancestors that are kept of a level, the parent first."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Departure:
    """A level that left."""

    serial: int
    update: int
    reason: str
    """`outscored`: a better level took its slot; `refilled`: the buffer was refilled."""
    by: int
    """Serial number of the level that took its slot; −1 if there is none."""
    score: float
    """Its last one."""
    solve_rate: float | None
    """Its last one; None where nothing ended."""


class Ledger:
    """Follows the slots of a buffer from update to update."""

    def __init__(self, slots: int) -> None:
        """Begin with an empty buffer.

        Args:
            slots: Its capacity.
        """
        self.serial: Int[np.ndarray, " m"] = np.full(slots, -1, np.int64)
        """Number of the level in each slot, counted as levels come in; −1: free."""
        self.born: Int[np.ndarray, " m"] = np.zeros(slots, np.int32)
        """Update in which it came in."""
        self.kind: Int[np.ndarray, " m"] = np.zeros(slots, np.int8)
        """Index into `KINDS`."""
        self.ancestry: Int[np.ndarray, "m a"] = np.full((slots, ANCESTORS), -1, np.int64)
        self.episodes: Int[np.ndarray, " m"] = np.zeros(slots, np.int32)
        self.solved: Int[np.ndarray, " m"] = np.zeros(slots, np.int32)
        self.score: Float[np.ndarray, " m"] = np.full(slots, -np.inf, np.float32)
        self.entered = self.left = 0
        """Levels that came and went since `take_counts`."""
        self.next = 0

    def follow(self, update: int, turnover: Turnover | None, view: BufferView) -> list[Departure]:
        """Take in what an update did.

        Args:
            update: Its number.
            turnover: What it did.
            view: The buffer after it.

        Returns:
            The levels that left.
        """
        gone: list[Departure] = []
        if turnover is not None:
            gone = self._exchange(update, turnover)
            self._visited(turnover)
        if view.episodes is not None and view.solved is not None:
            self.episodes, self.solved = view.episodes.copy(), view.solved.copy()
        self.score = view.score.copy()
        strangers = view.filled & (self.serial < 0)
        if strangers.any():  # what was there before anybody looked
            self._name(strangers, update, kind=0)
        return gone

    def _exchange(self, update: int, turnover: Turnover) -> list[Departure]:
        fresh = turnover.source >= 0
        leaving = fresh & (self.serial >= 0)
        before = self.serial.copy()
        rows = turnover.source[fresh]
        parents = np.full((int(fresh.sum()), ANCESTORS), -1, np.int64)
        if turnover.kind == "mutated":
            slots = turnover.slot[rows]
            known = slots >= 0
            parents[known, 0] = self.serial[slots[known]]
            parents[known, 1:] = self.ancestry[slots[known], :-1]
        reason = "refilled" if turnover.kind == "refilled" else "outscored"
        facts = [
            (slot, int(before[slot]), float(self.score[slot]), self.solve_rate(slot))
            for slot in np.flatnonzero(leaving).tolist()
        ]
        self._name(fresh, update, kind=KINDS.index(turnover.kind))
        self.ancestry[fresh] = parents
        self.episodes[fresh], self.solved[fresh] = turnover.episodes[rows], turnover.solved[rows]
        self.left += len(facts)
        return [
            Departure(
                serial=serial,
                update=update,
                reason=reason,
                by=int(self.serial[slot]) if reason == "outscored" else -1,
                score=score,
                solve_rate=rate,
            )
            for slot, serial, score, rate in facts
        ]

    def _visited(self, turnover: Turnover) -> None:
        """Note how the last visit of replayed levels went."""
        if turnover.kind != "new" or np.any(turnover.source >= 0):
            return
        rows = turnover.slot >= 0
        slots = turnover.slot[rows]
        episodes, solved = np.zeros_like(self.episodes), np.zeros_like(self.solved)
        np.add.at(episodes, slots, turnover.episodes[rows])
        np.add.at(solved, slots, turnover.solved[rows])
        told = episodes > 0
        self.episodes[told], self.solved[told] = episodes[told], solved[told]

    def _name(self, slots: Bool[np.ndarray, " m"], update: int, *, kind: int) -> None:
        count = int(slots.sum())
        self.serial[slots] = np.arange(self.next, self.next + count)
        self.born[slots], self.kind[slots] = update, kind
        self.ancestry[slots] = -1
        self.episodes[slots] = self.solved[slots] = 0
        self.next += count
        self.entered += count

    def solve_rate(self, slot: int) -> float | None:
        """Return how often the level in a slot was solved of late; None where nothing ended."""
        count = int(self.episodes[slot])
        return float(self.solved[slot]) / count if count else None

    def take_counts(self) -> tuple[int, int]:
        """Return how many levels came in and left since the last call."""
        counts = self.entered, self.left
        self.entered = self.left = 0
        return counts

    def arrays(self) -> dict[str, np.ndarray]:
        """Return everything as arrays, for a page on disk."""
        names = ("serial", "born", "kind", "ancestry", "episodes", "solved", "score")
        told = {f"slot_{name}": getattr(self, name) for name in names}
        return told | {"slot_next": np.array(self.next, np.int64)}

    @classmethod
    def of_arrays(cls, arrays: dict[str, np.ndarray], slots: int) -> "Ledger":
        """Return the ledger that a page holds.

        Args:
            arrays: From `arrays`.
            slots: The buffer's capacity.

        Raises:
            ValueError: The arrays are of another buffer.
        """
        found = cls(slots)
        for name, value in arrays.items():
            if name == "slot_next":
                found.next = int(value)
                continue
            field = name.removeprefix("slot_")
            mine = getattr(found, field)
            if value.shape != mine.shape:
                raise ValueError(f"{name} has the shape {value.shape}, expected {mine.shape}")
            setattr(found, field, value.astype(mine.dtype))
        return found
