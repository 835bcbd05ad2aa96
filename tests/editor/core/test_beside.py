"""The same scene under two physics: the second episode does what the first one did."""

import pytest

from editor import actions
from editor.actions.playing import physics
from editor.play.second_player import Follower
from tests.editor.core.helpers import FakeSimulator, a_level, a_session

LEFT, RIGHT = (1, 0, 0, 0, 0, 0), (2, 0, 0, 0, 0, 0)


@pytest.fixture
def follower():
    return Follower(FakeSimulator())


def x(snapshot):
    return float(snapshot.position[0, 0])


def test_it_does_what_the_first_one_did_and_not_more(follower):
    done = [LEFT, LEFT, RIGHT]
    follower.start(a_level(), "jax2d", None, player="jax2d", mirror=lambda: done)
    for _ in range(3):
        follower.tick(100)
    assert [round(x(s) - x(follower.snapshots[0]), 2) for s in follower.snapshots] == [
        0.0,
        0.01,
        0.02,
        0.04,
    ]
    assert follower.simulator.physics == "jax2d"


def test_another_turn_of_the_first_one_is_followed(follower):
    done = [LEFT, LEFT, LEFT]
    follower.start(a_level(), "jax2d", None, player="jax2d", mirror=lambda: done)
    for _ in range(3):
        follower.tick(100)
    done[1:] = []
    follower.tick(100)
    assert len(follower.snapshots) == 4, "a step back alone takes nothing away"
    done[1:] = [RIGHT, RIGHT]
    for _ in range(3):
        follower.tick(100)
    moved = [round(x(s) - x(follower.snapshots[0]), 2) for s in follower.snapshots]
    assert moved == [0.0, 0.01, 0.03, 0.05]


def test_the_second_physics_is_chosen_and_given_up():
    session = a_session()
    session.viewer.rival.simulator = FakeSimulator()
    actions.run(session, "run.compare_physics")
    (prompt,) = session.prompts
    assert "balanced" not in [choice.id for choice in prompt.choices]
    session.answer(prompt, "jax2d")
    assert physics.comparing(session) and session.viewer.arrangement == "side"
    actions.run(session, "run.play_human")
    session.hands.held = {"left"}
    for _ in range(40):
        actions.update(session, 1 / 60)
    actions.run(session, "run.pause")
    for _ in range(3):
        actions.update(session, 1 / 60)
    first, second = session.playback, session.viewer.rival
    assert second.simulator.physics == "jax2d"
    shown = second.shown(first.engine_step)
    assert shown.step == first.step_count > 5
    assert x(shown) == pytest.approx(x(first.snapshot))
    actions.run(session, "run.compare_physics")
    session.answer(session.prompts[0], physics.NONE)
    actions.update(session, 1 / 60)
    assert not second.active and session.viewer.arrangement == "off"
