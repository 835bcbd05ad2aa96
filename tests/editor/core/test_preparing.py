"""Play is compiled ahead: for the level in front, and again when it needs something else."""

import pytest

from editor import preparing
from editor.commands.fields import SetLevelField
from editor.jobs import Worker
from editor.panels.evaluate import scripted_summary
from editor.preparing import Preparation
from editor.requests import WarmUp
from editor.session import Session
from editor.settings import Settings
from tests.editor.core.helpers import FakeSimulator, a_level


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(preparing.time, "monotonic", clock)
    return clock


@pytest.fixture
def asked(clock):
    """A session, its preparation, and what is asked of the worker."""
    requests = []
    worker = Worker(perform=lambda request, progress: requests.append(request))
    session = Session(
        settings=Settings(), worker=worker, simulator=FakeSimulator(), level=a_level()
    )
    preparation = Preparation(session, lambda job: None)

    def pass_time(seconds):
        for _ in range(2):
            clock.now += seconds / 2
            preparation.tick()
        while not worker.idle:
            worker.wait(5)
            worker.poll()
        told = [
            (request.sizes, request.physics)
            if isinstance(request, WarmUp)
            else (request.casting.agent.path, request.physics)
            for request in requests
        ]
        requests.clear()
        return told

    yield session, preparation, pass_time
    worker.stop()


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
