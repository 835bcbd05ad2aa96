"""Training on the level in front: a process is begun, watched, ended, and its agent taken."""

import dataclasses
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from editor import actions
from editor.actions.training import train
from editor.actions.watching import agents
from editor.agents.local_training import LocalTraining, start_process
from editor.documents.document import Document
from editor.worker.requests import AgentRef
from kinetix.errors import CommandError
from kinetix.files.lock import locked_folder
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Level
from kinetix.level.sets import build_set, gather_levels, load_set, save_set
from kinetix.training.settings import CONFIG
from tests.editor.core.helpers import a_level, texts
from tests.editor.core.test_viewer import Stage, a_summary, session, settle, stage

__all__ = ["session", "stage"]


class FakeProcess:
    """Runs until it is told to end."""

    def __init__(self):
        self.status = None
        self.signals = []

    def poll(self):
        return self.status

    def send_signal(self, sig):
        self.signals.append(sig)


@pytest.fixture
def began(session, tmp_path, monkeypatch):
    """The processes that were started, as (words, process)."""
    monkeypatch.setattr(
        "editor.actions.training.train.user_agents_dir", lambda: tmp_path / "agents"
    )
    started = []

    def start(words, log):
        log.write_text("compiling\n3/96  solved 0.4\n")
        started.append((list(words), FakeProcess()))
        return started[-1][1]

    session.training = LocalTraining(start)
    return started


def _trainable():
    level = a_level()
    assert {"green", "blue"} <= {body.role for body in level.bodies}
    return level


def test_one_click_trains_on_the_level_as_it_stands(session, began, tmp_path):
    assert actions.run(session, "agent.train_here")
    ((words, _),) = began
    run = session.training.run
    assert run.parent == tmp_path / "agents"
    assert words[words.index("--out") + 1] == str(run)
    assert words[words.index("--preset") + 1] == "specialist"
    stored = load_level(words[words.index("--levels") + 1])
    assert stored.bodies == session.document.level.bodies
    assert session.viewer.run.path == str(run)
    assert session.view.front == "training"
    assert session.training.words == "3/96  solved 0.4"
    assert session.training.running


def test_there_is_one_training_at_a_time_and_it_can_be_ended(session, began):
    actions.run(session, "agent.train_here")
    assert not actions.run(session, "agent.train_here")
    assert len(began) == 1
    assert actions.run(session, "agent.stop_training")
    process = began[0][1]
    assert process.signals == [signal.SIGTERM]  # an update was made: it saves
    process.status = 143
    settle(session)
    assert not any("The training ended" in text for text in texts(session))
    assert any("before anything was learnt" in text for text in texts(session))
    assert not any("is trained" in text for text in texts(session))


def test_a_training_that_learnt_nothing_leaves_nothing(session, began):
    actions.run(session, "agent.train_here")
    run = session.training.run
    actions.run(session, "agent.stop_training")
    began[0][1].status = 143
    settle(session)
    assert list(run.parent.iterdir()) == []
    assert session.viewer.run.path == ""  # else the panel misses its folder, in red
    actions.run(session, "agent.train_here")
    assert session.training.run == run


def test_messages_name_the_level_and_a_promise_goes_with_the_training(session, began):
    session.open_tab(Document(_trainable().replace(name="Fly & land")))
    actions.run(session, "agent.train_here")
    assert "Training on Fly & land: its newest attempt" in texts(session)[-1]
    actions.run(session, "agent.stop_training")
    began[0][1].status = 143
    settle(session)
    assert texts(session) == ["Training on Fly & land: stopped before anything was learnt."]


def test_a_training_that_still_compiles_ends_at_once_and_leaves_nothing(session, began):
    actions.run(session, "agent.train_here")
    run = session.training.run
    (run / "training.log").write_text("preparing the levels\ncompiling: update\n")
    (run / "config.toml").write_text("")
    actions.run(session, "agent.stop_training")
    assert began[0][1].signals == [signal.SIGKILL]
    began[0][1].status = -9
    settle(session)
    assert any("before anything was learnt" in text for text in texts(session))
    assert list(run.parent.iterdir()) == []


def test_what_a_closed_app_left_before_it_learnt_gives_its_name_back(session, began):
    actions.run(session, "agent.train_here")
    run = session.training.run
    began[0][1].status = 143
    session.training = LocalTraining(session.training._start)
    actions.run(session, "agent.train_here")
    assert session.training.run.name == f"{run.name}_2"  # another window may have begun it just now
    began[1][1].status = 143
    session.training = LocalTraining(session.training._start)
    long_ago = time.time() - 3600
    os.utime(run / "training.log", (long_ago, long_ago))
    with locked_folder(run, "another window"):  # which still compiles
        assert train._taken(run)
    actions.run(session, "agent.train_here")
    assert session.training.run == run


def test_a_folder_that_vanishes_is_no_harmless_end(session, began):
    actions.run(session, "agent.train_here")
    run = session.training.run
    shutil.rmtree(run)
    began[0][1].status = 0
    settle(session)
    assert any("its folder is gone" in text for text in texts(session))
    assert not any("before anything was learnt" in text for text in texts(session))


