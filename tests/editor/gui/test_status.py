"""The status line: what to do comes before numbers."""

import types

import pytest

from editor.base.language import use
from editor.play.mode import Mode
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS
from editor.window.panels.status import StatusBar
from editor.worker.jobs import Job
from editor.worker.requests import Mutate
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
        return [*((each, COLOURS.muted) for each in words), *told]

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
