"""A training run that is watched: each reading goes on where the one before ended."""

import dataclasses
import json

import pytest

from editor.worker.requests import ReadRun, RunNews
from editor.worker.simulation import run_news
from editor.worker.simulation.run_news import read_run
from kinetix.training.logging import STEPS, UPDATE, parse_rows, read_metrics


def _line(update, **more):
    return json.dumps({UPDATE: update, STEPS: 64 * update} | more) + "\n"


def test_a_training_run_is_read_and_read_on(tmp_path, monkeypatch):
    path, request = tmp_path / "metrics.jsonl", ReadRun(path=str(tmp_path))
    assert read_run(request) == RunNews(rows=(), total=0, newest=None)
    path.write_text(_line(1) + _line(2) + '{"lo')
    news = read_run(request)
    assert [row[UPDATE] for row in news.rows] == [1, 2]
    assert (news.total, news.newest) == (2, None)
    parsed = []
    monkeypatch.setattr(
        run_news, "parse_rows", lambda data: parsed.append(data) or parse_rows(data)
    )
    again = read_run(dataclasses.replace(request, after=news.place))
    assert (again.rows, again.total, again.place) == ((), 2, news.place)
    path.write_text(_line(1) + _line(2) + "nothing\n" + _line(3) + _line(4))
    news = read_run(dataclasses.replace(request, after=news.place))
    assert [row[UPDATE] for row in news.rows] == [3, 4] and news.total == 4
    path.write_text(path.read_text() + _line(5))
    news = read_run(dataclasses.replace(request, after=news.place))
    assert [row[UPDATE] for row in news.rows] == [5] and news.total == 5
    assert parsed[-1].decode() == _line(5)  # nothing before it


@pytest.mark.parametrize(
    "lines",
    [
        _line(1),
        _line(1) + _line(2, x=1) + _line(3, x=1),
        _line(1) + _line(2) + _line(3) + _line(2),
        "",
    ],
    ids=["shorter", "rewritten", "an update twice", "empty"],
)
def test_a_run_that_went_back_to_a_checkpoint_is_read_anew(tmp_path, lines):
    path, request = tmp_path / "metrics.jsonl", ReadRun(path=str(tmp_path))
    path.write_text(_line(1) + _line(2) + _line(3))
    place = read_run(request).place
    path.write_text(lines)
    news = read_run(dataclasses.replace(request, after=place))
    assert list(news.rows) == read_metrics(tmp_path) and news.total == len(news.rows)
