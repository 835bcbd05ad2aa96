"""The agent viewer without a window: agents, draws, hands, comparison, evaluation, runs."""

import csv
import dataclasses
import io
import json
import threading
import time
from pathlib import Path

import msgspec
import numpy as np
import pytest

from editor import actions
from editor.actions.evaluation import comparison, measure
from editor.actions.evaluation.save_table import save_table
from editor.actions.files.file import open_path
from editor.actions.playing import physics
from editor.actions.watching import agents, watch
from editor.agents.evaluation import Plan, best
from editor.agents.run_watch import RunWatch
from editor.agents.viewer import mismatch
from editor.base.events import DropEvent
from editor.base.settings import Settings
from editor.documents.commands.level import ReplaceLevel
from editor.gallery.results import Results
from editor.play.mode import Mode
from editor.play.second_player import Follower
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import (
    BUILT_IN,
    AgentRef,
    AgentSummary,
    AgentView,
    AttemptPaths,
    Evaluate,
    EvaluatedLevel,
    Explained,
    LoadAgent,
    Observe,
    Opened,
    OpenEpisode,
    ReadRun,
    RunNews,
    Score,
    Standing,
    TracePaths,
)
from editor.worker.snapshots import Mind, Trace, channels_of
from kinetix.agents.results import EpisodeResult, LevelFailure, LevelResult
from kinetix.errors import CheckpointError, CommandError, KinetixError
from kinetix.level.codec import level_hash, save_level
from kinetix.paths import checkpoints_dir, levels_dir
from tests.editor.core.helpers import FakeSimulator, Hand, a_level, texts

NOOP = (0,) * 6


def a_summary(name="Tester", **changes):
    return dataclasses.replace(
        AgentSummary(
            ref=AgentRef(path=f"/agents/{name}", stamp="1"),
            name=name,
            description="",
            observation="symbolic_entity",
            action="multi_discrete",
            network="entity transformer",
            parameters=10,
            recurrent=False,
            capacity=None,
            any_size=True,
            physics="jax2d",
            frame_skip=2,
            steps=None,
            training="PPO",
            folder=f"/agents/{name}",
        ),
        **changes,
    )


def a_result(name, *outcomes):
    episodes = [EpisodeResult(outcome=o, total_reward=0.5, length=10) for o in outcomes]
    return LevelResult.of(name, episodes)


