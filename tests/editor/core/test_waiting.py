"""Playing waits for nothing else; a person who waits is told for what, and may stop."""

import subprocess
import sys
import threading
import time

import pytest

from editor import actions
from editor.actions.watching import agents
from editor.agents.evaluation import bare_summary
from editor.base.settings import Settings
from editor.documents.document import Document
from editor.play.mode import Mode
from editor.session import Session
from editor.window.waiting import awaited
from editor.worker.jobs import Job, JobState, Worker
from editor.worker.requests import (
    Advance,
    AgentRef,
    CheckDynamics,
    Evaluate,
    EvaluatedLevel,
    ExportFilm,
    KeepPrograms,
    LoadAgent,
    Observe,
    PlaySolution,
    RandomLevel,
    RenderState,
    StartEpisode,
    WarmUp,
)
from kinetix.level.model import Solution
from tests.editor.core.helpers import FakeSimulator, a_level
from tests.editor.core.test_viewer import a_summary, a_trace

LEVEL = a_level()
LONG = {
    "compiling": WarmUp(sizes=("l",)),
    "writing to disk": KeepPrograms(),
    "a film": ExportFilm(level=LEVEL, trace=a_trace(), path="x.gif"),
    "a picture": RenderState(level=LEVEL, state=None, size=(9, 9), centre=(0, 0), scale=1.0),
    "the agent's view": Observe(level=LEVEL, state=None, agent=None),
    "a trial": CheckDynamics(level=LEVEL),
    "an evaluation": Evaluate(
        agents=(AgentRef(path="noop"),),
        levels=(EvaluatedLevel(name="x", source=LEVEL),),
        attempts=1,
        seed=0,
        physics="fast",
        deterministic=False,
    ),
    "a random level": RandomLevel(seed=0, size="s"),
    "another episode's start": StartEpisode(run=1, level=LEVEL, physics="fast", slot="b"),
}


class Held:
    """A worker's answers; requests of some types take until they are let go."""

    def __init__(self, *types):
        self.types, self.going_on = types, threading.Event()
        self.level = None

    def __call__(self, request, progress):
        if isinstance(request, self.types):
            while not self.going_on.wait(0.01):
                progress.report(0.25, "Compiling")
        return a_summary() if isinstance(request, LoadAgent) else None


@pytest.mark.parametrize("name", LONG)
def test_a_step_waits_for_nothing_else(name):
    request, gate = LONG[name], threading.Event()

    def perform(asked, progress):
        if asked is request:
            gate.wait(10)
        return ()

    worker = Worker(perform)
    long = worker.submit(request, title="Long")
    while long.state is not JobState.RUNNING:
        time.sleep(0.001)
    step = worker.submit(Advance(run=1, actions=()), title="Simulating", urgent=True)
    while not step.finished:
        assert worker.wait(5)
        worker.poll()
    assert long.state is JobState.RUNNING
    gate.set()
    worker.stop()


@pytest.fixture
def held():
    return Held(LoadAgent, PlaySolution, StartEpisode)


@pytest.fixture
def session(held):
    made = Session(
        settings=Settings(), simulator=FakeSimulator(), worker=Worker(held), level=a_level()
    )
    yield made
    held.going_on.set()
    made.worker.stop()


def frames(session, until, seconds=5.0):
    end = time.monotonic() + seconds
    while not until():
        assert time.monotonic() < end
        session.worker.wait(0.01)
        actions.update(session, 1 / 60)


def press_f6(session):
    agents.load_agent(session, "/agents/Tester")
    assert actions.run(session, "run.play_agent")
    frames(session, lambda: awaited(session)[1].message == "Compiling")


def test_f6_while_the_agent_loads_says_so_and_plays_when_it_is_there(session, held):
    press_f6(session)
    title, job = awaited(session)
    assert (title, job.fraction, session.mode) == ("Loading the agent", 0.25, Mode.EDIT)
    held.going_on.set()
    frames(session, lambda: session.mode is Mode.PLAYING)
    assert session.playback.player == "Tester"
    assert awaited(session) is None


def test_esc_takes_f6_back_and_the_agent_is_loaded_all_the_same(session, held):
    press_f6(session)
    actions.run(session, "edit.cancel")
    assert awaited(session) is None
    held.going_on.set()
    frames(session, lambda: session.viewer.slots["a"].summary is not None)
    frames(session, lambda: session.worker.idle)
    assert session.mode is Mode.EDIT


def test_who_plays_meanwhile_is_not_interrupted_by_the_agent(session, held):
    press_f6(session)
    actions.run(session, "run.play_human")
    held.going_on.set()
    frames(session, lambda: session.viewer.slots["a"].summary is not None)
    frames(session, lambda: session.worker.idle)
    assert session.playback.casting is None


def test_the_recorded_solution_is_waited_for_on_the_canvas_and_esc_calls_it_off(session, held):
    solution = Solution(physics="fast", frame_skip=2, actions=((3, (0,) * 6),))
    session.open_tab(Document(a_level().replace(solution=solution)))
    assert actions.run(session, "level.play_solution")
    frames(session, lambda: awaited(session)[1].message == "Compiling")
    title, job = awaited(session)
    assert title == "Playing the solution"
    actions.run(session, "edit.cancel")
    frames(session, lambda: job.finished)
    assert job.state is JobState.CANCELLED


def test_what_a_second_player_waits_for_is_told_too(session):
    rival, job = session.viewer.rival, Job(StartEpisode(run=1, level=LEVEL, physics="fast"), "")
    rival.simulator = FakeSimulator()
    rival.simulator.job, rival.simulator.take = job, list
    assert awaited(session) is None
    rival.start(LEVEL, "fast", None, player="Planner")
    assert awaited(session) == ("Preparing Planner", job)
    rival.failure = "No memory."
    assert awaited(session) is None


def test_play_tells_who_is_prepared_and_stopping_frees_the_worker(held):
    session = Session(settings=Settings(), worker=Worker(held), level=a_level())
    session.viewer.slots["a"].summary = bare_summary("random")
    for action, title in (("run.play_human", "Preparing Play"), ("run.play_agent", "Preparing ")):
        actions.run(session, action)
        frames(session, lambda: awaited(session)[1].message == "Compiling")
        assert awaited(session)[0].startswith(title)
        actions.run(session, "run.stop")
        assert awaited(session) is None
        frames(session, lambda: session.worker.idle)
    session.worker.stop()


_NEVER_ENDS = """
import sys, threading, time
from editor import __main__ as app
from editor.worker.jobs import Worker
from editor.worker.requests import RandomLevel, StartEpisode, WarmUp
from editor.session import Session
from editor.base.settings import Settings
from kinetix.level.model import Level

begun = threading.Barrier(4)

def perform(request, progress):
    begun.wait()
    threading.Event().wait()

session = Session(settings=Settings(), worker=Worker(perform))
start = StartEpisode(run=0, level=Level(name="x"), physics="fast")
for request in (WarmUp(), RandomLevel(seed=0, size="s"), start):
    session.worker.submit(request, title="Never ends")
begun.wait()
start = time.monotonic()
app.stop(session)
print(time.monotonic() - start)
app.end(3)
"""


def test_what_never_ends_does_not_keep_the_app_from_closing():
    done = subprocess.run(
        [sys.executable, "-c", _NEVER_ENDS], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 3, done.stderr
    assert float(done.stdout) < 5.0
