"""A win is kept as the level's solution, and a recorded one is played."""

import dataclasses

import pytest

from editor import actions
from editor.actions import run
from editor.base.settings import Settings
from editor.documents.commands.group import Move
from editor.documents.commands.level import ReplaceLevel
from editor.documents.document import Document
from editor.gallery.results import HUMAN, Trial
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import Opened, PlaySolution
from editor.worker.snapshots import Trace
from kinetix.level.codec import load_level
from kinetix.level.model import Level, Solution
from tests.editor.core.helpers import FakeSimulator, a_level, a_session


@pytest.fixture
def level(session):
    session.document.commit(ReplaceLevel(level=a_level(), label="Start"))
    return session.document.level


def won(session):
    """Five steps to the left, five to nowhere, the last of which wins."""
    session.playback.simulator.ends_at, session.playback.simulator.ends = 10, "won"
    run(session, "run.play_human")
    actions.update(session, 0.0)
    for held in ({"left"}, set()):
        session.hands.held = held
        for _ in range(10):
            actions.update(session, 1 / 60)
    assert session.playback.outcome == "won"


def test_a_win_by_hand_is_offered_and_kept_as_one_edit(session, level):
    won(session)
    assert session.toasts[-1].action == "level.keep_solution"
    assert run(session, "level.keep_solution")
    solution = session.document.level.solution
    assert solution is not None
    assert session.editing
    assert (solution.physics, solution.frame_skip) == ("balanced", 2)
    assert len(list(solution.unrolled())) == 10
    assert solution.actions[0][1] == (1, 0, 0, 0, 0, 0)
    assert len(solution.actions) == 2
    run(session, "edit.undo")
    assert session.document.level == level


def test_a_kept_solution_goes_with_a_change(session, level):
    won(session)
    run(session, "level.keep_solution")
    session.selection = (1,)
    run(session, "transform.nudge_left")
    assert session.document.level.solution is None


@pytest.mark.parametrize("again", ["won", "timeout"])
def test_a_win_in_the_levels_own_step_is_kept_if_it_wins_in_the_shared_one_too(level, again):
    judged = []

    def judge(request: PlaySolution, progress: object) -> Opened:
        judged.append(request.level.solution)
        last = dataclasses.replace(won_in, outcome=again, tailored=False)
        trace = Trace(physics="balanced", perturbed=False, snapshots=(last,), actions=())
        return Opened(level=request.level, trace=trace)

    worker = Worker(perform=judge)
    session = Session(settings=Settings(), worker=worker, simulator=FakeSimulator(), level=level)
    won(session)
    won_in = dataclasses.replace(session.playback.ring.last, tailored=True)
    session.playback.ring.push(won_in)
    session.playback.current.actions.append((0,) * 6)
    run(session, "level.keep_solution")
    assert session.editing
    assert session.document.level.solution is None
    worker.wait(5)
    actions.update(session, 0.0)
    worker.stop()
    assert len(list(judged[0].unrolled())) == 11
    assert session.document.level.solution == (judged[0] if again == "won" else None)
    said = session.toasts[-1].text
    assert said.startswith("Kept as the solution" if again == "won" else "Not kept")


@pytest.mark.parametrize("afterwards", ["restart", "edit", "a moment before", "a loss"])
def test_a_win_is_kept_from_its_message_whatever_is_played_by_then(session, level, afterwards):
    if afterwards in ("restart", "a loss"):
        session.settings.restart_automatically = True
    won(session)
    if afterwards == "edit":
        run(session, "run.stop")
    elif afterwards == "a moment before":
        run(session, "run.step_back")
    else:
        session.playback.simulator.ends_at = 10 if afterwards == "a loss" else 200
        session.playback.simulator.ends = "lost"
    for _ in range(100):
        actions.update(session, 1 / 60)
    assert session.playback.outcome == ("lost" if afterwards == "a loss" else None)
    offers = [toast for toast in session.toasts if toast.action == "level.keep_solution"]
    assert len(offers) == 1
    assert run(session, "level.keep_solution")
    assert session.editing
    assert len(list(session.document.level.solution.unrolled())) == 10
    assert not run(session, "level.keep_solution")


def test_of_two_wins_the_last_is_offered(session, level):
    won(session)
    run(session, "run.reset")
    session.playback.simulator.ends_at = 12
    for _ in range(40):
        actions.update(session, 1 / 60)
    offers = [toast.text for toast in session.toasts if toast.action == "level.keep_solution"]
    assert offers == ["Won in 12 steps: use this as the level's solution?"]
    assert run(session, "level.keep_solution")
    assert len(list(session.document.level.solution.unrolled())) == 12


