"""Levels are timed with the step of their size, and with one that is compiled for them alone."""

import shutil

import pytest

from kinetix.bench import speed
from kinetix.bench.speed import SpeedSettings, measure_speed
from kinetix.paths import levels_dir

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("specialised", [False, True])
def test_a_level_without_limits(tmp_path, monkeypatch, specialised):
    """The step of its size has rows for limits; its own step has none, nor a memory of them."""
    shutil.copy(levels_dir() / "s/first_flight.json", tmp_path)
    monkeypatch.setattr(speed, "MIN_SECONDS", 0.01)
    settings = SpeedSettings(sizes=("s",), batches=(2,), levels=tmp_path, specialised=specialised)
    (row,) = measure_speed(settings)
    assert row["engine_steps_per_s"] > 0
    assert row["env_steps_per_s"] > 0
    assert row["levels"] == 1
