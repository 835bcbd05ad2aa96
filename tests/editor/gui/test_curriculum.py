"""The history of a level buffer in its panel, and agents asked why."""

from types import SimpleNamespace

import numpy as np
import pytest

from editor.actions.watching import watch
from editor.agents.curriculum import CurriculumWatch, lineage, why_gone
from editor.base.settings import Settings
from editor.session import Session
from editor.worker.jobs import JobState, Worker
from editor.worker.requests import CurriculumNews, Explain, Explained, ReadCurriculum, RunNews
from kinetix.level.codec import load_level
from kinetix.training.curricula.pages import BufferPage, GoneLevel, ListedLevel, PageHead
from tests.editor.core.test_viewer import Stage, a_summary

LEVEL = load_level("s/goalkeeper")


def _page(update):
    parent = ListedLevel(
        serial=3, score=0.2, learnability=0.25, solve_rate=0.5, episodes=8, born=1, kind="new"
    )
    child = ListedLevel(
        serial=9,
        score=None,
        learnability=None,
        solve_rate=None,
        episodes=0,
        born=update,
        kind="mutated",
        ancestry=(3, 1),
    )
    gone = GoneLevel(serial=1, update=update, reason="outscored", by=9, score=0.1, solve_rate=1.0)
    head = PageHead(
        algorithm="accel",
        update=update,
        env_steps=update * 64,
        capacity=4,
        filled=2,
        entered=1,
        left=1,
        score_quartiles=(0.1, 0.2, 0.3),
        levels=(parent, child),
        gone=(gone,),
    )
    return BufferPage(head=head, levels=(LEVEL, LEVEL.replace(name="child")))


class _Stage(Stage):
    def __call__(self, request, progress):
        if isinstance(request, RunNews) or type(request).__name__ == "ReadRun":
            return RunNews(rows=(), total=0, newest=None)
        if isinstance(request, ReadCurriculum):
            update = request.update or 8
            known = update == request.known
            return CurriculumNews(updates=(2, 5, 8), page=None if known else _page(update))
        if isinstance(request, Explain):
            bodies = len(request.level.bodies)
            return Explained(
                attention=np.full(bodies, 1 / bodies, np.float32),
                bodies=np.arange(bodies, dtype=np.float32),
                joints=np.ones(len(request.level.joints), np.float32),
                thrusters=np.zeros(len(request.level.thrusters), np.float32),
                value=0.5,
                body=request.body,
                places=np.linspace(0, 1, 16, dtype=np.float32).reshape(4, 4),
                cell=1.25,
            )
        return super().__call__(request, progress)


@pytest.fixture
def stage(make_gui):
    """The app with a worker that answers at once."""
    found = make_gui(session=Session(settings=Settings(), worker=Worker(_Stage())))
    yield found
    found.session.worker.stop()


def _settle(gui, frames=40):
    for _ in range(frames):
        gui.session.worker.wait(0.02)
        gui.frames(1)


def test_pages_are_followed_and_chosen_and_a_level_is_opened(stage) -> None:
    session = stage.session
    _settle(stage)
    watch.watch_run(session, "/nowhere/run")
    session.view.front = "curriculum"
    _settle(stage, 80)
    curriculum = session.viewer.curriculum
    assert curriculum.page is not None and curriculum.page.head.update == 8
    assert not curriculum.drawing and len(curriculum.thumbnails) == 2
    curriculum.choose(5)
    _settle(stage)
    assert curriculum.page.head.update == 5
    stage.click("curriculum.level.1")
    _settle(stage, 5)
    assert session.document.level.name == "child"


def test_words_say_where_levels_come_from_and_why_they_left() -> None:
    page = _page(4)
    assert lineage(page.head.levels[1]) == "edited from #3, from #1"
    assert not lineage(page.head.levels[0])
    (gone,) = page.head.gone
    assert why_gone(gone).startswith("Update 4: #9 took its place with a better score")
    for rate, word in ((1.0, "learnt"), (0.0, "too hard"), (0.5, "refilled"), (None, "refilled")):
        told = GoneLevel(serial=1, update=4, reason="refilled", by=-1, score=0.1, solve_rate=rate)
        assert word in why_gone(told)


def test_newer_pages_come_while_one_is_looked_at() -> None:
    class Answering:
        updates = (2, 5)

        def submit(self, request, *, title, done):
            there = request.update in self.updates and request.update != request.known
            page = _page(request.update) if there else None
            news = CurriculumNews(updates=self.updates, page=page)
            done(SimpleNamespace(state=JobState.DONE, result=news))

    worker = Answering()
    watched = CurriculumWatch(worker)  # pyright: ignore[reportArgumentType]
    watched.open = True
    watched.watch("/run")
    watched.choose(5)
    watched.tick(0.0)
    worker.updates = (2, 8)  # 5 was thinned out, but it is on show
    watched.tick(10.0)
    assert watched.updates == (2, 8)
    assert (watched.wanted, watched.page.head.update) == (5, 5)
    watched.choose(3)
    watched.tick(20.0)
    assert watched.wanted is None


def test_a_watch_without_a_panel_reads_nothing() -> None:
    class Refusing:
        def submit(self, *_, **__):
            raise AssertionError

    watched = CurriculumWatch(Refusing())  # pyright: ignore[reportArgumentType]
    watched.watch("/nowhere")
    watched.tick(10.0)


def test_an_agent_is_asked_only_where_something_is_to_be_drawn(stage) -> None:
    session = stage.session
    _settle(stage)
    session.viewer.slots["a"].summary = a_summary()
    from editor.documents.document import Document

    session.open_tab(Document(LEVEL))
    _settle(stage, 10)
    assert session.viewer.reasons.told is None
    session.settings.agent_overlay = ["attention", "saliency", "places"]
    _settle(stage, 20)
    told = session.viewer.reasons.told
    assert told is not None and told.body is not None
    session.settings.agent_overlay = []
    _settle(stage, 3)
    assert session.viewer.reasons.told is None
