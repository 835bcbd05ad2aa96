"""The file of results: a newer version's entries, a broken file, and two windows."""

import json
from types import SimpleNamespace

import pytest

from editor import actions
from editor.agents.evaluation import Plan
from editor.gallery.results import HUMAN, Record, Results, Trial
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import Score, Standing
from kinetix.errors import LevelError
from tests.editor.core.helpers import texts
from tests.editor.core.test_viewer import a_result, a_summary

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


def test_results_of_all_agents_outlive_a_full_disk(path, session, monkeypatch):
    plan = Plan(
        levels=(SimpleNamespace(name="L"),),
        hashes=("a",),
        agents=tuple(map(a_summary, ("one", "two"))),
        attempts=2,
        seed=0,
        physics="balanced",
        deterministic=False,
    )
    scores = tuple(Score(agent=k, result=a_result("L", "won", "lost")) for k in (0, 1))
    standing = Standing(done=4, total=4, scores=scores)
    session.viewer.evaluation.ended.append((plan, standing))
    with monkeypatch.context() as patched:
        patched.setattr("editor.gallery.results.write_state", full)
        for _ in range(3):
            actions.update(session, 0.1)
    assert sum("No space" in text for text in texts(session)) == 1 and not path.exists()
    assert {trial.player for trial in session.results.of("a")} == {"one", "two"}
    actions.run(session, "file.quit")
    assert session.quitting
    assert {trial.player for trial in Results(path).of("a")} == {"one", "two"}


def full(path, *_, **__):
    raise LevelError(f"{path}: cannot be saved: No space left on device")