def test_what_was_learnt_until_it_was_stopped_is_taken(session, stage: Stage, began):
    actions.run(session, "agent.train_here")
    run = session.training.run
    stage.agents[str(run)] = a_summary("Specialist")
    (run / "checkpoints" / "131072").mkdir(parents=True)
    actions.run(session, "agent.stop_training")
    began[0][1].status = 143
    settle(session)
    assert any("stopped; its progress is saved" in text for text in texts(session))
    assert session.viewer.slots["a"].summary.name == "Specialist"


def test_what_was_trained_is_taken_and_a_failure_is_told(session, stage: Stage, began):
    actions.run(session, "agent.train_here")
    run = session.training.run
    stage.agents[str(run)] = a_summary("Specialist")
    (run / "checkpoints" / "1").mkdir(parents=True)
    began[0][1].status = 0
    settle(session)
    assert session.viewer.slots["a"].summary.name == "Specialist"
    actions.run(session, "agent.train_here")
    assert session.training.run.name == f"{run.name}_2"
    began[1][1].status = 1
    settle(session)
    assert any("3/96  solved 0.4" in text for text in texts(session))


@pytest.mark.parametrize(("chosen", "taken"), [("/agents/Tester", False), ("", True)])
def test_an_agent_that_shall_stay_is_not_replaced_at_the_end(session, stage, began, chosen, taken):
    stage.agents["/agents/Tester"] = a_summary()
    actions.run(session, "agent.train_here")
    run = session.training.run
    stage.agents[str(run)] = a_summary("Specialist")
    (run / "checkpoints" / "1").mkdir(parents=True)
    session.viewer.follow_run = False
    if chosen:
        agents.load_agent(session, chosen)
        settle(session)
    began[0][1].status = 0
    settle(session)
    assert session.viewer.slots["a"].summary.name == ("Specialist" if taken else "Tester")
    assert any("is trained" in text and ("F6" in text) is taken for text in texts(session))


@pytest.mark.parametrize(
    ("slot_a", "taken"),
    [("planner", True), ("checkpoint", True), ("passed over", False), ("chosen", False)],
)
def test_a_training_hands_its_agent_over_unless_another_one_was_chosen(
    session, stage, began, slot_a, taken
):
    session.viewer.follow_run = False  # The slider of another run was moved once.
    actions.run(session, "agent.train_here")
    assert session.viewer.follow_run
    run = session.training.run
    (run / "checkpoints" / "1").mkdir(parents=True)
    (run / "metrics.jsonl").touch()
    paths = {"planner": "planner", "checkpoint": str(run / "checkpoints" / "1")}
    path = paths.get(slot_a, "/agents/Tester")
    stage.agents[path] = a_summary("Tester", ref=AgentRef(path=path))
    stage.agents[str(run)] = a_summary("Specialist", ref=AgentRef(path=str(run)))
    if slot_a == "checkpoint":
        agents.show_checkpoint(session, "a", Path(path))
    else:
        agents.choose_agent(session, path)
    settle(session)
    assert not session.viewer.follow_run
    place = session.viewer.slots["a"]
    if slot_a == "passed over":  # The planner plays in its place.
        place.passed_over, place.path = place.summary, "planner"
    began[0][1].status = 0
    settle(session)
    assert (place.summary.name == "Specialist") is taken


def test_a_run_that_was_chosen_meanwhile_stays_and_is_followed(session, stage, began, tmp_path):
    actions.run(session, "agent.train_here")
    run, other = session.training.run, tmp_path / "other"
    for each in (run, other):
        (each / "checkpoints" / "1").mkdir(parents=True)
        (each / "metrics.jsonl").touch()
        stage.agents[str(each)] = a_summary(each.name, ref=AgentRef(path=str(each)))
    agents.choose_agent(session, other)
    settle(session)
    assert (session.viewer.run.path, session.viewer.follow_run) == (str(other), True)
    began[0][1].status = 0
    settle(session)
    assert session.viewer.slots["a"].summary.name == "other"


def test_of_a_long_log_only_the_end_is_read_for_its_last_words(session, began, monkeypatch):
    actions.run(session, "agent.train_here")
    log = session.training.run / "training.log"
    log.write_text("first line\n" + "an update\n" * 5000 + "9/96  solved 0.5\n\n")
    asked = []
    lines = LocalTraining._lines

    def noted(self, *most):
        found = lines(self, *most)
        asked.append(len(found))
        return found

    monkeypatch.setattr(LocalTraining, "_lines", noted)
    assert session.training.words == "9/96  solved 0.5"
    assert asked[-1] < 1000


def test_what_cannot_be_learnt_is_said_before_anything_begins(session, began):
    level = _trainable()
    for broken, says in (
        (_with(level, role="none"), "green and a blue"),
        (Level(name="still", bodies=level.bodies), "motor or a thruster"),
    ):
        session.open_tab(Document(broken))
        with pytest.raises(CommandError, match=says):
            train.train_here(session)
    assert began == []