class Stage:
    """A worker's answers: what is asked is noted, what is answered is set."""

    def __init__(self):
        self.asked = []
        self.agents = {}
        self.news = RunNews(rows=(), total=0, newest=None)
        self.wait = 0.0
        self.opens = True
        self.level = a_level()
        self.paths = None
        self.answers = {}

    def __call__(self, request, progress):
        self.asked.append(request)
        if type(request).__name__ in self.answers:
            return self.answers[type(request).__name__]
        match request:
            case LoadAgent(path=path):
                if path not in self.agents:
                    raise CheckpointError(f"{path}: expected the directory of an agent, found none")
                return self.agents[path]
            case Evaluate():
                return self.evaluate(request, progress)
            case ReadRun():
                return self.news
            case OpenEpisode():
                if not self.opens:
                    raise KinetixError("It cannot be opened")
                return Opened(level=self.level, trace=a_trace())
            case TracePaths():
                return self.paths
            case Observe():
                raise KinetixError("the agent is blind")
        return None

    def evaluate(self, request, progress):
        scores = ()
        total = len(request.levels) * request.attempts
        for number, level in enumerate(request.levels):
            outcomes = ["won", "lost"] * (request.attempts // 2)
            scores += (Score(agent=0, result=a_result(level.name, *outcomes)),)
            standing = Standing(done=(number + 1) * request.attempts, total=total, scores=scores)
            progress.share(standing)
            progress.report(standing.done / total, "")
            until = time.monotonic() + self.wait
            while time.monotonic() < until:
                progress.report(None, "")
                time.sleep(0.005)
        return standing


def a_trace(steps=6):
    simulator = FakeSimulator()
    simulator.start(a_level(), "balanced")
    simulator.advance((None,) * steps)
    snapshots = tuple(simulator.take())
    channels = tuple(channels_of(snapshot.action) for snapshot in snapshots[1:])
    return Trace(
        physics="jax2d", perturbed=False, snapshots=snapshots, actions=channels, player="Tester"
    )


@pytest.fixture
def stage():
    return Stage()


@pytest.fixture
def session(stage, tmp_path):
    made = Session(
        settings=Settings(snap_smart=False, snap_grid=False),
        simulator=FakeSimulator(),
        worker=Worker(perform=stage),
        evaluator=Worker(perform=stage),
        results=Results(tmp_path / "results.json"),
        level=a_level(),
    )
    made.viewer.rival = Follower(FakeSimulator())
    yield made
    made.worker.stop()
    made.evaluator.stop()


def settle(session, seconds=60.0):
    until = time.monotonic() + seconds
    actions.update(session, 1 / 60)
    while not (session.worker.idle and session.evaluator.idle):
        assert time.monotonic() < until
        session.worker.wait(0.01)
        session.evaluator.wait(0.01)
        actions.update(session, 1 / 60)


def run(session, seconds, fps=60):
    for _ in range(round(seconds * fps)):
        actions.update(session, 1 / fps)


@pytest.fixture
def with_agent(session, stage):
    stage.agents["/agents/Tester"] = a_summary()
    agents.load_agent(session, "/agents/Tester")
    settle(session)
    return session


def test_the_scripted_agents_are_those_of_the_package():
    from kinetix.agents.named import BUILT_IN as THEIRS

    assert BUILT_IN == THEIRS


def test_loading_an_agent_takes_its_physics_and_gets_ready(with_agent, stage):
    place = with_agent.viewer.slots["a"]
    assert (place.summary.name, place.loading, place.error) == ("Tester", False, "")
    assert with_agent.playback.physics == "jax2d"
    assert [type(request).__name__ for request in stage.asked] == ["LoadAgent", "Rehearse"]
    assert with_agent.settings.recent_agents == ["/agents/Tester"]


def test_an_agent_that_is_loaded_while_a_person_plays_leaves_their_physics(session, stage):
    stage.agents["/agents/Tester"] = a_summary()
    session.playback.simulator.ends_at, session.playback.simulator.ends = 10, "won"
    assert actions.run(session, "run.play_human")
    run(session, 0.1)
    agents.load_agent(session, "/agents/Tester")
    settle(session)
    assert session.playback.physics == "jax2d"
    run(session, 1.0)
    assert session.mode is Mode.ENDED
    assert actions.run(session, "level.keep_solution")
    assert session.document.level.solution.physics == "balanced"


def test_what_cannot_be_loaded_is_one_sentence_and_the_old_agent_stays(with_agent):
    agents.load_agent(with_agent, "/nothing/here")
    settle(with_agent)
    place = with_agent.viewer.slots["a"]
    assert place.error == "/nothing/here: expected the directory of an agent, found none"
    assert place.summary.name == "Tester"
    assert any("/nothing/here" in text for text in texts(with_agent))


@pytest.mark.parametrize("name", ["goalkeeper", "checkpoints/goalkeeper"])
def test_a_bundled_agent_has_a_name_from_any_folder(session, stage, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    path = str(checkpoints_dir() / "goalkeeper")
    stage.agents[path] = a_summary("goalkeeper")
    agents.load_agent(session, name)
    settle(session)
    assert session.viewer.slots["a"].summary.name == "goalkeeper"
    assert session.settings.recent_agents == [path]


def test_a_mistyped_agent_is_told_which_there_are():
    from editor.worker.simulation import cast

    with pytest.raises(CheckpointError, match=r"^golkeeper: .*did you mean 'goalkeeper'"):
        cast.load("golkeeper")


def test_a_dropped_folder_is_an_agent(session, stage, tmp_path):
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "agent.json").write_text("{}")
    stage.agents[str(folder)] = a_summary("mine")
    for dropped in (folder, folder / "agent.json"):
        session.viewer.slots["a"].summary = None
        actions.handle(session, DropEvent(path=str(dropped)))
        settle(session)
        assert session.viewer.slots["a"].summary.name == "mine"
    assert session.view.front == "agents"


def test_agents_are_chosen_from_those_of_the_app_the_planner_and_the_scripted(session):
    assert actions.run(session, "agent.choose_a")
    assert session.prompts[-1].title == "Agent A"
    ids = [choice.id for choice in session.prompts[-1].choices]
    assert "planner" in ids and "random" in ids and "browse" in ids
    assert any(Path(path).name == "goalkeeper" for path in ids)


def a_planner():
    return a_summary("planner", ref=AgentRef(path="planner"), capacity=None, physics="balanced")


@pytest.mark.parametrize("other", [{"physics": "accurate"}, {"card_digest": "c2"}])
def test_an_agent_of_equal_parameters_and_another_card_brings_its_physics(session, stage, other):
    for name, changes in (("One", {}), ("Two", other)):
        told = {"digest": "d", "card_digest": "c1", "physics": "fast", **changes}
        stage.agents[f"/agents/{name}"] = a_summary(name, **told)
    agents.load_agent(session, "/agents/One")
    settle(session)
    session.playback.physics = "jax2d"
    agents.load_agent(session, "/agents/Two")
    settle(session)
    assert session.playback.physics == session.viewer.slots["a"].summary.physics


def test_f6_without_an_agent_lets_the_planner_play(session, stage):
    stage.agents["planner"] = a_planner()
    session.playback.physics = "accurate"
    assert actions.run(session, "run.play_agent")
    settle(session)
    assert session.playback.active
    assert session.playback.player == "planner"
    # It plays under whatever physics is chosen, and is no agent of the user's.
    assert session.playback.physics == "accurate"
    assert session.settings.recent_agents == []


@pytest.mark.parametrize("begun", ["level.gallery", "file.save_as", "a rectangle"])
def test_an_agent_that_is_awaited_does_not_interrupt_what_was_begun_meanwhile(
    session, stage, begun
):
    stage.agents["planner"] = a_planner()
    assert actions.run(session, "run.play_agent")
    if begun == "a rectangle":
        hand = Hand(session)
        hand.key("r")
        hand.press((1.0, 1.0))
        hand.move((2.0, 2.0))
    else:
        actions.run(session, begun)
    settle(session)
    assert session.viewer.slots["a"].summary is not None
    assert not session.playback.active
    assert session.gallery.open or session.prompts or session.driver.active


def test_where_the_agent_cannot_play_the_level_the_planner_does(session, stage):
    stage.agents["planner"] = a_planner()
    stage.agents["/agents/Small"] = a_summary("Small", any_size=False, capacity=(4, 0, 0, 0))
    agents.load_agent(session, "/agents/Small")
    settle(session)
    assert actions.run(session, "run.play_agent")
    settle(session)
    assert session.playback.player == "planner"
    assert any("Small: It cannot play this level" in text for text in texts(session))


def test_an_agent_that_cannot_play_a_level_says_so_and_comes_back_where_it_can(
    session, stage, tmp_path
):
    stage.agents["planner"] = a_planner()
    small = a_summary("Small", ref=AgentRef(path="/agents/Small"), any_size=False)
    stage.agents["/agents/Small"] = dataclasses.replace(small, capacity=(4, 0, 0, 0))
    agents.load_agent(session, "/agents/Small")
    settle(session)
    assert "Loaded Small. It cannot play this level: here F6 lets the planner play." in texts(
        session
    )
    actions.run(session, "run.play_agent")
    settle(session)
    session.leave_play()
    place = session.viewer.slots["a"]
    assert place.summary.name == "planner" and place.passed_over.name == "Small"
    stage.agents["/agents/Small"] = place.passed_over = dataclasses.replace(small, any_size=True)
    actions.run(session, "run.play_agent")
    settle(session)
    assert session.playback.player == "Small"
    assert place.passed_over is None


def test_an_episode_waits_while_a_question_is_open(with_agent):
    actions.run(with_agent, "run.play_agent")
    run(with_agent, 0.5)
    actions.run(with_agent, "file.save_as")
    run(with_agent, 0.1)
    asked = with_agent.playback.snapshot.step
    run(with_agent, 2.0)
    assert with_agent.prompts and with_agent.playback.snapshot.step == asked
    with_agent.answer(with_agent.prompts[-1], None)
    run(with_agent, 0.5)
    assert with_agent.playback.snapshot.step > asked


def test_who_watches_an_agent_goes_on_watching_it_in_the_next_level(with_agent, tmp_path):
    for name in ("a", "b", "c"):
        save_level(a_level().replace(name=name), tmp_path / f"{name}.json")
    open_path(with_agent, tmp_path / "a.json")
    actions.run(with_agent, "run.play_agent")
    settle(with_agent)
    actions.run(with_agent, "level.next")
    settle(with_agent)
    assert with_agent.document.title == "b.json"
    assert with_agent.playback.active and with_agent.playback.player == "Tester"
    assert with_agent.playback.level.name == "b"
    with_agent.leave_play()
    actions.run(with_agent, "level.previous")
    assert with_agent.editing and with_agent.document.title == "a.json"


def test_the_next_level_is_the_next_that_can_be_opened(with_agent, tmp_path):
    for name in ("a", "d"):
        save_level(a_level().replace(name=name), tmp_path / f"{name}.json")
    (tmp_path / "b.json").write_text('{"format":')
    (tmp_path / "c.json").touch()
    (tmp_path / "e.json").write_text('{"format": "kinetix-levelset", "levels": []}')
    open_path(with_agent, tmp_path / "a.json")
    for action, title in (("next", "d"), ("next", "a"), ("previous", "d"), ("previous", "a")):
        actions.run(with_agent, f"level.{action}")
        assert with_agent.document.title == f"{title}.json"
        assert not with_agent.prompts
    assert any(t.text.startswith("b.json, c.json: cannot be opened") for t in with_agent.toasts)


def test_the_agent_plays_and_the_document_stays(with_agent):
    before = with_agent.document.hash
    Hand(with_agent).key("f6")
    assert with_agent.playback.casting == with_agent.viewer.casting("a")
    run(with_agent, 1.0)
    snapshot = with_agent.playback.snapshot
    assert snapshot.step in (29, 30)
    # The stage's agent goes backwards on motor 0 all the time.
    assert snapshot.action[0] == -1.0
    assert with_agent.playback.trace.actions[-1] == (2, 0, 0, 0, 0, 0)
    assert with_agent.playback.trace.player == "Tester"
    actions.run(with_agent, "run.stop")
    assert with_agent.document.hash == before


def test_held_keys_take_over_and_letting_go_hands_back(with_agent):
    hand = Hand(with_agent)
    hand.key("f6")
    run(with_agent, 0.5)
    assert not with_agent.playback.perturbed
    hand.down("left")
    run(with_agent, 0.2)
    assert with_agent.playback.snapshot.action[0] == 1.0
    assert with_agent.playback.perturbed
    hand.up("left")
    run(with_agent, 0.2)
    assert with_agent.playback.snapshot.action[0] == -1.0


def test_taking_over_lasts_until_handing_back(with_agent):
    hand = Hand(with_agent)
    hand.key("f6")
    run(with_agent, 0.2)
    hand.key("t")
    run(with_agent, 0.2)
    assert with_agent.playback.snapshot.action[0] == 0.0
    hand.key("t")
    run(with_agent, 0.2)
    assert with_agent.playback.snapshot.action[0] == -1.0


def test_another_attempt_starts_anew_with_other_draws(with_agent):
    hand = Hand(with_agent)
    hand.key("f6")
    run(with_agent, 0.5)
    hand.key("n")
    assert with_agent.playback.casting.attempt == 1
    assert with_agent.playback.waiting
    run(with_agent, 0.1)
    hand.key("b")
    assert with_agent.playback.casting.attempt == 0
    assert not actions.run(with_agent, "agent.previous_attempt")
    actions.run(with_agent, "agent.deterministic")
    assert with_agent.playback.casting.deterministic


def test_an_agent_that_fails_pauses_with_the_reason(with_agent):
    Hand(with_agent).key("f6")
    run(with_agent, 0.5)
    with_agent.playback.simulator.error = "The agent 'Tester' gave NaN."
    run(with_agent, 0.1)
    assert with_agent.mode is Mode.PAUSED
    assert with_agent.playback.failure.startswith("The agent 'Tester' gave")
    assert actions.run(with_agent, "run.stop")


def test_looking_back_and_starting_from_there(with_agent):
    Hand(with_agent).key("f6")
    run(with_agent, 1.0)
    playback = with_agent.playback
    seen = playback.moments
    playback.scrub(10)
    assert (with_agent.mode, playback.step_count) == (Mode.REPLAY, 10)
    assert playback.snapshot is seen[10]
    run(with_agent, 0.5)
    assert playback.step_count == 10
    assert actions.run(with_agent, "run.start_here")
    assert (with_agent.mode, len(playback.ring)) == (Mode.PAUSED, 11)
    actions.run(with_agent, "run.pause")
    run(with_agent, 0.2)
    assert 13 <= playback.step_count <= 18
    np.testing.assert_array_equal(playback.moments[10].position, seen[10].position)
    np.testing.assert_array_equal(playback.moments[12].position, seen[12].position)


def test_a_replay_plays_loops_and_stops_at_its_end(with_agent):
    Hand(with_agent).key("f6")
    run(with_agent, 1.0)
    playback = with_agent.playback
    playback.scrub(3)
    actions.run(with_agent, "run.loop_from")
    playback.scrub(6)
    actions.run(with_agent, "run.loop_to")
    assert playback.loop == (3, 6)
    actions.run(with_agent, "run.pause")
    indexes = []
    for _ in range(60):
        run(with_agent, 1 / 30, 30)
        indexes.append(playback.replay_index)
    assert set(indexes) == {3, 4, 5, 6}
    actions.run(with_agent, "run.loop_clear")
    run(with_agent, 3.0)
    assert playback.replay_index == len(playback.moments) - 1
    assert not playback.running


def test_an_episode_from_elsewhere_can_be_branched_from(with_agent):
    playback = with_agent.playback
    casting = with_agent.viewer.casting("a")
    playback.replay(a_trace(), a_level(), casting, player="Tester")
    playback.scrub(4)
    playback.branch()
    actions.update(with_agent, 1 / 60)
    assert (with_agent.mode, playback.step_count) == (Mode.PAUSED, 4)
    playback.pause()
    run(with_agent, 0.2)
    assert playback.step_count > 4
    assert playback.moments[4] is playback.ring.snapshots[4]


def test_a_person_who_starts_a_files_episode_anew_is_not_called_by_the_agents_name(with_agent):
    playback = with_agent.playback
    playback.replay(dataclasses.replace(a_trace(), from_file=True), a_level())
    assert playback.player == "Tester"
    assert actions.run(with_agent, "run.reset")
    run(with_agent, 0.2)
    assert (playback.casting, playback.player, playback.trace.player) == (None, "", "")


def test_the_end_cannot_be_branched_from(with_agent):
    with_agent.playback.simulator.ends_at = 5
    Hand(with_agent).key("f6")
    run(with_agent, 1.0)
    assert with_agent.mode is Mode.ENDED
    with_agent.playback.scrub(5)
    assert not actions.run(with_agent, "run.start_here")
    with_agent.playback.scrub(4)
    assert actions.run(with_agent, "run.start_here")


def test_the_second_player_keeps_step(with_agent, stage):
    stage.agents["/agents/Other"] = a_summary("Other", frame_skip=2)
    agents.load_agent(with_agent, "/agents/Other", "b")
    settle(with_agent)
    assert actions.run(with_agent, "agent.compare_ghost")
    Hand(with_agent).key("f6")
    run(with_agent, 1.0)
    playback, rival = with_agent.playback, with_agent.viewer.rival
    assert rival.player == "Other"
    assert rival.simulator.casting.agent.path == "/agents/Other"
    shown = rival.shown(playback.engine_step)
    assert shown.step == playback.step_count
    playback.scrub(7)
    assert rival.shown(playback.engine_step).step == 7
    actions.run(with_agent, "run.reset")
    actions.update(with_agent, 1 / 60)
    assert len(rival.snapshots) < 5
    actions.run(with_agent, "run.stop")
    actions.update(with_agent, 1 / 60)
    assert not rival.active


def test_the_second_player_plays_to_its_own_end(with_agent, stage):
    stage.agents["/agents/Other"] = a_summary("Other")
    agents.load_agent(with_agent, "/agents/Other", "b")
    settle(with_agent)
    actions.run(with_agent, "agent.compare_ghost")
    playback, rival = with_agent.playback, with_agent.viewer.rival
    playback.simulator.ends_at, playback.simulator.ends = 20, "won"
    rival.simulator.ends_at, rival.simulator.ends = 40, "lost"
    with_agent.settings.restart_automatically = True
    Hand(with_agent).key("f6")
    run(with_agent, 0.9)
    assert playback.mode is Mode.ENDED
    assert rival.goes_on and 20 <= rival.shown(playback.engine_step).step < 40
    episode = playback.episode
    run(with_agent, 1.0)
    assert playback.episode == episode
    assert not rival.goes_on and rival.shown(playback.engine_step).outcome == "lost"
    # The timeline has the moments of the first one: there they are side by side.
    playback.scrub(10)
    run(with_agent, 0.1)
    assert rival.shown(playback.engine_step).step == 10


def test_a_person_plays_against_an_agent(with_agent, stage):
    stage.agents["/agents/Other"] = a_summary("Other")
    agents.load_agent(with_agent, "/agents/Other", "b")
    settle(with_agent)
    actions.run(with_agent, "agent.compare_side")
    Hand(with_agent).key("space")
    run(with_agent, 0.5)
    assert with_agent.playback.casting is None
    assert with_agent.viewer.rival.shown(with_agent.playback.engine_step).step > 10


def test_players_of_different_frame_skip_meet_in_time():
    follower = Follower(FakeSimulator())
    follower.start(a_level(), "balanced", None, player="slow")
    follower.tick(0)
    follower.snapshots = [dataclasses.replace(follower.snapshots[0], frame_skip=4)]
    for engine_step in range(0, 41, 2):
        follower.tick(engine_step)
    assert follower.shown(20).step == 5
    assert follower.shown(22).step == 5
    assert follower.shown(24).step == 6


def test_without_b_no_comparison_is_on(with_agent):
    viewer = with_agent.viewer
    viewer.slots["b"].summary, viewer.compare = a_summary("Other"), "ghost"
    agents.clear_slot(with_agent, "a")
    assert viewer.compare == "ghost"
    agents.clear_slot(with_agent, "b")
    assert viewer.compare == "off"


@pytest.mark.parametrize(("slot", "follows"), [("a", False), ("b", True)])
def test_a_checkpoint_that_is_chosen_stays_and_one_of_b_leaves_a_following(
    with_agent, slot, follows
):
    agents.show_checkpoint(with_agent, slot, Path("/runs/car/checkpoints/100"))
    assert with_agent.viewer.follow_run is follows


def test_comparing_needs_a_second_agent(with_agent):
    actions.run(with_agent, "agent.compare_ghost")
    assert with_agent.viewer.compare == "off"
    assert any("agent B" in text for text in texts(with_agent))


def evaluation_of(session, *names, attempts=4):
    level = a_level()
    sources = tuple(EvaluatedLevel(name=name, source=level) for name in names)
    plan = Plan(
        agents=session.viewer.agents,
        levels=sources,
        hashes=tuple(f"hash {name}" for name in names),
        attempts=attempts,
    )
    session.viewer.evaluation.start(plan)
    return session.viewer.evaluation


def test_the_table_sorts_filters_and_says_what_the_command_says(with_agent):
    evaluation = evaluation_of(with_agent, "s/a", "s/b", "m/c")
    settle(with_agent)
    assert evaluation.complete
    assert [row.name for row in evaluation.rows(wanted="S/")] == ["s/a", "s/b"]
    assert [row.name for row in evaluation.rows(descending=True)] == ["s/b", "s/a", "m/c"]
    lines = [json.loads(line) for line in evaluation.json_lines().splitlines()]
    assert lines[0] == a_result("s/a", "won", "lost", "won", "lost").as_dict()
    assert lines[-1]["mean_solve_rate"] == 0.5 and lines[-1]["agent"] == "Tester"
    rows = list(csv.DictReader(io.StringIO(evaluation.csv_text())))
    assert [row["level"] for row in rows] == ["s/a", "s/b", "m/c"]
    assert rows[0]["failures"] == "2 lost"
    told = {name: rows[0][name] for name in ("level_hash", "physics", "seed", "attempts")}
    assert told == {"level_hash": "hash s/a", "physics": "jax2d", "seed": "0", "attempts": "4"}
    assert (rows[0]["agent"], rows[0]["deterministic"]) == ("Tester", "False")


def test_results_are_kept_for_the_gallery(with_agent):
    evaluation_of(with_agent, "s/a")
    settle(with_agent)
    actions.update(with_agent, 1 / 60)
    (trial,) = with_agent.results.of("hash s/a")
    assert (trial.player, trial.physics, trial.seed) == ("Tester", "jax2d", 0)
    record = with_agent.results.of("hash s/a")[trial]
    assert (record.attempts, record.solved) == (4, 2)


def test_a_level_that_an_agent_cannot_play_says_so_in_table_and_file(with_agent, stage):
    failure = LevelFailure(level="s/b", error="too large")
    score = Score(agent=0, result=a_result("s/a", "won", "won"))
    stage.evaluate = lambda request, progress: Standing(
        done=4, total=4, scores=(score,), failures=((0, failure),)
    )
    evaluation = evaluation_of(with_agent, "s/b", "s/a")
    settle(with_agent)
    assert [row.errors for row in evaluation.rows()] == [("",), ("too large",)]
    *lines, summary = map(json.loads, evaluation.json_lines().splitlines())
    assert lines == [failure.as_dict(), score.result.as_dict()]
    assert (summary["levels"], summary["mean_solve_rate"], summary["physics"]) == (1, 1.0, "jax2d")
    rows = list(csv.DictReader(io.StringIO(evaluation.csv_text())))
    assert [row["error"] for row in rows] == ["too large", ""]


def test_an_evaluation_is_cancelled_at_once_and_keeps_what_is_done(with_agent, stage):
    stage.wait = 600.0
    evaluation = evaluation_of(with_agent, "s/a", "s/b")
    until = time.monotonic() + 60
    while evaluation.standing is None and time.monotonic() < until:
        actions.update(with_agent, 1 / 60)
        time.sleep(0.01)
    start = time.monotonic()
    assert actions.run(with_agent, "agent.cancel_evaluation")
    assert not evaluation.running
    settle(with_agent)
    assert time.monotonic() - start < 60.0
    assert [row.results[0] is None for row in evaluation.rows()] == [False, True]
    assert with_agent.results.of("hash s/a") and not with_agent.results.of("hash s/b")


@pytest.mark.parametrize("end", ["fails", "is replaced", "is left"])
def test_an_evaluation_that_ends_early_leaves_the_gallery_its_levels(with_agent, stage, end):
    share = threading.Event()

    def evaluate(request, progress):
        score = Score(agent=0, result=a_result("s/a", "won", "won"))
        progress.share(Standing(done=2, total=4, scores=(score,)))
        share.set()
        while end != "fails":
            progress.report(None, "")
            time.sleep(0.005)
        raise KinetixError("out of memory")

    stage.evaluate = evaluate
    evaluation = evaluation_of(with_agent, "s/a", "s/b")
    assert share.wait(60)
    if end == "is replaced":
        evaluation_of(with_agent, "m/c")
    elif end == "is left":
        actions.run(with_agent, "file.quit")
        with_agent.answer(with_agent.prompts[-1], "quit")
        assert with_agent.quitting
    else:
        settle(with_agent)
        assert evaluation.error == "out of memory"
    actions.update(with_agent, 1 / 60)
    ((trial, record),) = with_agent.results.of("hash s/a").items()
    assert (trial.player, record.attempts, record.solved) == ("Tester", 2, 2)
    evaluation.cancel()


def test_the_table_of_a_cancelled_evaluation_says_what_can_be_saved(with_agent, stage, tmp_path):
    stage.wait = 600.0
    evaluation = evaluation_of(with_agent, "s/a", "s/b")
    while evaluation.standing is None:
        actions.update(with_agent, 1 / 60)
    with pytest.raises(CommandError, match="Wait until an agent has played all levels"):
        save_table(with_agent, tmp_path / "table.html")
    evaluation.cancel()
    with pytest.raises(CommandError, match="No agent has played all levels"):
        save_table(with_agent, tmp_path / "table.html")
    save_table(with_agent, tmp_path / "table.csv")
    assert "s/a" in (tmp_path / "table.csv").read_text()


def test_a_saved_comparison_names_the_agents_that_it_leaves_out(with_agent, stage, tmp_path):
    other = a_summary("Other")
    with_agent.viewer.slots["b"].summary = other
    score = Score(agent=0, result=a_result("s/a", "won", "won"))
    stage.evaluate = lambda request, progress: Standing(done=2, total=4, scores=(score,))
    evaluation_of(with_agent, "s/a")
    settle(with_agent)
    save_table(with_agent, tmp_path / "table.json")
    assert texts(with_agent)[-1].endswith(
        "table.json, without agents that have not played every level: Other"
    )


def test_the_best_of_several_results():
    good, bad = a_result("x", *["won"] * 20), a_result("x", *["lost"] * 20)
    assert best((good, bad)) == 0
    assert best((bad, good)) == 1
    assert best((bad, bad)) is None
    assert best((None, bad)) is None


def test_results_whose_intervals_overlap_are_not_told_apart():
    good, bad = a_result("x", "won", "won"), a_result("x", "won", "lost")
    assert best((good, bad)) is None


def measure_the_level_in_front(session, *who, attempts=4, seed=0):
    measure.start_evaluation(
        session, who, (), attempts=attempts, seed=seed, physics="", deterministic=False
    )
    settle(session)


def test_an_attempt_of_the_table_opens_as_a_replay(with_agent):
    measure_the_level_in_front(with_agent, a_summary())
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    playback = with_agent.playback
    assert (with_agent.mode, playback.player) == (Mode.REPLAY, "Tester")
    assert playback.casting.attempt == 3
    assert with_agent.view.front == "timeline"


def test_an_attempt_is_not_shown_on_a_file_that_was_changed_since(with_agent, stage, tmp_path):
    path = tmp_path / "a.json"
    save_level(a_level(), path)
    assert open_path(with_agent, path)
    measure_the_level_in_front(with_agent, a_summary())
    stage.level = a_level().replace(gravity=(0.0, -1.0))
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    assert with_agent.mode is Mode.EDIT
    assert any("another level by now" in text for text in texts(with_agent))
    stage.paths = AttemptPaths(
        level_hash=level_hash(stage.level),
        step=np.arange(1),
        position=np.zeros((1, 1, 2)),
        outcomes=("won",),
        parting=None,
    )
    measure.show_paths(with_agent, 0, 0)
    settle(with_agent)
    assert with_agent.viewer.ways is None


def test_an_attempt_on_a_level_in_another_tab_brings_that_tab_to_the_front(with_agent):
    measured = with_agent.document
    measure_the_level_in_front(with_agent, a_summary())
    actions.run(with_agent, "file.new")
    assert len(with_agent.tabs) == 2
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    assert with_agent.mode is Mode.REPLAY and with_agent.document is measured
    # Its tab shows another level by now: the one that was measured comes in a tab of its own.
    with_agent.leave_play()
    with_agent.execute(ReplaceLevel(level=a_level().replace(gravity=(0.0, -1.0)), label=""))
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    assert with_agent.mode is Mode.REPLAY and with_agent.document is not measured
    assert with_agent.document.level == a_level()


def test_an_attempt_waits_for_the_answer_whether_its_level_is_to_be_opened(
    with_agent, tmp_path, monkeypatch
):
    path = tmp_path / "a.json"
    save_level(a_level(), path)
    measure.start_evaluation(
        with_agent,
        (a_summary(),),
        (str(path),),
        attempts=4,
        seed=0,
        physics="",
        deterministic=False,
    )
    settle(with_agent)
    monkeypatch.setattr(with_agent.autosaves, "open_elsewhere", lambda path: True)
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    assert "another window" in with_agent.prompts[-1].title
    assert with_agent.mode is Mode.EDIT
    measure.show_paths(with_agent, 0, 0)
    assert not with_agent.viewer.ways_pending
    # The answer opens the level; the attempt is opened by the next click.
    with_agent.answer(with_agent.prompts[-1], "open")
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    assert with_agent.mode is Mode.REPLAY and with_agent.document.path == path


def test_reset_and_the_next_attempt_go_on_from_the_attempt_that_was_opened(with_agent):
    other = a_summary("Other")
    with_agent.viewer.slots["b"].summary = other
    measure_the_level_in_front(with_agent, a_summary(), other, seed=3)
    with_agent.viewer.deterministic = True
    playback = with_agent.playback
    measure.open_attempt(with_agent, 0, 1, 2)
    settle(with_agent)
    actions.run(with_agent, "agent.compare_ghost")
    actions.update(with_agent, 1 / 60)
    assert (with_agent.viewer.rival.casting.seed, with_agent.viewer.rival.casting.attempt) == (3, 2)
    for action, attempt in (("run.reset", 2), ("agent.next_attempt", 3)):
        assert actions.run(with_agent, action)
        casting = playback.casting
        assert (playback.player, casting.agent.path) == ("Other", "/agents/Other")
        assert (casting.seed, casting.attempt, casting.deterministic) == (3, attempt, False)
    # Agent A plays again when it is asked to.
    assert actions.run(with_agent, "run.play_agent") and actions.run(with_agent, "run.reset")
    assert playback.player == "Tester"


def an_opened_attempt(session):
    """Open attempt 2 of seed 7 under jax2d, drawn; the viewer itself is set to other things."""
    measure_the_level_in_front(session, a_summary(), seed=7)
    session.viewer.seed, session.viewer.attempt, session.viewer.deterministic = 3, 1, True
    session.playback.physics = "accurate"
    measure.open_attempt(session, 0, 0, 2)
    settle(session)
    assert session.mode is Mode.REPLAY


def draws_of(casting):
    return casting.seed, casting.attempt, casting.deterministic


@pytest.mark.parametrize("way", ["stop", "agent", "human", "failure", "loading"])
def test_an_opened_attempt_leaves_the_viewers_own_settings_alone(with_agent, way):
    viewer, playback = with_agent.viewer, with_agent.playback
    an_opened_attempt(with_agent)
    assert actions.run(with_agent, "agent.next_attempt")
    assert (draws_of(playback.casting), playback.played_under) == ((7, 3, False), "jax2d")
    measure.open_attempt(with_agent, 0, 0, 3)
    settle(with_agent)
    playback.branch()
    assert actions.run(with_agent, "run.reset")
    assert (draws_of(playback.casting), playback.played_under) == ((7, 3, False), "jax2d")
    assert playback.next_physics == "jax2d"
    # What is measured next, and what the person plays, has their own.
    assert (draws_of(viewer), playback.physics) == ((3, 1, True), "accurate")
    match way:
        case "stop":
            actions.run(with_agent, "run.stop")
        case "human":
            actions.run(with_agent, "run.stop")
            assert actions.run(with_agent, "run.play_human")
        case "failure":
            playback.stop()
            actions.update(with_agent, 1 / 60)
        case "loading":
            agents.load_agent(with_agent, "/agents/Tester")
    if way != "human":
        assert actions.run(with_agent, "run.play_agent")
        settle(with_agent)
        assert draws_of(playback.casting) == (3, 1, True)
        assert draws_of(viewer.draws) == (3, 1, True)
    assert playback.played_under == playback.next_physics == "accurate"


def test_what_is_set_while_an_attempt_is_open_holds_for_it(with_agent):
    viewer, playback = with_agent.viewer, with_agent.playback
    an_opened_attempt(with_agent)
    agents.set_draws(with_agent, seed=9)
    assert draws_of(playback.casting) == (9, 2, False) and viewer.seed == 3
    agents.switch_deterministic(with_agent)
    assert draws_of(playback.casting) == (9, 2, True)
    # A physics that is chosen meanwhile is the person's, for this episode too.
    physics.choose(with_agent, "fast")
    assert playback.played_under == playback.physics == playback.next_physics == "fast"


def test_a_changed_moment_of_an_opened_attempt_goes_on_under_its_physics(with_agent):
    playback = with_agent.playback
    an_opened_attempt(with_agent)
    actions.run(with_agent, "run.reset")
    run(with_agent, 0.2)
    actions.run(with_agent, "run.pause")
    run(with_agent, 0.2)
    actions.run(with_agent, "run.change")
    assert with_agent.tab.moment is not None
    changed = with_agent.document.level.replace(name="changed")
    with_agent.execute(ReplaceLevel(level=changed, label="Change"))
    actions.run(with_agent, "run.play_human")
    assert playback.active and playback.played_under == "jax2d"
    actions.run(with_agent, "run.reset")
    assert (draws_of(playback.casting), playback.played_under) == ((7, 2, False), "jax2d")


def test_a_checkpoint_that_is_chosen_plays_the_same_draws_of_an_opened_attempt(with_agent, stage):
    path = "/runs/one/checkpoints/100"
    an_opened_attempt(with_agent)
    stage.agents[path] = a_summary("Older", ref=AgentRef(path=path, stamp="1"))
    agents.show_checkpoint(with_agent, "a", Path(path))
    settle(with_agent)
    playback = with_agent.playback
    assert (playback.player, draws_of(playback.casting)) == ("Older", (7, 2, False))
    assert playback.played_under == "jax2d"


@pytest.mark.parametrize("fails", [False, True])
def test_an_attempt_that_comes_too_late_leaves_the_game_alone(with_agent, stage, fails):
    evaluation_of(with_agent, "s/a")
    settle(with_agent)
    stage.opens = not fails
    measure.open_attempt(with_agent, 0, 0, 3)
    assert actions.run(with_agent, "run.play_human")
    settle(with_agent)
    run(with_agent, 0.2)
    assert (with_agent.mode, with_agent.playback.player) == (Mode.PLAYING, "")
    assert ("It cannot be opened" in texts(with_agent)) == fails


def test_levels_are_named_as_on_the_command_line(session, tmp_path):
    ((level, sha256),) = measure.levels_named(session, ())
    assert level.source == session.document.level and sha256 == session.document.hash
    ((level, _),) = measure.levels_named(session, ("s/goalkeeper",))
    assert level.name == "s/goalkeeper"
    assert Path(level.source).name == "goalkeeper.json"
    # The gallery names files.
    chosen = tuple(str(levels_dir() / "s" / f"{name}.json") for name in ("hang_on", "plank_dash"))
    found = measure.levels_named(session, chosen)
    assert [level.name for level, _ in found] == ["s/hang_on", "s/plank_dash"]
    assert measure.levels_named(session, (str(levels_dir() / "s"),))[0][0].name == "circus_act"
    # Tables do not tell where somebody keeps their files.
    mine = (tmp_path / "one.json", tmp_path / "more" / "two.json")
    mine[1].parent.mkdir()
    for path in mine:
        save_level(session.document.level, path)
    found = measure.levels_named(session, (*map(str, mine), "s/goalkeeper"))
    assert [level.name for level, _ in found] == ["one", "more/two", "s/goalkeeper"]


def values(watched, name):
    return watched.metrics.column(name)[1].tolist()


def test_a_training_run_is_read_and_its_newest_agent_taken(session, stage):
    stage.agents["/runs/one"] = a_summary("one", ref=AgentRef(path="/runs/one", stamp="a"))
    stage.news = RunNews(rows=({"loss": 1.0}, {"loss": 0.5}), total=2, newest=100)
    watch.watch_run(session, "/runs/one")
    settle(session)
    run_ = session.viewer.run
    assert values(run_, "loss") == [1.0, 0.5]
    assert session.viewer.slots["a"].summary.ref.stamp == "a"
    Hand(session).key("f6")
    run(session, 0.5)
    stage.agents["/runs/one"] = a_summary("one", ref=AgentRef(path="/runs/one", stamp="b"))
    stage.news = RunNews(rows=({"loss": 0.25},), total=3, newest=200)
    run(session, 2.0)
    settle(session)
    assert values(run_, "loss") == [1.0, 0.5, 0.25]
    assert session.viewer.slots["a"].summary.ref.stamp == "b"
    # The episode under way goes on with the agent that began it.
    assert session.playback.casting.agent.stamp == "a"
    actions.run(session, "run.reset")
    assert session.playback.casting.agent.stamp == "b"


def test_a_run_that_was_set_back_is_read_anew(session, stage):
    stage.news = RunNews(rows=({"x": 1.0}, {"x": 2.0}), total=2, newest=None)
    watch.watch_run(session, "/runs/one")
    settle(session)
    stage.news = RunNews(rows=({"x": 7.0},), total=1, newest=None)
    run(session, 2.1)
    settle(session)
    assert values(session.viewer.run, "x") == [7.0]


def test_a_run_that_is_pointed_at_again_while_it_is_read_has_each_row_once(session, stage):
    watched = RunWatch(session.worker)

    def read(now):
        watched.tick(now, lambda steps: None)
        while session.worker.jobs:
            time.sleep(0.001)

    stage.news = RunNews(rows=({"x": 1.0}, {"x": 2.0}), total=2, newest=None)
    watched.watch("/runs/one")
    read(0.0)
    session.worker.poll()
    stage.news = RunNews(rows=({"x": 3.0},), total=3, newest=None)
    read(3.0)  # what comes after two rows
    watched.watch("/runs/one")
    session.worker.poll()
    assert len(watched.metrics) == 0
    stage.news = RunNews(rows=({"x": 1.0}, {"x": 2.0}, {"x": 3.0}), total=3, newest=None)
    read(4.0)
    session.worker.poll()
    assert values(watched, "x") == [1.0, 2.0, 3.0]


def test_a_mismatch_is_explained():
    level = a_level()
    flat = a_summary(capacity=(5, 1, 1, 1), any_size=False)
    sentence = mismatch(flat, level)
    assert sentence.startswith("It cannot play this level: it sees one size only")
    assert "circles (it knows 1)" in sentence
    assert mismatch(dataclasses.replace(flat, any_size=True), level).startswith("It can play, but")
    assert mismatch(a_summary(), level) == ""


def test_room_that_a_level_leaves_empty_is_not_said_to_be_there():
    """A level of size l without thrusters has none, whatever it has room for."""
    level = msgspec.structs.replace(a_level(), size="l", thrusters=())
    flat = a_summary(capacity=(5, 3, 1, 1), any_size=False)
    sentence = mismatch(flat, level)
    assert "this level is of a size with" in sentence and "thrusters (it knows 1)" in sentence
    assert "this level has" not in sentence
    anything = a_summary(capacity=(5, 3, 1, 0), any_size=True)
    assert mismatch(anything, level) == ""
    assert "1 thruster (it knows 0)" in mismatch(anything, a_level())


def test_an_agent_of_any_size_is_measured_by_what_the_level_has():
    level = msgspec.structs.replace(a_level(), size="l")  # has room for more than it has
    assert mismatch(a_summary(any_size=True, capacity=(5, 3, 1, 1)), level) == ""


def test_what_the_agent_sees_is_asked_for_while_it_is_on_the_screen(with_agent):
    with_agent.viewer.eye_open = True
    settle(with_agent)
    assert with_agent.viewer.eye_error == "the agent is blind"


def test_of_a_moment_without_a_state_nothing_is_shown_that_another_one_was_told(with_agent, stage):
    view = AgentView(pixels=np.zeros((2, 2, 3), np.uint8), observation="", tables=())
    told = Explained(
        attention=None, bodies=np.ones(4), joints=np.ones(1), thrusters=np.ones(1), value=0.0
    )
    stage.answers = {"Observe": view, "Explain": told}
    viewer, playback = with_agent.viewer, with_agent.playback
    viewer.eye_open = with_agent.view.settled = True
    with_agent.settings.agent_overlay = ["saliency"]
    settle(with_agent)
    assert viewer.eye is view and viewer.reasons.told is told
    bare = [dataclasses.replace(one, state=None) for one in a_trace().snapshots]
    playback.replay(dataclasses.replace(a_trace(), snapshots=tuple(bare)), a_level())
    actions.update(with_agent, 1 / 60)
    assert viewer.eye is None and viewer.eye_error.startswith("Not known for this moment")
    assert viewer.reasons.told is None and viewer.reasons.error == viewer.eye_error
    with_agent.leave_play()
    settle(with_agent)
    assert (viewer.eye, viewer.eye_error) == (view, "")
    assert (viewer.reasons.told, viewer.reasons.error) == (told, "")


def test_unified_actions_become_channels():
    assert channels_of((1.0, -0.5, 0.0, 0.2, 1.0, 0.0)) == (1, 2, 0, 1, 1, 0)


def test_a_trace_keeps_what_the_agent_thought():
    trace = a_trace()
    mind = Mind(intention=(0.0,) * 6, own_action=(0.0,) * 6, value=0.5, entropy=1.5)
    last = dataclasses.replace(trace.snapshots[-1], mind=mind)
    trace = dataclasses.replace(trace, snapshots=(*trace.snapshots[:-1], last))
    arrays = trace.arrays()
    assert arrays["value"][-1] == 0.5 and np.isnan(arrays["value"][0])
    assert arrays["entropy"][-1] == 1.5
    assert str(arrays["player"]) == "Tester"


def test_play_has_the_screen_for_itself(with_agent):
    """The message of a loaded agent leaves the level when play begins."""
    assert any(text.startswith("Loaded Tester") for text in texts(with_agent))
    with_agent.complain("Something is wrong.")
    actions.run(with_agent, "run.play_agent")
    assert texts(with_agent) == ["Something is wrong."]


def test_an_agent_of_a_stored_comparison_is_one_with_its_card_too(session):
    """Equal parameters at another frame skip play something else; an older file names no card."""
    loaded = a_summary(digest="1" * 64, card_digest="2" * 16)
    session.viewer.contenders = (loaded,)
    for card, found in (("", loaded), ("2" * 16, loaded), ("3" * 16, None)):
        assert comparison.known_by(session, "1" * 64, card) is found


def test_a_level_with_errors_is_not_evaluated(with_agent):
    level = with_agent.document.level
    many = tuple(level.bodies[0].replace(id=100 + k) for k in range(20))
    level = level.replace(bodies=level.bodies + many, size="s", next_id=200)
    with_agent.document.commit(ReplaceLevel(level=level, label="Fill"))
    options = {"attempts": 2, "seed": 0, "physics": "", "deterministic": False}
    with pytest.raises(CommandError, match="errors"):
        measure.start_evaluation(with_agent, with_agent.viewer.agents, (), **options)
