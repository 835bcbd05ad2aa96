"""A teacher's search of a block of levels, turn by turn: one that was stopped goes on within it."""

import dataclasses
import io
from pathlib import Path
from typing import Any, Final

import jax
import numpy as np

from kinetix.environment.env import KinetixEnv
from kinetix.environment.state import EnvState
from kinetix.files.arrays import read_npz
from kinetix.files.atomic import write_atomically
from kinetix.files.regular import FileError
from kinetix.training.imitation.teacher import ELITE, LENGTH, search_round
from kinetix.training.progress_text import Say

KEPT: Final = "teach.search"
"""File in the data set's folder, while a block is searched: all that the next turn needs."""


@dataclasses.dataclass(kw_only=True)
class _Turns:
    """Progress of a search."""

    places: np.ndarray
    """Numbers of the levels that are searched together."""
    active: np.ndarray
    """False for places without a level: none waits any more."""
    age: np.ndarray
    """Rounds of each place's level."""
    elite: np.ndarray
    """Its best plans."""
    waiting: list[int]
    """Numbers of the levels that have not begun."""
    plans: dict[int, np.ndarray]
    """Winning plans by level."""
    turn: int

    def next(self, elite: np.ndarray, won: np.ndarray, rounds: int) -> None:
        """Take what a turn has found: a place that is done takes the next level."""
        self.elite = elite
        self.age += 1
        for k in np.flatnonzero(self.active & (won | (self.age >= rounds))):
            if won[k]:
                self.plans[int(self.places[k])] = elite[k, 0].copy()
            elite[k], self.age[k] = 0, 0
            self.active[k] = bool(self.waiting)
            if self.waiting:
                self.places[k] = self.waiting.pop(0)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SearchBlock:
    """Levels to search, and the effort."""

    levels: EnvState
    """First states, as numpy arrays."""
    todo: np.ndarray
    """Numbers of those to search."""
    key: Any
    """For the draws."""
    batch: int
    """Levels that are searched together."""
    rounds: int
    """Rounds after which a level is given up."""
    identity: str
    """Tells the same search from another."""


def search(env: KinetixEnv, block: SearchBlock, kept: Path, status: Say) -> dict[int, np.ndarray]:
    """Return winning plans by level.

    Args:
        env: The environment.
        block: What is searched.
        kept: File that is written after every turn, from which the same search goes on.
        status: Takes words for what is under way.

    Raises:
        LevelError: The file cannot be written.
    """
    turns = _stopped(kept, block.identity) or _begun(block.todo, block.batch)
    many = len(block.todo)
    while turns.active.any():
        states = jax.tree.map(lambda x: x[turns.places], block.levels)
        turns.turn += 1
        begun = many - len(turns.waiting)
        status(f"searching: {begun} of {many} levels begun, {len(turns.plans)} won")
        key = jax.random.fold_in(block.key, turns.turn)
        result = search_round(env, states, turns.elite, key)
        turns.next(np.array(result.elite), np.asarray(result.won), block.rounds)
        write_atomically(kept, _packed(turns, block.identity))
    return turns.plans


def _begun(todo: np.ndarray, batch: int) -> _Turns:
    return _Turns(
        places=np.resize(todo, batch),
        active=np.arange(batch) < len(todo),
        age=np.zeros(batch, int),
        elite=np.zeros((batch, ELITE, LENGTH, 6), np.int8),
        waiting=todo[batch:].tolist(),
        plans={},
        turn=0,
    )


def _packed(turns: _Turns, identity: str) -> bytes:
    arrays = vars(turns) | {
        "identity": identity,
        "waiting": np.array(turns.waiting, int),
        "won": np.array(list(turns.plans), int),
        "plans": np.array(list(turns.plans.values()), np.int8),
    }
    data = io.BytesIO()
    np.savez_compressed(data, **arrays)
    return data.getvalue()


def _stopped(kept: Path, identity: str) -> _Turns | None:
    """Return the search that the file is of; None where that is another, or the file is damaged."""
    try:
        found = {name: array.copy() for name, array in read_npz(kept, "episodes").items()}
    except FileError:
        return None
    if str(found.pop("identity", "")) != identity:
        return None
    won, plans = found.pop("won").tolist(), found.pop("plans")
    waiting, turn = found.pop("waiting").tolist(), int(found.pop("turn"))
    return _Turns(**found, waiting=waiting, turn=turn, plans=dict(zip(won, plans, strict=True)))
