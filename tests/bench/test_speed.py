"""Levels are timed with the step of their size, and with one that is compiled for them alone."""

import shutil
from pathlib import Path

import pytest

from kinetix.bench import speed
from kinetix.bench.speed import SpeedSettings, levels_of, measure_speed
from kinetix.errors import KinetixError
from kinetix.level.sets import build_set, gather_levels, save_set
from kinetix.level.sizes import parse_capacity
from kinetix.paths import levels_dir


@pytest.mark.slow
@pytest.mark.parametrize("specialised", [False, True])
def test_a_level_without_limits(tmp_path, monkeypatch, specialised):
    """The step of its size has rows for limits; its own step has none, nor a memory of them."""
    shutil.copy(levels_dir() / "s/first_flight.json", tmp_path)
    monkeypatch.setattr(speed, "SECONDS", 0.01)
    settings = SpeedSettings(sizes=("s",), batches=(2,), levels=tmp_path, specialised=specialised)
    (row,) = measure_speed(settings)
    assert row["engine_steps_per_s"] > 0
    assert row["env_steps_per_s"] > 0
    assert row["levels"] == 1


def test_a_world_alone_is_timed_on_each_level(tmp_path, monkeypatch):
    """Every level is timed, also when the batch is smaller than the number of levels."""
    for name in ("first_flight", "goalkeeper", "wheelie"):
        shutil.copy(levels_dir() / f"s/{name}.json", tmp_path)
    timed = []

    def time(loop, starts, keys, batch):
        timed.append([state.physics.position.shape[0] for state in starts])
        return speed._Rate(steps_per_s=1.0, compile_s=0.0)

    monkeypatch.setattr(speed, "_time", time)
    settings = SpeedSettings(sizes=("s",), batches=(1, 2, 4), levels=tmp_path)
    rows = list(measure_speed(settings))
    assert timed[::2] == timed[1::2] == [[1] * 3, [2] * 2, [4]]
    assert [row["levels"] for row in rows] == [3, 3, 3]


def test_a_level_set_in_the_folder_is_left_out(tmp_path):
    level = Path(shutil.copy(levels_dir() / "s/first_flight.json", tmp_path))
    save_set(
        build_set(gather_levels([tmp_path]), name="all", folder=tmp_path), tmp_path / "all.json"
    )
    assert levels_of(tmp_path, parse_capacity("s")) == [level]


def test_all_sizes_are_checked_before_one_is_measured(monkeypatch):
    monkeypatch.setattr("kinetix.bench.speed._rates", lambda *_: pytest.fail("measured"))
    with pytest.raises(KinetixError, match="size 'xl': expected s, m, l"):
        next(measure_speed(SpeedSettings(sizes=("s", "xl"))))
