"""Play is compiled ahead: for the level in front, and again when it needs something else."""

import threading

import pytest

from editor import preparing
from editor.commands.fields import SetField, SetLevelField
from editor.commands.group import Move
from editor.commands.level import ReplaceLevel
from editor.jobs import Worker
from editor.panels.evaluate import scripted_summary
from editor.preparing import Preparation
from editor.requests import CheckDynamics, Tailor, WarmUp
from editor.session import Session
from editor.settings import Settings
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


class SecondWorker:
    """What the second worker is asked for; it may be held up in the middle of a job."""

    def __init__(self):
        self.tailored = []
        self.begun, self.going_on = threading.Event(), threading.Event()
        self.going_on.set()

    def __call__(self, request, progress):
        if isinstance(request, Tailor):
            self.tailored.append((request.level, request.physics))
        self.begun.set()
        self.going_on.wait(5)
        progress.report(None, "")


@pytest.fixture
def second():
    return SecondWorker()


@pytest.fixture
def asked(clock, second):
    """A session, its preparation, and what is asked of the worker."""
    requests = []
    worker, evaluator = Worker(lambda request, progress: requests.append(request)), Worker(second)
    session = Session(
        settings=Settings(),
        worker=worker,
        simulator=FakeSimulator(),
        level=a_level(),
        evaluator=evaluator,
    )
    preparation = Preparation(session, lambda job: None)

    def pass_time(seconds):
        for _ in range(2):
            clock.now += seconds / 2
            preparation.tick()
        for one in (worker, evaluator) if second.going_on.is_set() else (worker,):
            while not one.idle:
                one.wait(5)
                one.poll()
        told = [
            (request.sizes, request.physics)
            if isinstance(request, WarmUp)
            else (request.casting.agent.path, request.physics)
            for request in requests
        ]
        requests.clear()
        return told

    yield session, preparation, pass_time
    second.going_on.set()
    worker.stop()
    evaluator.stop()


def test_the_size_in_front_comes_first(asked):
    _, preparation, pass_time = asked
    assert pass_time(10) == []  # before the window stands nothing is
    preparation.begin()
    assert pass_time(0) == [(("m",), "balanced"), (("l",), "balanced"), (("s",), "balanced")]
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
    session.viewer.slots["a"].summary = scripted_summary("random")
    assert pass_time(4) == [("random", "balanced")]
    assert pass_time(4) == []
    session.execute(SetLevelField(field="size", value="l"))
    assert pass_time(4) == [("random", "balanced")]


def test_the_step_of_the_level_alone_comes_last_and_waits_for_its_parts(asked, second):
    session, preparation, pass_time = asked
    preparation.begin()
    assert len(pass_time(0)) == 3
    assert pass_time(2) == []
    assert second.tailored == []
    session.execute(Move(ids=(1,), shift=(0.1, 0.0)))
    pass_time(3)
    first = session.document.level
    assert second.tailored == [(first, "balanced")], "moving a shape must not make it wait anew"
    session.execute(Move(ids=(1,), shift=(0.1, 0.0)))
    pass_time(20)
    assert len(second.tailored) == 1, "nor compile anew"
    session.execute(SetField(ids=(3,), field="fixed", value=True))
    pass_time(3)
    assert len(second.tailored) == 1
    pass_time(4)
    assert second.tailored[1:] == [(session.document.level, "balanced")]
    session.playback.physics = "fast"
    assert pass_time(5) == [(("m",), "fast")], "first the step that every level can play in"
    pass_time(5)
    assert second.tailored[2:] == [(session.document.level, "fast")]


@pytest.mark.parametrize("reason", ["gallery", "gesture", "empty", "recorded", "unbegun"])
def test_no_level_gets_a_step_of_its_own_while_something_else_goes_on(asked, second, reason):
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
    assert second.tailored == []


def test_who_has_played_may_play_again_before_anything_is_compiled(asked, second):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(0)
    session.playback.play(session.document.level)
    pass_time(30)
    session.playback.stop()
    pass_time(3)
    assert second.tailored == []
    pass_time(4)
    assert len(second.tailored) == 1


@pytest.mark.parametrize("reason", ["play", "evaluation", "change"])
def test_the_step_of_the_level_gives_way_and_comes_again(asked, second, reason):
    session, preparation, pass_time = asked
    preparation.begin()
    pass_time(0)
    second.going_on.clear()
    pass_time(10)
    assert second.begun.wait(5)
    (job,) = session.evaluator.jobs
    if reason == "play":
        session.playback.play(session.document.level)
    elif reason == "change":
        session.execute(SetField(ids=(3,), field="fixed", value=True))
    else:
        session.evaluator.submit(CheckDynamics(level=session.document.level), title="Trying")
    pass_time(1)
    assert job.cancelled
    second.going_on.set()
    pass_time(1)
    session.playback.stop()
    pass_time(10)
    assert len(second.tailored) == 2
    assert second.tailored[1] == (session.document.level, "balanced")
