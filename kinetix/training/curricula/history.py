"""The history of a run's buffer, written while it trains: pages over time, bounded on disk."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import jax
import numpy as np

from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.compile import Scene
from kinetix.level.decompile import level_from_scene
from kinetix.level.model import Level
from kinetix.training.curricula.ledger import Departure, Ledger
from kinetix.training.curricula.pages import (
    GoneLevel,
    ListedLevel,
    PageHead,
    forget_later_pages,
    read_page,
    read_slots,
    write_page,
)
from kinetix.training.curricula.turnover import KINDS, BufferView, Curriculum
from kinetix.training.devices import is_leader, to_host

LISTED: Final = 48
"""Levels on a page: those with the best scores."""
_PAGES: Final = 64
"""Pages that a run is divided into."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Course:
    """Progress of a training."""

    algorithm: str
    update: int
    """Updates that are done."""
    updates: int
    """Updates in all."""
    steps_per_update: int
    """Environment steps of one."""


class History:
    """Follows a curriculum's buffer and writes a page now and then."""

    def __init__(
        self,
        run: Path,
        trainer: Curriculum,
        state: Any,
        course: Course,
        say: Callable[[str], None],
    ) -> None:
        """Begin, or go on where the run does.

        Args:
            run: The run's directory.
            trainer: Whose buffer.
            state: Of the trainer, now.
            course: Where the training stands.
            say: Takes a message if the earlier history cannot be read.
        """
        self._run, self._trainer, self._course = run, trainer, course
        self._every = max(1, -(-course.updates // _PAGES))
        update = course.update
        self._shown: set[int] = set()
        self._gone: list[Departure] = []
        slots = len(trainer.buffer(state).filled)
        self._ledger = Ledger(slots)
        self._written = update
        if is_leader():
            forget_later_pages(run, update)
        if update:
            try:
                self._ledger = Ledger.of_arrays(read_slots(run, update), slots)
                self._shown = {one.serial for one in read_page(run, update).head.levels}
            except (KinetixError, ValueError) as error:
                say(f"the curriculum's history starts over: {error}")

    def follow(self, update: int, state: Any, *, page: bool) -> None:
        """Take in an update.

        Args:
            update: Its number.
            state: The trainer's after it.
            page: Whether a page is wanted in any case, as beside a checkpoint.
        """
        view = self._trainer.buffer(state)
        gone = self._ledger.follow(update, self._trainer.turnover, view)
        self._gone += [one for one in gone if one.serial in self._shown]
        if page or update - self._written >= self._every:
            self._write(update, view)

    def _write(self, update: int, view: BufferView) -> None:
        ledger = self._ledger
        self._written = update
        order = np.argsort(-np.where(view.filled, view.score, -np.inf), kind="stable")
        best = order[: min(LISTED, int(view.filled.sum()))]
        # Every process takes part in gathering; only the first one writes.
        rows = to_host(jax.tree.map(lambda x: x[best], view.levels))
        self._shown = {int(ledger.serial[slot]) for slot in best}
        gone, self._gone = self._gone, []
        entered, left = ledger.take_counts()
        if not is_leader():
            return
        known = view.score[view.filled & np.isfinite(view.score)]
        quartiles = np.percentile(known, (25, 50, 75)).tolist() if len(known) else None
        head = PageHead(
            algorithm=self._course.algorithm,
            update=update,
            env_steps=update * self._course.steps_per_update,
            capacity=len(view.filled),
            filled=int(view.filled.sum()),
            entered=entered,
            left=left,
            score_quartiles=None
            if quartiles is None
            else (quartiles[0], quartiles[1], quartiles[2]),
            levels=tuple(self._listed(int(slot)) for slot in best),
            gone=tuple(_told(one) for one in gone),
        )
        levels = [_document(rows, k, f"level {ledger.serial[slot]}") for k, slot in enumerate(best)]
        write_page(self._run, head, levels, ledger.arrays())

    def _listed(self, slot: int) -> ListedLevel:
        ledger, rate = self._ledger, self._ledger.solve_rate(slot)
        ancestors = ledger.ancestry[slot]
        return ListedLevel(
            serial=int(ledger.serial[slot]),
            score=_finite(float(ledger.score[slot])),
            learnability=None if rate is None else rate * (1.0 - rate),
            solve_rate=rate,
            episodes=int(ledger.episodes[slot]),
            born=int(ledger.born[slot]),
            kind=KINDS[int(ledger.kind[slot])],
            ancestry=tuple(int(one) for one in ancestors if one >= 0),
        )


def _told(one: Departure) -> GoneLevel:
    return GoneLevel(
        serial=one.serial,
        update=one.update,
        reason=one.reason,
        by=one.by,
        score=_finite(one.score),
        solve_rate=one.solve_rate,
    )


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _document(rows: EnvState, index: int, name: str) -> Level:
    one = jax.tree.map(lambda x: x[index], rows)
    limit = np.int32(int(one.labels.max_timesteps) or EnvParams().max_timesteps)
    labels = dataclasses.replace(one.labels, max_timesteps=limit)
    scene = Scene(world=one.world, state=one.physics, labels=labels)
    return level_from_scene(scene, name=name, inertia_model="kinetix")
