"""The file of results: a newer version's entries, a broken file, and two windows."""

import json

import pytest

from editor import actions
from editor.gallery.results import HUMAN, Record, Results, Trial
from editor.session import Session
from editor.worker.jobs import Worker
from tests.editor.core.helpers import texts

WALKER = Trial(player="walker", digest="ab", physics="balanced")
TWENTY = Record(attempts=20, solved=10)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results.json"


@pytest.fixture
def session(path):
    session = Session(worker=Worker(perform=lambda *_: None), results=Results(path))
    yield session
    session.worker.stop()


def test_what_a_newer_version_wrote_is_written_back(path):
    Results(path).record(WALKER, {"a": TWENTY, "b": TWENTY})
    newer = json.loads(path.read_text())
    newer["a"][0].append("more")
    newer["c"] = {"version": 3, "rows": []}
    newer["d"] = {"version": 3, "rows": [[1]]}
    path.write_text(json.dumps(newer))
    results = Results(path)
    for _ in range(2):
        results.add_episode(HUMAN, "a", won=True)
    results.add_episode(HUMAN, "c", won=True)
    there = json.loads(path.read_text())
    assert newer["a"][0] in there["a"] and newer["c"] in there["c"]
    assert (there["b"], there["d"]) == (newer["b"], newer["d"])
    again = Results(path)
    assert again.of("a") == {Trial(player=HUMAN): Record(attempts=2, solved=2)}
    assert again.of("b") == {WALKER: TWENTY}


def test_an_older_entry_that_is_half_understood_never_hides_a_newer_one(path):
    path.write_text(json.dumps({"a": {HUMAN: [1, 1], "walker": "?"}}))
    for _ in range(2):
        Results(path).add_episode(HUMAN, "a", won=True)
    assert Results(path).of("a") == {Trial(player=HUMAN): Record(attempts=3, solved=3)}
    assert {HUMAN: [1, 1], "walker": "?"} in json.loads(path.read_text())["a"]


def test_a_broken_file_is_told_once_and_stays_as_a_backup(path, session):
    path.write_text('{"a": [[')
    assert session.results.players == ()
    for _ in range(3):
        actions.update(session, 0.1)
    assert sum("results.json" in text for text in texts(session)) == 1
    session.results.add_episode(HUMAN, "a", won=True)
    assert path.with_name("results.json.bak").read_text() == '{"a": [['