def _with(level, **changes):
    return level.replace(bodies=tuple(body.replace(**changes) for body in level.bodies))


@pytest.mark.slow
def test_what_one_click_begins_does_learn(session, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "editor.actions.training.train.user_agents_dir", lambda: tmp_path / "agents"
    )
    session.training = LocalTraining(start_process)
    session.open_tab(Document(load_level("s/goalkeeper")))
    assert actions.run(session, "agent.train_here")
    training = session.training
    until = time.monotonic() + 300
    while training.running and not (training.run / CONFIG).is_file():
        assert time.monotonic() < until, training.words
        time.sleep(0.2)
    words = training.words
    training.stop()
    while training.running:
        time.sleep(0.1)
    assert (training.run / CONFIG).is_file(), words


@pytest.mark.skipif(os.name != "posix", reason="niceness is of POSIX systems")
def test_the_process_is_of_low_priority_and_its_words_are_kept(tmp_path):
    log = tmp_path / "log"
    process = start_process([sys.executable, "-c", "import os; print(os.nice(0))"], log)
    assert process.wait(30) == 0
    assert int(log.read_text()) >= 5


LEAVES = """
import pathlib, sys, time
from editor.agents.local_training import start_process

child = (
    "import pathlib, signal, sys, time\\n"
    "def saved(*_):\\n    pathlib.Path(sys.argv[1]).write_text('saved')\\n    sys.exit()\\n"
    "signal.signal(signal.SIGTERM, saved)\\nprint('ready', flush=True)\\ntime.sleep(60)"
)
log = pathlib.Path(sys.argv[1]) / "log"
start_process([sys.executable, "-c", child, str(log.with_name("done"))], log)
while "ready" not in log.read_text():
    time.sleep(0.05)
print("started", flush=True)
time.sleep(60)
"""


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="it takes Linux's setpriv")
def test_a_training_is_asked_to_end_when_the_app_is_killed(tmp_path):
    """Nobody would see it, and nothing in the app could stop it."""
    command = [sys.executable, "-c", LEAVES, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as app:
        assert app.stdout is not None and app.stdout.readline() == b"started\n"
        app.kill()
    for _ in range(600):
        if (tmp_path / "done").exists():
            return
        time.sleep(0.05)
    raise AssertionError("it goes on")


def choose(session, *cards):
    session.library.look([cards[0].parent])
    assert session.library.wait(10)
    session.gallery.open = True
    session.gallery.selection = tuple(map(str, cards))


def test_one_click_trains_on_the_levels_that_are_chosen(session, began, tmp_path):
    (tmp_path / "mine").mkdir()
    for number, shift in enumerate((0.0, 0.25)):
        body = a_level().bodies[0].replace(position=(1.0 + shift, 2.0))
        level = a_level().replace(name=f"Level {number}", bodies=(body, *a_level().bodies[1:]))
        save_level(level, tmp_path / "mine" / f"{number}.json")
    files = sorted((tmp_path / "mine").iterdir())
    choose(session, *files)
    assert actions.run(session, "gallery.train"), texts(session)
    ((words, _),) = began
    assert words[words.index("--preset") + 1] == "specialist"
    files[0].unlink()
    stored = load_set(Path(words[words.index("--levels") + 1]))
    assert [each.split for each in stored.levels] == ["train", "train"]
    assert session.training.run.name == "2_levels" and not session.gallery.open
    assert session.view.front == "training"
    assert not actions.run(session, "gallery.train")


def test_a_set_is_trained_on_with_its_weights_and_parts(session, began, tmp_path):
    save_level(a_level(), tmp_path / "a.json")
    levels = [dataclasses.replace(gather_levels([tmp_path / "a.json"])[0], weight=3.0)]
    made = build_set(levels, name="mine", folder=tmp_path, split=1.0)
    save_set(made, tmp_path / "mine.json")
    train.train_on_set(session, tmp_path / "mine.json")
    ((words, _),) = began
    (stored,) = load_set(Path(words[words.index("--levels") + 1])).levels
    assert stored.weight == 3.0


@pytest.mark.parametrize(
    "without, told", [("role", "No green shape"), ("joints", "There is nothing to drive")]
)
def test_chosen_levels_without_anything_to_learn_are_named(session, began, tmp_path, without, told):
    (tmp_path / "mine").mkdir()
    plain = tuple(body.replace(role="none") for body in a_level().bodies)
    less = {"bodies": plain} if without == "role" else {"joints": (), "thrusters": ()}
    save_level(a_level().replace(**less), tmp_path / "mine" / "plain.json")
    choose(session, tmp_path / "mine" / "plain.json")
    actions.run(session, "gallery.train")
    (said,) = texts(session)
    assert began == [] and "plain" in said and told in said
    assert not (tmp_path / "agents").exists() or not list((tmp_path / "agents").iterdir())
