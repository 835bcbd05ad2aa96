"""A level's own step: what it is made for, who plays in it; it plays like the shared one."""

import dataclasses
import gc
import threading

import jax
import numpy as np
import pytest

from editor.base.settings import Settings
from editor.session import Session
from editor.window.panels.status import StatusBar
from editor.worker.jobs import Worker
from editor.worker.requests import (
    Advance,
    Cancelled,
    PlaySolution,
    RenderState,
    Restore,
    StartEpisode,
    Tailor,
)
from editor.worker.step_key import outline
from kinetix.level.model import (
    Arena,
    ArenaBody,
    Body,
    Circle,
    Joint,
    Level,
    Limits,
    Motor,
    Polygon,
    Solution,
    Thruster,
)
from tests.editor.core.helpers import FakeSimulator, Unheard, a_session

LEFT = (1, 0, 0, 0, 0, 0)
BOX = Polygon(vertices=((0.3, 0.1), (-0.3, 0.1), (-0.3, -0.1), (0.3, -0.1)))
LEVEL = Level(
    name="Cart",
    size="s",
    bodies=(
        Body(id=1, shape=BOX, position=(2.5, 0.62), role="green"),
        Body(id=2, shape=Circle(radius=0.2), position=(2.5, 0.62)),
        Body(id=3, shape=Circle(radius=0.3), position=(0.6, 0.7), role="blue"),
    ),
    joints=(
        Joint(
            id=4,
            kind="revolute",
            a=1,
            b=2,
            anchor_a=(0.0, 0.0),
            anchor_b=(0.0, 0.0),
            motor=Motor(speed=2.0),
        ),
    ),
    max_timesteps=60,
)


class CalledOff:
    """Goes on for some reports, then nobody waits any more."""

    def __init__(self, reports):
        self.left = reports

    def report(self, fraction, message):
        self.left -= 1
        if self.left < 0:
            raise Cancelled


def body(number, **changes):
    bodies = tuple(b.replace(**changes) if b.id == number else b for b in LEVEL.bodies)
    return LEVEL.replace(bodies=bodies)


def joint(**changes):
    return LEVEL.replace(joints=(LEVEL.joints[0].replace(**changes),))


SAME = {
    "moved": body(1, position=(3.0, 2.0), angle=0.4),
    "larger": body(2, shape=Circle(radius=0.25)),
    "heavier": body(3, density=2.0, friction=0.2),
    "red": body(3, role="red"),
    "rolling": body(2, velocity=(1.0, 0.0)),
    "faster motor": joint(motor=Motor(speed=3.0, power=2.0, binding=1)),
    "longer": LEVEL.replace(max_timesteps=100, gravity=(0.0, -3.0), name="Another"),
}
OTHER = {
    "no joint": LEVEL.replace(joints=()),
    "another joint": joint(b=3),
    "weld": joint(kind="fixed", motor=None),
    "no motor": joint(motor=None),
    "motor off": joint(motor=Motor(on=False)),
    "limits": joint(limits=Limits(min=-1.0, max=1.0)),
    "fixed": body(3, fixed=True),
    "ghost": body(3, collision="ghost"),
    "bouncing": body(3, restitution=0.5),
    "bouncing floor": LEVEL.replace(arena=Arena(floor=ArenaBody(restitution=0.5))),
    "ghostly wall": LEVEL.replace(arena=Arena(left_wall=ArenaBody(collision="ghost"))),
    "triangle": body(1, shape=Polygon(vertices=((0.3, 0.0), (-0.3, 0.1), (-0.3, -0.1)))),
    "thruster": LEVEL.replace(
        thrusters=(Thruster(id=9, body=1, position=(0.0, 0.0), angle=0.0),), next_id=10
    ),
    "one less": LEVEL.replace(bodies=LEVEL.bodies[:2]),
    "size": LEVEL.replace(size="m"),
}


@pytest.mark.parametrize("name", SAME)
def test_a_level_with_the_same_parts_has_the_same_step(name):
    from editor.worker.simulation.stepping import tailored_params

    assert tailored_params(SAME[name], "fast") == tailored_params(LEVEL, "fast")
    assert outline(SAME[name]) == outline(LEVEL)


@pytest.mark.parametrize("name", OTHER)
def test_a_level_with_other_parts_has_another_step(name):
    from editor.worker.simulation.stepping import tailored_params

    assert tailored_params(OTHER[name], "fast") != tailored_params(LEVEL, "fast")
    # Wherever the step differs the window has to notice, and it has the outline alone.
    assert outline(OTHER[name]) != outline(LEVEL)


def test_each_physics_has_its_own_step():
    from editor.worker.simulation.stepping import tailored_params

    assert tailored_params(LEVEL, "fast") != tailored_params(LEVEL, "balanced")


def test_the_steps_that_were_used_last_are_kept():
    from editor.worker.simulation.compiling import KEPT, Programs

    programs, program = Programs(), object()
    keys = range(KEPT + 1)
    for key in keys[:-1]:
        programs.put(key, program)
    assert programs.get(keys[0]) is program
    programs.put(keys[-1], program)
    assert programs.get(keys[1]) is None
    assert all(programs.get(key) is program for key in (keys[0], *keys[2:]))


