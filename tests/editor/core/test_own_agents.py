"""Agents that were trained here: their training goes on, they get names, they go and come back."""

import pytest

from editor import actions
from editor.actions.watching import agents, watch
from editor.agents.local_training import LocalTraining
from editor.base.prompts import MenuQuestion, TextQuestion
from editor.worker.requests import AgentRef
from kinetix.files.lock import locked_folder
from tests.editor.core.helpers import texts
from tests.editor.core.test_train_here import FakeProcess
from tests.editor.core.test_viewer import Stage, a_summary, session, settle, stage

__all__ = ["session", "stage"]


CONFIG = """algorithm = "sfl"
total_timesteps = 2048
num_train_envs = 10
num_steps = 10
"""


@pytest.fixture
def folder(session, tmp_path, monkeypatch):
    """The folder of the user's agents, with one run that is through; the trash beside it."""
    agents = tmp_path / "agents"
    monkeypatch.setattr("editor.actions.training.own_agents.user_agents_dir", lambda: agents)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setattr("editor.gallery.filing.sys.platform", "linux")
    a_run(agents / "hopper", made=2048)
    return agents


def a_run(run, made):
    checkpoint = run / "checkpoints" / str(made)
    checkpoint.mkdir(parents=True)
    (checkpoint / "agent.json").write_text("{}")
    (run / "metrics.jsonl").write_text("")
    (run / "config.toml").write_text(CONFIG)


def started(session):
    found = []

    def start(words, log):
        found.append(list(words))
        return FakeProcess()

    session.training = LocalTraining(start)
    return found


def choose(session, name):
    question = session.prompts[-1]
    assert isinstance(question, MenuQuestion)
    session.answer(question, next(one.id for one in question.choices if one.label == name))


def type_name(session, name):
    question = session.prompts[-1]
    assert isinstance(question, TextQuestion)
    session.answer(question, name)


@pytest.mark.parametrize(
    ("made", "wanted"), [(2048, ["4096"]), (2000, ["4096"]), (1948, []), (1024, [])]
)
def test_a_training_goes_on_to_its_end_or_for_as_long_again(session, folder, made, wanted):
    a_run(folder / "walker", made=made)
    words = started(session)
    assert actions.run(session, "agent.go_on_training")
    choose(session, "walker")
    assert words[0][words[0].index("train") + 1] == "sfl"
    assert words[0][words[0].index("--out") + 1] == str(folder / "walker")
    assert "--preset" not in words[0]
    assert [words[0][n + 1] for n, w in enumerate(words[0]) if w == "--total-timesteps"] == wanted
    assert session.viewer.run.path == str(folder / "walker")
    assert not actions.run(session, "agent.go_on_training")


def test_a_renamed_agent_stays_where_it_is_used(session, stage: Stage, folder):
    for name in ("hopper", "pogo"):
        stage.agents[str(folder / name)] = a_summary("Specialist")
    agents.load_agent(session, folder / "hopper")
    settle(session)
    actions.run(session, "agent.rename")
    choose(session, "hopper")
    type_name(session, "pogo")
    settle(session)
    assert not (folder / "hopper").exists()
    assert (folder / "pogo" / "config.toml").exists()
    assert session.viewer.slots["a"].path == str(folder / "pogo")
    assert session.settings.recent_agents[0] == str(folder / "pogo")
    assert str(folder / "hopper") not in session.settings.recent_agents


def test_a_renamed_agent_keeps_the_chosen_physics_and_is_measured_still(session, stage, folder):
    for name in ("hopper", "pogo"):
        ref = AgentRef(path=str(folder / name), stamp="1")
        stage.agents[ref.path] = a_summary("Specialist", ref=ref, digest="d1")
    agents.load_agent(session, folder / "hopper")
    settle(session)
    session.viewer.contenders = (a_summary("Other"), stage.agents[str(folder / "hopper")])
    session.playback.physics = "accurate"
    actions.run(session, "agent.rename")
    choose(session, "hopper")
    type_name(session, "pogo")
    settle(session)
    assert session.playback.physics == "accurate"
    paths = [one.ref.path for one in session.viewer.contenders]
    assert paths == ["/agents/Other", str(folder / "pogo")]


