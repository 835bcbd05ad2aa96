"""The benchmark of the renderers runs and reports what it promises."""

import json

import pytest

from kinetix.bench import render as bench
from kinetix.bench import timing
from kinetix.errors import KinetixError


@pytest.mark.slow
def test_rows(monkeypatch):
    monkeypatch.setattr(bench, "SECONDS", 0.01)
    monkeypatch.setattr(timing, "RUNS", 2)
    rows = list(bench.run(bench.RenderSettings(size="s", batches=(2,), pictures=(64,))))
    assert [(row["renderer"], row["width"], row["batch"]) for row in rows] == [
        ("observation", 125, 2),
        ("picture", 64, 1),
    ]
    for row in rows:
        assert row["frames_per_s"] > 0
        assert row["frames_per_s_calls"] > 0
        assert row["compile_s"] > 0
        json.dumps(row)


def test_no_levels_of_that_size():
    with pytest.raises(KinetixError, match="expected bundled levels"):
        next(bench.run(bench.RenderSettings(size="12,4,6,2")))
