"""The window with agents: a worker that answers at once, and helpers to wait for it."""

import numpy as np
import pytest

from editor.actions.watching import agents
from editor.base.settings import Settings
from editor.gallery.results import Results
from editor.play.second_player import Follower
from editor.session import Session
from editor.worker.jobs import Worker
from editor.worker.requests import AgentView, CurriculumNews, ReadCurriculum, ViewTable
from tests.editor.core.helpers import FakeSimulator, a_level
from tests.editor.core.test_viewer import Stage, a_summary


class ViewerStage(Stage):
    def __call__(self, request, progress):
        if type(request).__name__ == "Observe":
            table = ViewTable(
                name="circles",
                columns=(("position_x", "m", "where"), ("position_y", "m", "")),
                rows=("Circle 1", "slot 1"),
                values=np.array([[1.0, 2.0], [0.0, 0.0]], np.float32),
                active=(True, False),
            )
            picture = np.zeros((125, 125, 3), np.uint8)
            return AgentView(pixels=picture, observation="symbolic_entity", tables=(table,))
        if isinstance(request, ReadCurriculum):
            return CurriculumNews(updates=(), page=None)
        return super().__call__(request, progress)


@pytest.fixture
def viewer_gui(make_gui, tmp_path):
    """The window; there is an agent "Tester" that can be loaded."""
    stage = ViewerStage()
    stage.agents["/agents/Tester"] = a_summary()
    session = Session(
        settings=Settings(),
        simulator=FakeSimulator(),
        worker=Worker(perform=stage),
        evaluator=Worker(perform=stage),
        results=Results(tmp_path / "results.json"),
        level=a_level(),
    )
    session.viewer.rival = Follower(FakeSimulator())
    made = make_gui(session=session, size=(1600, 1000))
    made.stage = stage
    return made


@pytest.fixture
def with_agent(viewer_gui):
    """The window with the agent "Tester" in slot A."""
    agents.load_agent(viewer_gui.session, "/agents/Tester")
    settle(viewer_gui)
    return viewer_gui


def settle(gui):
    for _ in range(60):
        gui.frames(2)
        if gui.session.worker.idle and gui.session.evaluator.idle:
            break
        gui.session.worker.wait(0.02)
        gui.session.evaluator.wait(0.02)
    gui.frames(3)


def front(gui, panel):
    gui.session.view.front = panel
    gui.frames(12)
