"""The status line: what to do comes before numbers."""

import threading
import types
from pathlib import Path

import pytest

from editor import actions
from editor.agents.evaluation import Evaluation, Plan, bare_summary
from editor.agents.local_training import LocalTraining
from editor.base.language import use
from editor.play.mode import Mode
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS
from editor.window.panels.status import StatusBar
from editor.window.panels.under_way import Part
from editor.worker.jobs import Job, Worker
from editor.worker.requests import ExportFilm, Mutate
from editor.worker.snapshots import Trace
from tests.editor.core.helpers import FakeSimulator, a_session


@pytest.mark.parametrize(("size", "scale"), [((800, 600), 1.0), ((1024, 600), 1.5)])
def test_the_hint_is_whole_in_a_small_window(make_gui, monkeypatch, size, scale):
    shown = []
    fitted = widgets.fitted

    def cut(words, room):
        shown.append((words, fitted(words, room)))
        return shown[-1][1]

    def more(bar, session):
        # As after a while of playing what is not saved.
        told = numbers(bar, session)
        words = ("12.3 ms/step, compiled for this level", "4.95, 4.95 m")
        return [*(Part(each, COLOURS.muted) for each in words), *told]

    numbers = StatusBar.numbers
    monkeypatch.setattr(StatusBar, "numbers", more)
    monkeypatch.setattr(widgets, "fitted", cut)
    session = a_session()
    simulator = FakeSimulator()
    simulator.ends_at, simulator.ends = 5, "won"
    session.playback.simulator = simulator
    gui = make_gui(session=session, size=size, scale=scale)
    gui.frames(40)
    gui.move(*gui.screen(2.0, 2.0))
    gui.key("space")
    gui.frames(60)
    assert session.mode is Mode.ENDED
    shown.clear()
    gui.frames(1)
    (hint,) = [pair for pair in shown if pair[0].startswith("Space plays again")]
    assert hint[0] == hint[1]


def test_work_under_way_is_told_in_the_language_of_the_window():
    session = a_session()
    job = Job(Mutate(level=session.document.level, mutation=None, seed=0), "Mutating")
    job.report(0.16, "Compiling for this level")
    session.worker = types.SimpleNamespace(jobs=[job])
    use("de")
    try:
        words = StatusBar().numbers(session)[0][0]
        assert words.endswith("Wird für dieses Level übersetzt 16%")
    finally:
        use("en")


class Busy:
    """A process that does not end."""

    def poll(self):
        return None

    def send_signal(self, sig):
        self.asked = sig


@pytest.fixture
def training(tmp_path):
    """A session that trains an agent, and shows no run."""
    session = a_session()
    session.training = LocalTraining(lambda words, log: Busy())
    session.training.begin(tmp_path / "level.json", tmp_path / "rover", "Rover")
    return session


def test_a_training_is_told_and_can_be_ended_where_no_run_is_watched(make_gui, training):
    gui = make_gui(session=training)
    assert next(part.words for part in StatusBar().numbers(training)).endswith("Training Rover")
    gui.click("status.view.training")
    gui.frames(4)
    gui.click("training.watch_own")
    gui.frames(4)
    assert training.viewer.run.path == str(training.training.run)
    training.viewer.run.watch("")
    gui.frames(4)
    gui.click("training.end")
    gui.frames(2)
    assert training.training.stopping


def test_an_evaluation_is_told_and_asked_about_before_the_app_closes():
    session = a_session()
    going_on = threading.Event()
    session.evaluator = Worker(perform=lambda request, progress: going_on.wait(5))
    session.viewer.evaluation = Evaluation(session.evaluator)
    session.viewer.evaluation.start(Plan(agents=(bare_summary("noop"),), levels=(), hashes=()))
    assert "Evaluating" in StatusBar().numbers(session)[0].words
    actions.run(session, "file.quit")
    assert "the evaluation" in session.prompts[-1].message and not session.quitting
    going_on.set()
    session.evaluator.stop()


def test_a_film_is_told_by_its_name_before_what_is_only_prepared():
    session = a_session()
    ahead = Job(Mutate(level=session.document.level, mutation=None, seed=0), "Preparing the agent")
    trace = Trace(physics="balanced", perturbed=False, snapshots=(), actions=())
    request = ExportFilm(level=session.document.level, trace=trace, path=Path("x.gif"))
    film = Job(request, "Writing x.gif")
    film.report(0.25, "Picture 1 of 109")
    session.worker = types.SimpleNamespace(jobs=(ahead, film))
    first, second, *_ = StatusBar().numbers(session)
    assert first.words.endswith("Writing x.gif 25%") and first.action == "file.stop_export"
    assert second.words.endswith("Preparing the agent")