def test_nothing_that_compiling_changes_stays_changed():
    from editor.worker.simulation.quiet import not_stored
    from editor.worker.yielding import without_pauses

    def settings():
        return gc.get_threshold(), jax.config.jax_persistent_cache_min_compile_time_secs

    before = settings()
    with without_pauses(), not_stored():
        (*young, _), seconds = settings()
        assert gc.get_threshold()[2] > 1000 * before[0][2]
        assert tuple(young) == before[0][:2], "young objects are collected as always"
        assert seconds == float("inf")
        with without_pauses():  # the other worker
            pass
    assert settings() == before
    gc.unfreeze()


def test_the_status_line_says_which_step_plays():
    def said(session):
        return [part.words for part in StatusBar().numbers(session)]

    session = a_session(LEVEL)
    session.playback.play(LEVEL)
    session.playback.tick(0.0)
    assert "0.0 ms/step" in said(session)
    session.playback.current.snapshot = dataclasses.replace(
        session.playback.snapshot, tailored=True
    )
    assert "0.0 ms/step, compiled for this level" in said(session)


def test_the_status_line_says_when_a_step_is_being_made():
    going_on = threading.Event()
    worker = Worker(perform=lambda request, progress: going_on.wait(5))
    session = Session(settings=Settings(), simulator=FakeSimulator(), worker=worker)
    worker.submit(Tailor(level=LEVEL, physics="fast"), title="Compiling for this level")
    words = [part.words for part in StatusBar().numbers(session)]
    going_on.set()
    worker.stop()
    assert any("Compiling for this level" in each for each in words)


@pytest.fixture(scope="module")
def perform():
    from editor.worker import simulation

    return lambda request, progress=None: simulation.perform(request, progress or Unheard())


def play(perform, level=LEVEL, run=1):
    first = perform(StartEpisode(run=run, level=level, physics="fast"))
    return [first, *perform(Advance(run=run, actions=(LEFT,) * 30))]


@pytest.fixture(scope="module")
def shared(perform):
    """An episode in the step of the size, before the level has one of its own."""
    return play(perform)


@pytest.fixture(scope="module")
def own(perform, shared):
    """The same in the level's own step; the episode that was under way goes on as it began."""
    perform(StartEpisode(run=2, level=LEVEL, physics="fast", slot="b"))
    perform(Tailor(level=LEVEL, physics="fast"))
    (under_way,) = perform(Advance(run=2, actions=(LEFT,), slot="b"))
    assert not under_way.tailored
    assert np.array_equal(under_way.position, shared[1].position)
    return play(perform)


@pytest.mark.slow
def test_an_episode_is_played_in_one_step_from_first_to_last(shared, own):
    assert {snapshot.tailored for snapshot in shared} == {False}
    assert {snapshot.tailored for snapshot in own} == {True}


@pytest.mark.slow
def test_both_steps_play_alike(shared, own):
    position = np.array([[s.position for s in episode] for episode in (shared, own)])
    angle = np.array([[s.angle for s in episode] for episode in (shared, own)])
    assert np.abs(position[0, -1] - position[0, 0]).max() > 0.3
    np.testing.assert_allclose(position[1], position[0], atol=1e-3)
    np.testing.assert_allclose(angle[1], angle[0], atol=1e-2)
    assert own[-1].outcome == shared[-1].outcome


@pytest.mark.slow
def test_a_level_that_was_only_changed_in_numbers_plays_in_it_too(perform, own):
    assert play(perform, SAME["moved"])[-1].tailored
    assert not perform(StartEpisode(run=1, level=OTHER["fixed"], physics="fast")).tailored


@pytest.mark.slow
def test_what_judges_is_played_in_the_shared_step(perform, shared, own):
    solution = Solution(physics="fast", frame_skip=2, actions=((30, LEFT),))
    opened = perform(PlaySolution(level=LEVEL.replace(solution=solution)))
    recorded = opened.trace.snapshots
    assert {snapshot.tailored for snapshot in recorded} == {False}
    assert np.array_equal(recorded[-1].position, shared[-1].position)
    # Played on from a moment of it, the run goes on in the step that it was made with.
    assert perform(StartEpisode(run=3, level=LEVEL, physics="fast")).tailored
    perform(Restore(run=3, snapshot=recorded[10]))
    after = perform(Advance(run=3, actions=(LEFT,) * 5))
    assert not after[-1].tailored
    assert np.array_equal(after[-1].position, recorded[15].position)


@pytest.mark.slow
def test_going_back_in_the_own_step_gives_the_same_to_the_bit(perform, own):
    episode = play(perform, run=4)
    perform(Restore(run=4, snapshot=episode[5]))
    again = perform(Advance(run=4, actions=(LEFT,) * 10))
    assert again[-1].tailored
    assert np.array_equal(again[-1].position, episode[15].position)
    assert np.array_equal(episode[15].position, own[15].position)


@pytest.mark.slow
def test_pictures_of_both_are_drawn_by_one_function(perform, shared, own):
    from editor.worker.simulation import pictures

    view = {"level": LEVEL, "size": (96, 64), "centre": (2.5, 1.0), "scale": 20.0}
    first = perform(RenderState(state=shared[-1].state, **view))
    compiled = pictures._draw._cache_size()
    second = perform(RenderState(state=own[-1].state, **view))
    assert pictures._draw._cache_size() == compiled
    changed = np.abs(first.pixels.astype(int) - second.pixels).max(axis=-1) > 8
    assert changed.mean() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("reports", [0, 2])
def test_a_step_that_is_called_off_is_not_made(perform, reports):
    level = OTHER["bouncing"]
    with pytest.raises(Cancelled):
        perform(Tailor(level=level, physics="fast"), CalledOff(reports))
    assert not perform(StartEpisode(run=1, level=level, physics="fast")).tailored
