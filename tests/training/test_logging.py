"""Metrics: three files with the same numbers, and nothing of what is to be done again."""

import csv
import errno
import json
import os
import struct
import sys
from types import SimpleNamespace

import pytest
from PIL import Image

from kinetix.agents.evaluate import NamedLevel
from kinetix.errors import KinetixError
from kinetix.training.config import PpoConfig
from kinetix.training.films import _file_names
from kinetix.training.logging import MetricsLog, keep_damaged_rows, open_sinks, read_metrics


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


@pytest.mark.parametrize("left", [None, 1])
def test_rows_that_the_lines_lack_are_taken_from_the_table(run, left):
    path, said, before = run / "metrics.jsonl", [], read_metrics(run)
    table = (run / "metrics.csv").read_bytes()
    lines = path.read_text().splitlines(keepends=True)
    path.unlink() if left is None else path.write_text("".join(lines[:left]))
    keep_damaged_rows(run, 3, said.append)
    there = "is not there" if left is None else "has rows of 1 of 3 updates"
    assert said == [f"{path}: {there}; rows of {3 - (left or 0)} are taken from metrics.csv"]
    MetricsLog(run, updates=3).close()
    assert read_metrics(run) == before
    assert (run / "metrics.csv").read_bytes() == table


def test_a_table_that_a_kill_cut_off_gives_its_whole_rows(run):
    path, table, said = run / "metrics.jsonl", run / "metrics.csv", []
    before = read_metrics(run)
    path.unlink()
    table.write_bytes(table.read_bytes()[:-3])
    keep_damaged_rows(run, 3, said.append)
    assert said[1:] == [f"{path}: is not there; rows of 1 are lost"]
    MetricsLog(run, updates=3).close()
    assert read_metrics(run) == before[:2]


def test_metrics_that_would_lose_rows_are_kept_and_told(run):
    path, said = run / "metrics.jsonl", []
    (run / "metrics.csv").unlink()
    keep_damaged_rows(run, 3, said.append)
    assert said == []
    lines = path.read_text().splitlines(keepends=True)
    damaged = "".join([lines[0], "{\n", lines[2]])
    path.write_text(damaged)
    keep_damaged_rows(run, 3, said.append)
    assert "rows of 2 of 3 updates" in said[0] and "metrics.jsonl.damaged keeps" in said[0]
    assert (run / "metrics.jsonl.damaged").read_text() == damaged
    # The run goes on without that row, and does not tell it at every start.
    path.write_text(lines[0] + lines[2])
    keep_damaged_rows(run, 3, said.append)
    assert len(said) == 1 and len(list(run.glob("*.damaged*"))) == 1
    path.unlink()
    keep_damaged_rows(run, 3, said.append)
    assert said[1].endswith("is not there; rows of 3 are lost")


def _all_events(run):
    from tensorboardX.proto.event_pb2 import Event

    found = []
    for path in sorted((run / "tensorboard").iterdir()):
        data = path.read_bytes()
        at = 0
        while at < len(data):
            (length,) = struct.unpack_from("<Q", data, at)
            event = Event.FromString(data[at + 12 : at + 12 + length])
            at += length + 16
            if event.summary.value:
                found.append(event)
    return found


def _events(run):
    """Steps and numbers of all events that TensorBoard finds."""
    return [
        (event.step, {value.tag: value.simple_value for value in event.summary.value})
        for event in _all_events(run)
        if not event.summary.value[0].HasField("image")
    ]


def _pictures(run):
    """Steps, tags and sizes of TensorBoard's pictures."""
    return [
        (event.step, value.tag, value.image.width, value.image.height)
        for event in _all_events(run)
        for value in event.summary.value
        if value.HasField("image")
    ]


def _agree(run):
    """The three files say the same."""
    rows = read_metrics(run)
    assert [(row["timing/num_env_steps"], row) for row in rows] == _events(run)
    with (run / "metrics.csv").open() as file:
        table = [{k: float(v) for k, v in row.items() if v} for row in csv.DictReader(file)]
    assert table == rows
    return [row["timing/num_updates"] for row in rows]


def test_all_files_agree_at_every_moment(run):
    assert _agree(run) == [1, 2, 3]
    log = MetricsLog(run, updates=2)  # never closed: killed
    assert _agree(run) == [1, 2]
    log.write(_row(3, c=4.0))
    assert _agree(run) == [1, 2, 3]
    log.close()
    assert _agree(run) == [1, 2, 3]