@pytest.mark.parametrize(
    "name", ["", "  ", "a/b", "..", ".hidden", "dot.", "taken", "x" * 61, "a\0", "\u200b", "a\\b"]
)
def test_a_name_that_cannot_be_is_refused(session, folder, name):
    a_run(folder / "taken", made=1)
    actions.run(session, "agent.rename")
    choose(session, "hopper")
    type_name(session, name)
    assert (folder / "hopper" / "config.toml").exists()
    assert any("cannot be used" in text or "already" in text for text in texts(session))
    # What was typed can be mended.
    assert session.prompts[-1].text == name


def test_a_deleted_agent_leaves_its_slot_and_comes_back(session, stage: Stage, folder):
    stage.agents[str(folder / "hopper")] = a_summary("Specialist")
    agents.load_agent(session, folder / "hopper")
    settle(session)
    assert not actions.run(session, "agent.restore")
    actions.run(session, "agent.delete")
    choose(session, "hopper")
    assert not (folder / "hopper").exists()
    assert session.viewer.slots["a"].summary is None
    assert str(folder / "hopper") not in session.settings.recent_agents
    assert actions.run(session, "agent.restore")
    assert (folder / "hopper" / "config.toml").read_text() == CONFIG
    assert not actions.run(session, "agent.restore")


def test_what_is_learning_is_neither_renamed_nor_deleted(session, folder):
    started(session)
    actions.run(session, "agent.go_on_training")
    choose(session, "hopper")
    actions.run(session, "agent.delete")
    choose(session, "hopper")
    assert (folder / "hopper").exists()
    assert any("is learning just now" in text for text in texts(session))


def test_what_another_process_trains_is_left_alone(session, folder):
    started(session)
    with locked_folder(folder / "hopper", "somebody"):
        for name in ("rename", "delete", "go_on_training"):
            actions.run(session, f"agent.{name}")
            choose(session, "hopper")
            if name == "rename":
                type_name(session, "pogo")
    assert (folder / "hopper" / "config.toml").exists()
    assert sum("another training writes here now" in text for text in texts(session)) >= 1
    assert not session.training.running


def test_what_cannot_come_back_waits_behind_the_others(session, folder):
    a_run(folder / "walker", made=1)
    for name in ("hopper", "walker"):
        actions.run(session, "agent.delete")
        choose(session, name)
    (folder / "walker").mkdir()
    actions.run(session, "agent.restore")
    actions.run(session, "agent.restore")
    assert (folder / "hopper" / "config.toml").exists()
    assert [one.origin.name for one in session.viewer.deleted] == ["walker"]


def test_runs_beside_follow_an_agent_and_go_with_it(session, folder):
    watch.watch_run(session, str(folder / "gone"))
    watch.add_run(session, str(folder / "hopper"))
    actions.run(session, "agent.rename")
    choose(session, "hopper")
    type_name(session, "pogo")
    assert [other.path for other in session.viewer.other_runs] == [str(folder / "pogo")]
    actions.run(session, "agent.delete")
    choose(session, "pogo")
    assert session.viewer.other_runs == ()


@pytest.mark.parametrize("text", ["total_timesteps = inf", "", "total_timesteps =", "\0"])
def test_a_damaged_configuration_gets_a_sentence(session, folder, text):
    started(session)
    (folder / "hopper" / "config.toml").write_text(text)
    actions.run(session, "agent.go_on_training")
    choose(session, "hopper")
    assert any("config.toml" in words for words in texts(session))
    assert not session.training.running


def test_where_nothing_was_trained_that_is_said(session, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "editor.actions.training.own_agents.user_agents_dir", lambda: tmp_path / "none"
    )
    for name in ("go_on_training", "rename", "delete"):
        actions.run(session, f"agent.{name}")
    assert sum("No agent was trained here yet" in text for text in texts(session)) >= 1
    assert session.prompts == []