@pytest.mark.parametrize("way", ["step back", "start here"])
def test_a_win_after_a_moment_before_a_loss_is_offered_and_no_further_result(session, level, way):
    simulator = session.playback.simulator
    simulator.ends_at, simulator.ends = 10, "lost"
    run(session, "run.play_human")
    for _ in range(40):
        actions.update(session, 1 / 60)
    assert session.playback.outcome == "lost"
    if way == "step back":
        for _ in range(5):
            run(session, "run.step_back")
            actions.update(session, 1 / 60)
    else:
        session.playback.scrub(5)
        session.playback.branch()
    simulator.ends_at, simulator.ends = 15, "won"
    run(session, "run.pause")
    for _ in range(40):
        actions.update(session, 1 / 60)
    assert session.playback.outcome == "won"
    assert session.toasts[-1].text == "Won in 15 steps: use this as the level's solution?"
    assert session.results.of(session.document.hash)[Trial(player=HUMAN)].attempts == 1
    run(session, "run.stop")
    assert run(session, "level.keep_solution")
    assert len(list(session.document.level.solution.unrolled())) == 15


@pytest.mark.parametrize("other", ["changed", "another"])
def test_a_win_is_no_solution_of_another_level(session, level, other):
    won(session)
    run(session, "run.stop")
    if other == "changed":
        session.execute(Move(ids=(1,), shift=(0.1, 0.0)))
    else:
        session.open_tab(Document(Level(name="Another")))
    assert not run(session, "level.keep_solution")
    actions.update(session, 0.0)
    assert all(toast.action != "level.keep_solution" for toast in session.toasts)


@pytest.mark.parametrize("spoilt", ["perturbed", "lost"])
def test_only_a_win_by_keys_alone_can_be_kept(session, level, spoilt):
    session.playback.simulator.ends_at = 10
    session.playback.simulator.ends = "lost" if spoilt == "lost" else "won"
    run(session, "run.play_human")
    actions.update(session, 0.0)
    session.playback.current.perturbed = spoilt == "perturbed"
    for _ in range(30):
        actions.update(session, 1 / 60)
    assert session.mode is Mode.ENDED
    assert not run(session, "level.keep_solution")
    assert all(toast.action != "level.keep_solution" for toast in session.toasts)


def test_a_recorded_solution_is_a_replay(session, level):
    won(session)
    trace = session.playback.trace
    solution = Solution(physics="balanced", frame_skip=2, actions=((10, (1, 0, 0, 0, 0, 0)),))
    with_one = level.replace(solution=solution)
    asked = []

    def perform(request: PlaySolution, progress: object) -> Opened:
        asked.append(request)
        assert isinstance(trace, Trace)
        return Opened(level=request.level, trace=trace)

    worker = Worker(perform=perform)
    viewing = Session(settings=Settings(), worker=worker, simulator=FakeSimulator(), level=with_one)
    assert not run(session, "level.play_solution")
    assert run(viewing, "level.play_solution")
    worker.wait(5)
    actions.update(viewing, 0.0)
    assert asked == [PlaySolution(level=with_one)]
    assert viewing.mode is Mode.REPLAY
    assert viewing.playback.player == "recorded solution"
    worker.stop()


@pytest.fixture
def judged(level):
    """A session whose recorded solutions win when they are played."""

    def perform(request: PlaySolution, progress: object) -> Opened:
        simulator = FakeSimulator()
        simulator.start(request.level, "balanced")
        last = dataclasses.replace(simulator.state, outcome="won")
        trace = Trace(physics="balanced", perturbed=False, snapshots=(last,), actions=())
        return Opened(level=request.level, trace=trace)

    solution = Solution(physics="balanced", frame_skip=2, actions=((10, (1, 0, 0, 0, 0, 0)),))
    with_one, worker = level.replace(solution=solution), Worker(perform=perform)
    yield Session(settings=Settings(), worker=worker, simulator=FakeSimulator(), level=with_one)
    worker.stop()


def test_a_recorded_solution_that_comes_too_late_leaves_the_game_alone(judged):
    assert run(judged, "level.play_solution")
    assert run(judged, "run.play_human")
    assert judged.worker.wait(5)
    for _ in range(10):
        actions.update(judged, 1 / 60)
    assert (judged.mode, judged.playback.player) == (Mode.PLAYING, "")


def test_a_win_that_is_judged_too_late_can_still_be_kept(judged):
    won(judged)
    judged.playback.ring.push(dataclasses.replace(judged.playback.ring.last, tailored=True))
    judged.playback.current.actions.append((0,) * 6)
    before = judged.document.level
    assert run(judged, "level.keep_solution")
    judged.playback.simulator.ends_at = 256
    assert run(judged, "run.play_human")
    assert judged.worker.wait(5)
    for _ in range(10):
        actions.update(judged, 1 / 60)
    assert judged.mode is Mode.PLAYING
    assert judged.document.level == before
    assert run(judged, "level.keep_solution")


def test_steps_there_and_back_keep_the_solution():
    level = load_level("s/wheelie")
    session = a_session(level)
    session.selection = (level.bodies[0].id,)
    run(session, "transform.nudge_left")
    assert session.document.level.solution is None
    run(session, "transform.nudge_right")
    assert session.document.level.solution == level.solution is not None
    assert not session.document.dirty
    # A solution that was taken away by itself does not come back.
    without = session.document.level.replace(solution=None)
    session.execute(ReplaceLevel(level=without, label="Forget"))
    run(session, "transform.nudge_left")
    run(session, "transform.nudge_right")
    assert session.document.level.solution is None
