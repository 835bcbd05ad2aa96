"""Play is compiled ahead: for the level in front, and again when it needs something else."""

import threading

import pytest

from editor.agents.evaluation import bare_summary
from editor.base.settings import Settings
from editor.documents.commands.fields import SetField, SetLevelField
from editor.documents.commands.group import Move
from editor.documents.commands.level import ReplaceLevel
from editor.session import Session
from editor.window import preparing
from editor.window.preparing import Preparation
from editor.worker.jobs import Worker
from editor.worker.requests import CheckDynamics, GetReady, Rehearse, Tailor, WarmUp
from kinetix.level.model import Level
from tests.editor.core.helpers import FakeSimulator, Hand, a_level


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(preparing.time, "monotonic", clock)
    return clock


class Compiler:
    """A worker that can be held up in the middle of a job."""

    def __init__(self):
        self.requests = []
        self.begun, self.going_on = threading.Event(), threading.Event()
        self.going_on.set()

    def __call__(self, request, progress):
        self.requests.append(request)
        self.begun.set()
        self.going_on.wait(5)
        progress.report(None, "")

    @property
    def tailored(self):
        return [(r.level, r.physics) for r in self.requests if isinstance(r, Tailor)]


@pytest.fixture
def compiler():
    return Compiler()


def told(request):
    match request:
        case WarmUp():
            return request.sizes, request.physics
        case Rehearse():
            return request.casting.agent.path, request.physics
        case GetReady():
            return "first", request.physics


@pytest.fixture
def asked(clock, compiler):
    """A session, its preparation, and what is asked of the worker."""
    worker, evaluator = Worker(compiler), Worker(lambda request, progress: None)
    session = Session(
        settings=Settings(),
        worker=worker,
        simulator=FakeSimulator(),
        level=a_level(),
        evaluator=evaluator,
    )
    preparation = Preparation(session, lambda job: None)

    def settle():
        evaluator.wait(1)
        evaluator.poll()
        while compiler.going_on.is_set() and not worker.idle:
            worker.wait(5)
            worker.poll()

    def pass_time(seconds):
        """Let time pass; what was asked for meanwhile but for the steps of single levels."""
        before, seen = len(compiler.requests), -1
        clock.now += seconds / 2
        preparation.tick()
        settle()
        clock.now += seconds / 2
        while seen != len(compiler.requests):
            seen = len(compiler.requests)
            preparation.tick()
            settle()
        return [words for request in compiler.requests[before:] if (words := told(request))]

    yield session, preparation, pass_time
    compiler.going_on.set()
    worker.stop()
    evaluator.stop()


def test_the_size_in_front_comes_first(asked):
    _, preparation, pass_time = asked
    assert pass_time(10) == []  # before the window stands nothing is
    preparation.begin()
    assert pass_time(0) == [(("m",), "balanced"), (("s",), "balanced"), (("l",), "balanced")]
    assert pass_time(10) == []


def test_another_physics_and_another_size_are_prepared_once_they_last(asked):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(0)
    session.playback.physics = "accurate"
    assert pass_time(1) == []
    assert pass_time(4) == [(("m",), "accurate")]
    session.execute(SetLevelField(field="size", value="locomotion"))
    assert pass_time(1) == []
    session.playback.physics = "balanced"
    assert pass_time(1) == []
    assert pass_time(4) == [(("locomotion",), "balanced")]
    assert pass_time(10) == []


def test_nothing_is_prepared_while_it_plays(asked):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(0)
    session.playback.play(session.document.level)
    session.playback.physics = "accurate"
    assert pass_time(10) == []
    session.playback.stop()
    assert pass_time(10) == [(("m",), "accurate")]


def test_the_agent_is_prepared_for_another_level_too(asked):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(0)
    session.viewer.slots["a"].summary = bare_summary("random")
    assert pass_time(4) == [("random", "balanced")]
    assert pass_time(4) == []
    session.execute(SetLevelField(field="size", value="l"))
    assert pass_time(4) == [("random", "balanced")]


def test_the_step_of_the_level_alone_comes_last_and_waits_for_its_parts(asked, compiler):
    session, preparation, pass_time = asked
    preparation.begin()
    assert len(pass_time(0)) == 3
    assert pass_time(2) == []
    assert compiler.tailored == []
    session.execute(Move(ids=(1,), shift=(0.1, 0.0)))
    pass_time(3)
    first = session.document.level
    assert compiler.tailored == [(first, "balanced")], "moving a shape must not make it wait anew"
    session.execute(Move(ids=(1,), shift=(0.1, 0.0)))
    pass_time(20)
    assert len(compiler.tailored) == 1, "nor compile anew"
    session.execute(SetField(ids=(3,), field="fixed", value=True))
    pass_time(3)
    assert len(compiler.tailored) == 1
    pass_time(4)
    assert compiler.tailored[1:] == [(session.document.level, "balanced")]
    session.playback.physics = "fast"
    assert pass_time(5) == [(("m",), "fast")], "first the step that every level can play in"
    pass_time(5)
    assert compiler.tailored[2:] == [(session.document.level, "fast")]


@pytest.mark.parametrize("reason", ["gallery", "gesture", "empty", "recorded", "unbegun"])
def test_no_level_gets_a_step_of_its_own_while_something_else_goes_on(asked, compiler, reason):
    session, preparation, pass_time = asked
    if reason != "unbegun":
        preparation.begin()
    pass_time(0)
    if reason == "gallery":
        session.gallery.open = True
    elif reason == "gesture":
        session.selection = (1,)
        hand = Hand(session)
        hand.press((2.0, 2.0))
        hand.hold((2.3, 2.0))
        assert session.driver.active
    elif reason == "empty":
        session.execute(ReplaceLevel(level=Level(name="Nothing", size="m"), label="Empty"))
    elif reason == "recorded":
        preparation.tailors = False
    pass_time(30)
    assert compiler.tailored == []


def test_who_has_played_may_play_again_before_anything_is_compiled(asked, compiler):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(0)
    session.playback.play(session.document.level)
    pass_time(30)
    session.playback.stop()
    pass_time(3)
    assert compiler.tailored == []
    pass_time(4)
    assert len(compiler.tailored) == 1


@pytest.mark.parametrize("reason", ["play", "evaluation", "change"])
def test_the_step_of_the_level_gives_way_and_comes_again(asked, compiler, reason):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(3)
    compiler.begun.clear()
    compiler.going_on.clear()
    pass_time(10)
    assert compiler.begun.wait(5)
    (job,) = session.worker.jobs
    if reason == "play":
        session.playback.play(session.document.level)
    elif reason == "change":
        session.execute(SetField(ids=(3,), field="fixed", value=True))
    else:
        session.evaluator.submit(CheckDynamics(level=session.document.level), title="Trying")
    pass_time(1)
    assert job.cancelled
    compiler.going_on.set()
    pass_time(1)
    session.playback.stop()
    pass_time(10)
    assert len(compiler.tailored) == 2
    assert compiler.tailored[1] == (session.document.level, "balanced")
