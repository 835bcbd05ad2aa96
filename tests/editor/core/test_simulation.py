"""The bridge to JAX: episodes, pictures, films, mutations. Compiles, hence slow."""

import dataclasses
import subprocess
import sys

import msgspec
import numpy as np
import pytest
from PIL import Image as Picture

from editor.documents.commands.bodies import posed
from editor.worker.requests import (
    MUTATIONS,
    Advance,
    CheckDynamics,
    ExportFilm,
    ExportPicture,
    Mutate,
    PlaySolution,
    Pull,
    RandomLevel,
    RenderState,
    Restore,
    StartEpisode,
)
from editor.worker.snapshots import Trace
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from kinetix.level.model import (
    Arena,
    ArenaBody,
    Body,
    Circle,
    Joint,
    Level,
    Motor,
    Polygon,
    Thruster,
)
from kinetix.level.validate import validate
from tests.editor.core.helpers import Unheard

pytestmark = pytest.mark.slow

BAR = Polygon(vertices=((0.4, 0.08), (-0.4, 0.08), (-0.4, -0.08), (0.4, -0.08)))
LEFT = (1, 0, 0, 0, 0, 0)
LEVEL = Level(
    name="Unicycle",
    size="s",
    bodies=(
        Body(id=1, shape=BAR, position=(3.0, 0.62), role="green"),
        Body(id=2, shape=Circle(radius=0.2), position=(3.0, 0.62)),
        Body(id=3, shape=Circle(radius=0.3), position=(1.0, 0.7), role="blue", fixed=True),
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
    thrusters=(Thruster(id=5, body=1, position=(0.4, 0.0), angle=3.14159, power=0.5),),
)


@pytest.fixture(scope="module")
def perform():
    from editor.worker import simulation

    return lambda request: simulation.perform(request, Unheard())


def play(perform, level=LEVEL, actions=(LEFT,) * 40, **options):
    start = perform(StartEpisode(run=1, level=level, physics="balanced", **options))
    return [start, *perform(Advance(run=1, actions=actions, **options))]


@pytest.fixture(scope="module")
def episode(perform):
    return play(perform)


def test_the_floors_role_counts_in_the_distance_from_the_start(perform):
    level = LEVEL.replace(arena=Arena(floor=ArenaBody(role="green")))
    start, after = play(perform, level, (LEFT,))
    assert start.distance == pytest.approx(after.distance, abs=0.1)


def test_an_episode_starts_where_the_level_says(episode):
    first = episode[0]
    assert first.step == 0
    for row, body in enumerate(LEVEL.bodies):
        assert first.position[row] == pytest.approx(body.position)
    assert first.distance == pytest.approx(np.hypot(2.0, 0.08), abs=1e-5)
    assert first.state is not None


def test_the_editor_plays_what_the_command_line_plays(episode):
    from kinetix.environment.replay import play_actions

    headless = play_actions(LEVEL, [LEFT] * 40, physics="balanced")
    last = episode[-1]
    assert last.step == headless.steps
    assert (last.outcome or "timeout") == headless.outcome
    assert last.total_reward == pytest.approx(headless.total_reward, abs=1e-5)


def test_a_recorded_solution_is_played_and_wins(perform):
    level = load_level("s/wheelbarrow")
    opened = perform(PlaySolution(level=level))
    assert opened.trace.snapshots[-1].outcome == "won"
    assert opened.trace.actions == tuple(level.solution.unrolled())[: len(opened.trace.actions)]
    with pytest.raises(KinetixError, match="no recorded solution"):
        perform(PlaySolution(level=LEVEL))
    slow = level.replace(solution=msgspec.structs.replace(level.solution, frame_skip=1))
    with pytest.raises(KinetixError, match="for 1 engine steps"):
        perform(PlaySolution(level=slow))


def test_held_keys_drive_the_motor(episode):
    assert episode[-1].motor == pytest.approx([1.0])
    assert episode[-1].thruster == pytest.approx([0.0])
    wheel = [snapshot.angular_velocity[1] for snapshot in episode]
    assert max(wheel) > 3.0


def test_another_level_of_the_same_size_compiles_nothing(perform, episode):
    from editor.worker.simulation.stepping import PROGRAMS

    PROGRAMS.taken_fresh()
    other = LEVEL.replace(bodies=(*LEVEL.bodies[1:],), joints=(), thrusters=(), gravity=(0.0, -2.0))
    play(perform, other)
    assert PROGRAMS.taken_fresh() == []


def test_going_back_gives_the_same_states_to_the_bit(perform):
    snapshots = play(perform, actions=(LEFT,) * 20)
    perform(Restore(run=1, snapshot=snapshots[5]))
    again = perform(Advance(run=1, actions=(LEFT,) * 15))
    for old, new in zip(snapshots[6:], again, strict=True):
        assert np.array_equal(old.position, new.position)
        assert np.array_equal(old.angular_velocity, new.angular_velocity)


def test_an_episode_goes_on_with_a_changed_level(perform, episode):
    since = episode[10]
    level = posed(LEVEL, since)
    smaller = level.bodies[1].replace(shape=Circle(radius=0.1))
    changed = level.replace(bodies=(level.bodies[0], smaller, level.bodies[2]), joints=())
    start = StartEpisode(run=71, level=changed, physics="balanced", since=since)
    first = perform(start)
    assert first.step == since.step
    assert first.total_reward == since.total_reward
    np.testing.assert_allclose(first.position, since.position)
    np.testing.assert_allclose(first.velocity, since.velocity)
    after = perform(Advance(run=71, actions=(LEFT,) * 300))
    assert after[0].step == since.step + 1
    assert after[-1].outcome in ("won", "timeout")
    assert after[-1].step <= LEVEL.max_timesteps


def test_an_episode_ends_and_stays_ended(perform):
    snapshots = play(perform, LEVEL.replace(max_timesteps=12))
    assert [s.step for s in snapshots] == list(range(13))
    assert snapshots[-1].outcome == "timeout"
    assert perform(Advance(run=1, actions=(LEFT,))) == ()


def test_an_episode_that_was_given_up_is_refused(perform):
    play(perform, actions=())
    with pytest.raises(KinetixError, match="given up"):
        perform(Advance(run=99, actions=(LEFT,)))


def test_a_level_that_does_not_fit_is_refused(perform):
    many = tuple(LEVEL.bodies[2].replace(id=k) for k in range(10, 20))
    with pytest.raises(KinetixError):
        play(perform, LEVEL.replace(bodies=(*LEVEL.bodies, *many), next_id=30))


def test_a_body_is_pulled_towards_the_mouse(perform):
    perform(StartEpisode(run=2, level=LEVEL, physics="balanced"))
    pull = Pull(body=1, anchor=(0.0, 0.0), target=(3.0, 2.5))
    noop = ((0,) * 6,) * 40
    last = perform(Advance(run=2, actions=noop, pull=pull))[-1]
    assert last.position[0][1] > 2.0
    put = Pull(body=1, anchor=(0.0, 0.0), target=(2.0, 3.0), teleport=True)
    (last,) = perform(Advance(run=2, actions=noop[:1], pull=put))
    assert last.position[0] == pytest.approx((2.0, 3.0), abs=0.02)
    assert last.position[1] == pytest.approx((2.0, 3.0), abs=0.02)


def test_contacts_are_told_on_request(perform):
    snapshots = play(perform, actions=((0,) * 6,) * 30, keep_contacts=True)
    touching = {frozenset(pair) for pair in snapshots[-1].touching}
    assert frozenset((2, "floor")) in touching
    contact = next(c for c in snapshots[-1].contacts if {c.body_a, c.body_b} == {2, "floor"})
    assert contact.at == pytest.approx((snapshots[-1].position[1][0], 0.4), abs=0.02)
    assert abs(contact.normal[1]) == pytest.approx(1.0, abs=1e-3)
    # The wheel lies in the bar that it carries: that is no contact, and no penetration.
    assert frozenset((1, 2)) not in touching
    assert snapshots[-1].penetration < 0.01


def test_energy_is_kept_in_free_fall(perform):
    falling = Level(
        name="x", size="s", bodies=(Body(id=1, shape=Circle(radius=0.2), position=(2.5, 4.0)),)
    )
    snapshots = play(perform, falling, actions=((0,) * 6,) * 15)
    energy = [s.kinetic_energy + s.potential_energy for s in snapshots]
    assert energy[-1] == pytest.approx(energy[0], rel=0.02)
    assert snapshots[-1].kinetic_energy > 0.5


def test_a_state_is_drawn_for_the_canvas(perform, episode):
    request = RenderState(
        level=LEVEL, state=episode[-1].state, size=(256, 192), centre=(2.5, 1.5), scale=60.0
    )
    image = perform(request)
    assert image.pixels.shape == (192, 256, 3)
    assert image.pixels.dtype == np.uint8
    assert len(np.unique(image.pixels.reshape(-1, 3), axis=0)) > 4
    with pytest.raises(KinetixError, match="palette"):
        perform(dataclasses.replace(request, palette="no such"))


def test_pictures_are_written(perform, tmp_path):
    path = perform(ExportPicture(level=LEVEL, state=None, path=tmp_path / "a.png"))
    with Picture.open(path) as picture:
        assert (picture.size, picture.mode) == ((500, 500), "RGB")
    path = perform(
        ExportPicture(level=LEVEL, state=None, path=tmp_path / "b.png", transparent=True)
    )
    with Picture.open(path) as picture:
        assert picture.mode == "RGBA"
        alpha = np.asarray(picture)[..., 3]
    assert alpha[10, 250] == 0
    assert alpha[480, 250] == 255
    with pytest.raises(KinetixError, match="cannot be saved"):
        perform(ExportPicture(level=LEVEL, state=None, path=tmp_path / "none" / "c.png"))


@pytest.mark.parametrize("stride", [1, 4])
def test_a_film_has_a_picture_for_each_stride(perform, episode, tmp_path, stride):
    count = (len(episode) - 1) // stride * stride
    trace = Trace(
        physics="balanced",
        perturbed=False,
        snapshots=tuple(episode[: count + 1]),
        actions=(LEFT,) * count,
    )
    request = ExportFilm(
        level=LEVEL, trace=trace, path=tmp_path / "a.gif", pixels=120, stride=stride
    )
    with Picture.open(perform(request)) as film:
        assert film.n_frames == count // stride + 1
        assert film.size == (120, 120)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_mp4_is_written(perform, episode, tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    trace = Trace(
        physics="balanced", perturbed=False, snapshots=tuple(episode[:5]), actions=(LEFT,) * 4
    )
    path = perform(ExportFilm(level=LEVEL, trace=trace, path=tmp_path / "a.mp4", pixels=128))
    assert path.read_bytes()[4:8] == b"ftyp"


def test_every_mutation_is_on_offer():
    from kinetix.environment.generators.mutators import MUTATORS

    assert {name for name, _ in MUTATIONS} == set(MUTATORS)
    assert len({label for _, label in MUTATIONS}) == len(MUTATIONS)


def test_random_levels_and_mutations_are_sound(perform):
    level = perform(RandomLevel(seed=3, size="s"))
    assert level == perform(RandomLevel(seed=3, size="s"))
    codes = {issue.code for issue in validate(level)}
    assert not {code for code in codes if code.startswith("E")} - {"E104", "E105"}
    changed = perform(Mutate(level=level, mutation="change_gravity", seed=1))
    assert changed.gravity != level.gravity
    assert [b.id for b in changed.bodies] == [b.id for b in level.bodies]


def test_random_machines_are_sound(perform):
    level = perform(RandomLevel(seed=3, size="m", machine=True))
    assert level == perform(RandomLevel(seed=3, size="m", machine=True))
    assert not [issue for issue in validate(level) if issue.code.startswith("E")]


def test_a_level_is_judged_without_a_plan(perform):
    won = LEVEL.replace(
        bodies=(
            LEVEL.bodies[2].replace(id=1, position=(2.5, 1.0), fixed=True),
            Body(id=2, shape=Circle(radius=0.2), position=(2.5, 3.0), role="green"),
        ),
        joints=(),
        thrusters=(),
        max_timesteps=60,
    )
    report = perform(CheckDynamics(level=won, attempts=4))
    assert report.noop_outcome == "won"
    assert 5 < report.noop_steps < 60
    assert report.random_solved == 1.0


def test_steps_without_room_for_all_contacts_are_counted(perform):
    square = Polygon(vertices=((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
    shapes = [*(square,) * 8, *(Circle(radius=0.2),) * 4]
    heap = [Body(id=1 + k, shape=shape, position=(2.0, 2.0)) for k, shape in enumerate(shapes)]
    level = Level(name="Heap", size="l", bodies=tuple(heap))
    assert "W211" in {issue.code for issue in validate(level)}
    snapshots = play(perform, level, actions=((0,) * 6,) * 3)
    assert [snapshot.dropped for snapshot in snapshots[:2]] == [0, 1]
    perform(Restore(run=1, snapshot=snapshots[1]))
    (again,) = perform(Advance(run=1, actions=((0,) * 6,)))
    assert again.dropped == snapshots[2].dropped >= 1
    assert {snapshot.dropped for snapshot in play(perform)} == {0}


NAMES = """
from editor.base.settings import Settings
from kinetix.engine.names import DEFAULT_PHYSICS, PRESET_NAMES, SOLVER_NAMES
from kinetix.engine.presets import PRESETS
from kinetix.engine.solvers import SOLVERS

assert tuple(PRESETS) == PRESET_NAMES
assert tuple(SOLVERS) == SOLVER_NAMES
assert Settings().physics == DEFAULT_PHYSICS
assert DEFAULT_PHYSICS in PRESETS
"""


def test_the_names_shown_before_jax_is_loaded_are_the_engines():
    # In a process of its own: other tests add solvers to the table.
    subprocess.run([sys.executable, "-c", NAMES], check=True)
