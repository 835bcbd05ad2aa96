"""Identities in a curriculum's buffer, and its pages on disk. No training."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kinetix.environment.params import static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.environment.state import stack_states
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from kinetix.training.curricula.history import Course, History
from kinetix.training.curricula.ledger import Ledger
from kinetix.training.curricula.pages import (
    MOST_PAGES,
    ListedLevel,
    PageHead,
    page_path,
    page_updates,
    read_page,
    read_slots,
    write_page,
)
from kinetix.training.curricula.turnover import BufferView, Turnover


def _view(score: list[float]) -> BufferView:
    values = np.array(score, np.float32)
    return BufferView(levels=(), filled=np.isfinite(values), score=values)


def _turnover(source: list[int], slot: list[int], kind: str = "new") -> Turnover:
    count = len(slot)
    return Turnover(
        kind=kind,  # pyright: ignore[reportArgumentType]
        source=np.array(source),
        slot=np.array(slot),
        episodes=np.full(count, 4),
        solved=np.arange(count),
    )


def test_levels_are_followed_through_a_buffer() -> None:
    """New levels get numbers, mutations their parents, replaced ones a reason and a successor."""
    ledger, none = Ledger(3), -np.inf
    assert not ledger.follow(1, _turnover([0, 1, -1], [-1, -1]), _view([0.5, 0.2, none]))
    assert ledger.serial.tolist() == [0, 1, -1] and ledger.solve_rate(1) == 0.25
    # A replay of slot 1, in two environments.
    ledger.follow(2, _turnover([-1, -1, -1], [1, 1, 0]), _view([0.5, 0.3, none]))
    assert (ledger.episodes.tolist(), ledger.solved.tolist()) == ([4, 8, 0], [2, 1, 0])
    gone = ledger.follow(3, _turnover([-1, 1, 0], [0, 1], kind="mutated"), _view([0.5, 0.9, 0.8]))
    assert [(g.serial, g.by, g.reason, g.update) for g in gone] == [(1, 2, "outscored", 3)]
    assert gone[0].score == pytest.approx(0.3) and gone[0].solve_rate == 1 / 8
    assert ledger.serial.tolist() == [0, 2, 3]
    assert ledger.ancestry[1].tolist()[:2] == [1, -1]  # an edit of what it replaced
    assert ledger.ancestry[2].tolist()[:2] == [0, -1]
    again = Ledger.of_arrays(ledger.arrays(), 3)
    ledger.follow(4, _turnover([0, -1, -1], [1], kind="mutated"), _view([1.0, 0.9, 0.8]))
    again.follow(4, _turnover([0, -1, -1], [1], kind="mutated"), _view([1.0, 0.9, 0.8]))
    assert ledger.ancestry[0].tolist()[:3] == [2, 1, -1]
    assert np.array_equal(ledger.serial, again.serial)
    assert ledger.take_counts() == (5, 2) and ledger.take_counts() == (0, 0)
    with pytest.raises(ValueError, match="shape"):
        Ledger.of_arrays(ledger.arrays(), 4)


def test_a_refill_exchanges_everything() -> None:
    """SFL counts its levels itself; all of them leave at once, with what they were worth."""
    ledger = Ledger(2)
    view = BufferView(
        levels=(),
        filled=np.ones(2, bool),
        score=np.array([0.2, 0.1], np.float32),
        episodes=np.array([10, 10]),
        solved=np.array([9, 0]),
    )
    ledger.follow(1, _turnover([0, 1], [-1, -1], kind="refilled"), view)
    gone = ledger.follow(2, _turnover([0, 1], [-1, -1], kind="refilled"), view)
    assert [(g.serial, g.reason, g.by, g.solve_rate) for g in gone] == [
        (0, "refilled", -1, 0.9),
        (1, "refilled", -1, 0.0),
    ]


def _head(update: int) -> PageHead:
    listed = ListedLevel(
        serial=7, score=0.2, learnability=0.25, solve_rate=0.5, episodes=8, born=1, kind="new"
    )
    return PageHead(
        algorithm="accel",
        update=update,
        env_steps=update * 64,
        capacity=4,
        filled=1,
        entered=1,
        left=0,
        score_quartiles=(0.1, 0.2, 0.3),
        levels=(listed,),
    )


def test_pages_come_back_and_are_bounded(tmp_path: Path) -> None:
    """However many are written, fewer than the bound stay; the newest always do."""
    level, slots = load_level("s/goalkeeper"), Ledger(4).arrays()
    for update in range(1, 3 * MOST_PAGES):
        write_page(tmp_path, _head(update), [level], slots)
        assert len(page_updates(tmp_path)) <= MOST_PAGES
    updates = page_updates(tmp_path)
    assert updates[0] == 1 and updates[-1] == 3 * MOST_PAGES - 1
    page = read_page(tmp_path, updates[-1])
    assert page.head == _head(updates[-1]) and page.levels == (level,)
    assert set(read_slots(tmp_path, updates[-1])) == set(slots)


def test_a_damaged_page_is_one_sentence(tmp_path: Path) -> None:
    """Cut off or not a page: the sentence names the file."""
    write_page(tmp_path, _head(3), [load_level("s/goalkeeper")], {})
    path = page_path(tmp_path, 3)
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(KinetixError, match="000000003"):
        read_page(tmp_path, 3)
    np.savez(path, page=np.frombuffer(b"{}", np.uint8), level=np.zeros(0, np.uint8))
    with pytest.raises(KinetixError, match="expected a page"):
        read_page(tmp_path, 3)


@pytest.mark.parametrize("resumed", [False, True])
def test_levels_that_leave_the_page_before_are_told_after_a_stop_too(
    tmp_path: Path, resumed: bool
) -> None:
    static = static_env_params_from_size("s")
    levels = stack_states([level_state("s/first_flight", static)] * 3)

    class Trainer:
        turnover: Turnover | None = None

        def buffer(self, state: list[float]) -> BufferView:
            return dataclasses.replace(_view(state), levels=levels)

    def course(update: int) -> Course:
        return Course(algorithm="plr", update=update, updates=6, steps_per_update=1)

    trainer: Any = Trainer()
    history = History(tmp_path, trainer, [3, 2, 1], course(0), print)
    history.follow(1, [3, 2, 1], page=True)
    if resumed:
        history = History(tmp_path, trainer, [3, 2, 1], course(1), print)
    trainer.turnover = _turnover([-1, 0, -1], [-1])
    history.follow(2, [3, 9, 1], page=True)
    assert [gone.serial for gone in read_page(tmp_path, 2).head.gone] == [1]
