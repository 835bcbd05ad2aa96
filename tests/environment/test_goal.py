"""The reward's table: roles, kinds of bodies, joined or not, both events at once."""

import dataclasses
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv
from kinetix.environment.goal import dense_reward, goal_distance, sparse_reward, touch_matrix
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.level.model import Body, Circle, Level

SIZE = Capacity(polygons=6, circles=3, joints=0, thrusters=0)
PAIRS = candidate_pairs(SIZE)
EXPECTED = {1: {2: 1.0, 3: -1.0}, 2: {1: 1.0}, 3: {1: -1.0}}


def reward_of(state: EnvState, touching: np.ndarray, *, includes_joined: bool = True) -> float:
    reward = sparse_reward(
        jnp.asarray(touching), state.world, state.labels, includes_joined=includes_joined
    )
    return float(reward)


@pytest.fixture(scope="module")
def scene(small_env: KinetixEnv) -> EnvState:
    """Six polygons (four of the arena) and three circles, all active, without roles."""
    static = dataclasses.replace(
        small_env.static_env_params, num_polygons=6, num_circles=3, num_joints=0, num_thrusters=0
    )
    state = level_state(Level(name="bare"), static)
    bodies = dataclasses.replace(state.world.bodies, active=jnp.ones(9, bool))
    collides = ~jnp.eye(9, dtype=bool)
    world = dataclasses.replace(state.world, bodies=bodies, collides=collides)
    return dataclasses.replace(state, world=world)


def with_roles(state: EnvState, **roles: int) -> EnvState:
    role = np.zeros(9, np.int32)
    for body, value in roles.items():
        role[int(body.removeprefix("b"))] = value
    return dataclasses.replace(
        state, labels=dataclasses.replace(state.labels, role=jnp.asarray(role))
    )


def test_touches_stand_at_the_pair_they_belong_to() -> None:
    for size in (SIZE, Capacity(polygons=12, circles=4, joints=0, thrusters=0)):
        pairs = candidate_pairs(size)
        matrix = np.asarray(touch_matrix(jnp.arange(len(pairs)) % 3 == 0, size))
        expected = np.zeros_like(matrix)
        expected[tuple(pairs[::3].T)] = True
        np.testing.assert_array_equal(matrix, expected)


def test_every_pair_of_roles_and_kinds(scene: EnvState) -> None:
    """Floor, polygon and circle in every combination that can touch."""
    kinds = {(0, 4), (4, 5), (6, 0), (6, 4), (6, 7)}
    for pair in kinds:
        touching = (np.array(pair) == PAIRS).all(axis=1)
        assert touching.sum() == 1
        for a, b in itertools.product(range(4), repeat=2):
            state = with_roles(scene, **{f"b{pair[0]}": a, f"b{pair[1]}": b})
            assert reward_of(state, touching) == EXPECTED.get(a, {}).get(b, 0.0), (pair, a, b)
            assert reward_of(state, np.zeros_like(touching)) == 0.0


def test_death_wins_over_the_goal(scene: EnvState) -> None:
    state = with_roles(scene, b4=1, b5=2, b6=3)
    assert reward_of(state, np.ones(len(PAIRS), bool)) == -1.0


def test_inactive_bodies_have_no_role(scene: EnvState) -> None:
    state = with_roles(scene, b4=1, b5=2)
    bodies = dataclasses.replace(
        state.world.bodies, active=state.world.bodies.active.at[5].set(False)
    )
    state = dataclasses.replace(state, world=dataclasses.replace(state.world, bodies=bodies))
    assert reward_of(state, np.ones(len(PAIRS), bool)) == 0.0
    assert float(goal_distance(state.physics.position, state.world, state.labels)) == 0.0


def test_joined_bodies_count_unless_switched_off(scene: EnvState) -> None:
    state = with_roles(scene, b4=1, b5=2)
    collides = state.world.collides.at[4, 5].set(False).at[5, 4].set(False)
    state = dataclasses.replace(state, world=dataclasses.replace(state.world, collides=collides))
    touching = np.ones(len(PAIRS), bool)
    assert reward_of(state, touching) == 1.0
    assert reward_of(state, touching, includes_joined=False) == 0.0


def test_distance_sums_over_all_green_and_blue_pairs(scene: EnvState) -> None:
    state = with_roles(scene, b0=2, b4=1, b5=2, b6=1)
    position = np.random.default_rng(0).normal(size=(9, 2)).astype(np.float32)
    expected = sum(
        np.linalg.norm(position[green] - position[blue]) for green in (4, 6) for blue in (0, 5)
    )
    distance = goal_distance(jnp.asarray(position), state.world, state.labels)
    np.testing.assert_allclose(distance, expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("distance", "last", "scale", "expected"),
    [
        (2.0, 3.0, 0.1, 0.1),
        (3.0, 2.0, 0.2, -0.2),
        (2.0, -1.0, 0.1, 0.0),
        (2.0, 3.0, 0.0, 0.0),
        (float("nan"), 3.0, 0.1, 0.0),
        (float("inf"), 3.0, 0.1, 0.0),
    ],
)
def test_dense_reward(distance: float, last: float, scale: float, expected: float) -> None:
    reward = dense_reward(jnp.float32(distance), jnp.float32(last), scale)
    np.testing.assert_allclose(reward, expected, rtol=1e-6)


@pytest.mark.parametrize(("event_step", "frame_skip"), [(1, 1), (1, 2), (2, 2), (2, 4)])
def test_the_first_event_of_a_step_counts(
    small_env: KinetixEnv, event_step: int, frame_skip: int
) -> None:
    """A green ball passes a blue one; which physics step touches depends on where it starts.

    The test's physics tests touches at the start of a physics step: less than half a metre apart.
    """
    static = dataclasses.replace(small_env.static_env_params, frame_skip=frame_skip)
    env = dataclasses.replace(small_env, static_env_params=static, auto_reset=False)
    speed = 30.0
    gap = 0.5 + speed / 60 * (event_step - 1.5)
    level = Level(
        name="pass",
        size="s",
        gravity=(0.0, 0.0),
        next_id=3,
        bodies=(
            Body(
                id=1,
                shape=Circle(radius=0.2),
                position=(1.0, 2.0),
                velocity=(speed, 0.0),
                role="green",
            ),
            Body(
                id=2, shape=Circle(radius=0.2), position=(1.0 + gap, 2.0), role="blue", fixed=True
            ),
        ),
    )
    start = level_state(level, static)
    start = dataclasses.replace(start, last_distance=jnp.float32(gap))
    _, state, reward, done, info = env.step(jax.random.key(0), start, env.actions.noop_action())
    assert done
    assert info["GoalR"]
    assert info["terminated"]
    moved = speed / 60
    np.testing.assert_allclose(info["distance"], abs(gap - moved * event_step), atol=1e-5)
    np.testing.assert_allclose(reward, 1.0 - 0.1 * (abs(gap - moved * event_step) - gap), atol=1e-5)
    np.testing.assert_allclose(state.bodies.position[5, 0], 1.0 + moved * frame_skip, atol=1e-5)