@pytest.mark.parametrize("torn", ["", '{"timing', "[]", "null", "\x00" * 100, "[" * 100_000, "{}"])
def test_one_torn_line_costs_no_other_row(run, torn):
    path = run / "metrics.jsonl"
    first, second, third = path.read_text().splitlines()
    path.write_text("\n".join([first, torn, second, second, third[:9], third]) + "\n" + torn)
    assert read_metrics(run) == [_row(1, a=0.5), _row(2), _row(3, b=2.0)]
    MetricsLog(run, updates=3).close()
    assert _agree(run) == [1, 2, 3]


class _Service:
    """Stands in for the package wandb: remembers what it was told."""

    def __init__(self):
        self.runs, self.rows, self.films, self.finished = [], [], [], 0

    def init(self, **options):
        self.runs.append(options)
        return SimpleNamespace(
            define_metric=lambda *_, **__: None, log=self._log, finish=self._finish
        )

    def _log(self, row):
        (self.films if any(name.startswith("film/") for name in row) else self.rows).append(row)

    def Video(self, path, *, format):
        return (path, format)

    def _finish(self):
        self.finished += 1


def _film(run, steps):
    path = run / "films" / str(steps) / "s_level.gif"
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.new("RGB", (4, 3)).save(path)
    return path


def test_films_stand_among_the_events_and_go_with_what_is_done_again(run):
    log = MetricsLog(run, updates=3)
    for steps in (100, 300):
        log.film(steps, _film(run, steps))
    log.close()
    assert _pictures(run) == [(100, "film/s_level", 4, 3), (300, "film/s_level", 4, 3)]
    MetricsLog(run, updates=2).close()
    assert _pictures(run) == [(100, "film/s_level", 4, 3)]
    assert not (run / "films" / "300").exists()


def test_films_stay_where_the_rows_are_lost(run):
    path = _film(run, 100)
    (run / "metrics.jsonl").write_text("")
    MetricsLog(run, updates=3).close()
    assert path.exists()
    MetricsLog(run).close()
    assert not path.exists()


def test_a_service_gets_the_same_rows_and_the_run_keeps_its_name_there(tmp_path, monkeypatch):
    service = _Service()
    monkeypatch.setitem(sys.modules, "wandb", service)
    config = PpoConfig(
        wandb_project="mine", wandb_entity="us", wandb_group="g", wandb_tags=("a", "b"), gamma=0.9
    )
    for updates in (0, 1):
        sinks = open_sinks(tmp_path, config, updates=updates)
        for sink in sinks:
            sink.write(_row(updates + 1, a=0.5, b=float("inf")))
            sink.film(100 * (updates + 1), _film(tmp_path, 100 * (updates + 1)))
            sink.close()
    assert service.rows == [_row(1, a=0.5), _row(2, a=0.5)] == read_metrics(tmp_path)
    first, second = service.runs
    assert (first["project"], first["config"]["gamma"]) == ("mine", 0.9)
    assert (first["entity"], first["group"], first["tags"]) == ("us", "g", ["a", "b"])
    assert [film["film/s_level"][1] for film in service.films] == ["gif", "gif"]
    assert [film["timing/num_env_steps"] for film in service.films] == [100, 200]
    assert first["id"] == second["id"]
    assert second["resume"] == "allow"
    assert service.finished == 2


def test_without_the_extra_one_sentence_names_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "wandb", None)
    with pytest.raises(KinetixError, match=r"pip install 'kinetix-editor\[wandb\]'"):
        open_sinks(tmp_path, PpoConfig(wandb_project="mine"))
    (only,) = open_sinks(tmp_path, PpoConfig())
    only.close()


def test_a_row_that_cannot_be_written_names_its_file(run, monkeypatch):
    log = MetricsLog(run)

    def full(number):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr("os.fsync", full)
        with pytest.raises(KinetixError, match=r"metrics\.jsonl: cannot be written: No space left"):
            log.write(_row(4))
    log.close()


def test_films_of_levels_whose_names_are_alike_have_files_of_their_own():
    names = ("s/x", "s_x", "S x", "s_x_2", "m/y")
    levels = [NamedLevel(name=name, source="s/goalkeeper") for name in names]
    assert _file_names(levels) == ["s_x", "s_x_2", "S_x_3", "s_x_2_2", "m_y"]
