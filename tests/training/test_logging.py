"""Metrics: three files with the same numbers, and nothing of what is to be done again."""

import csv
import json

import pytest

from kinetix.training.logging import MetricsLog, read_metrics


def _row(update, **more):
    return {"timing/num_updates": update, "timing/num_env_steps": 100 * update} | more


@pytest.fixture
def run(tmp_path):
    log = MetricsLog(tmp_path)
    log.write(_row(1, a=0.5))
    log.write(_row(2, b=float("nan")))
    log.write(_row(3, b=2.0))
    log.close()
    return tmp_path


def test_rows_and_columns(run):
    assert read_metrics(run) == [_row(1, a=0.5), _row(2), _row(3, b=2.0)]
    with (run / "metrics.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["a"] for row in rows] == ["0.5", "", ""]
    assert [row["b"] for row in rows] == ["", "", "2.0"]
    assert list((run / "tensorboard").iterdir())


def test_going_on_drops_what_will_be_done_again(run):
    log = MetricsLog(run, updates=2)
    log.write(_row(3, b=9.0))
    log.close()
    assert read_metrics(run) == [_row(1, a=0.5), _row(2), _row(3, b=9.0)]
    with (run / "metrics.csv").open() as file:
        assert [row["b"] for row in csv.DictReader(file)] == ["", "", "9.0"]


def test_a_line_that_a_kill_cut_off_is_left_out(run):
    path = run / "metrics.jsonl"
    path.write_text(path.read_text() + json.dumps(_row(4))[:20])
    assert len(read_metrics(run)) == 3
    MetricsLog(run, updates=3).close()
    assert len(path.read_text().splitlines()) == 3
