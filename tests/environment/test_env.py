"""The step as a whole: timing, resets, batching, faults. Size s, so that little is compiled."""

import copy
import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.compat.wrappers import GymnaxWrapper
from kinetix.environment.env import DummyEnv, KinetixEnv, make_kinetix_env
from kinetix.environment.named import make_named_env
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.reset import (
    level_state,
    load_from_json_file,
    make_reset_fn_list_of_levels,
)
from kinetix.environment.spaces import Binary, Box, Discrete, MultiDiscrete, Space
from kinetix.environment.state import EnvState
from kinetix.environment.wrappers import LogWrapper
from kinetix.errors import KinetixError
from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Body, Circle, Level
from tests.environment.conftest import assert_trees_close, small_level

BATCH = 5


def batch_of(state: EnvState, count: int = BATCH) -> EnvState:
    """Copies of a state that differ in their velocities."""
    copies = jax.tree.map(lambda x: jnp.stack([jnp.asarray(x)] * count), state)
    push = jnp.linspace(-1.0, 1.0, count)[:, None, None]
    velocity = copies.physics.velocity + push * state.world.bodies.active[None, :, None]
    return dataclasses.replace(
        copies, physics=dataclasses.replace(copies.physics, velocity=velocity)
    )


@functools.cache
def many_steps(env: KinetixEnv) -> Callable[..., Any]:
    """The batched step, compiled once for all tests."""
    return jax.jit(jax.vmap(env.step))


def random_actions(env: KinetixEnv, count: int = BATCH) -> jax.Array:
    return jax.vmap(env.actions.random_action)(jax.random.split(jax.random.key(7), count))


@pytest.fixture(scope="module")
def keys() -> jax.Array:
    return jax.random.split(jax.random.key(1), BATCH)


def test_batch_equals_loop(small_env: KinetixEnv, small_state: EnvState, keys: jax.Array) -> None:
    states, actions = batch_of(small_state), random_actions(small_env)
    together = many_steps(small_env)(keys, states, actions)
    for index in range(BATCH):
        state = jax.tree.map(lambda x, i=index: x[i], states)
        alone = small_env.step(keys[index], state, actions[index])
        assert_trees_close(jax.tree.map(lambda x, i=index: x[i], together), alone)


@pytest.mark.slow
def test_batch_equals_loop_with_contacts_and_joints(small_env: KinetixEnv, keys: jax.Array) -> None:
    static = dataclasses.replace(small_env.static_env_params, physics="jax2d", frame_skip=4)
    env = dataclasses.replace(small_env, static_env_params=static, auto_reset=False)
    start = level_state(small_level(), static)
    test_batch_equals_loop(env, start, keys)


def test_nested_batches_equal_one_batch(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    states, actions = batch_of(small_state), random_actions(small_env)
    flat = many_steps(small_env)(keys, states, actions)
    folded = jax.tree.map(lambda x: x.reshape(1, BATCH, *x.shape[1:]), (keys, states, actions))
    nested = jax.jit(jax.vmap(jax.vmap(small_env.step)))(*folded)
    again = jax.tree.map(lambda x: x.reshape(BATCH, *x.shape[2:]), nested)
    assert_trees_close(again, flat)


def test_the_same_key_gives_the_same_episode(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    states, actions = batch_of(small_state), random_actions(small_env)
    first = many_steps(small_env)(keys, states, actions)
    second = many_steps(small_env)(keys, states, actions)
    assert_trees_close(first, second, tolerance=0.0)


def test_auto_reset_replaces_state_and_observation_only(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    """Three of five episodes are at their last step; the others go on."""
    states = batch_of(small_state)
    over = jnp.array([True, False, True, True, False])
    states = dataclasses.replace(states, timestep=jnp.where(over, 255, 3))
    actions = jnp.zeros((BATCH, 6), jnp.int32)
    obs, after, _, done, info = many_steps(small_env)(keys, states, actions)
    terminal_env = dataclasses.replace(small_env, auto_reset=False)
    terminal = jax.vmap(terminal_env.step)(keys, states, actions)
    np.testing.assert_array_equal(done, over)
    np.testing.assert_array_equal(info["truncated"], over)
    assert not info["terminated"].any()
    first_obs, first_state = small_env.reset(keys[0])
    for index in range(BATCH):
        got = jax.tree.map(lambda x, i=index: x[i], (after, obs))
        if over[index]:
            assert_trees_close(got, (first_state, first_obs))
        else:
            kept = jax.tree.map(lambda x, i=index: x[i], (terminal[1], terminal[0]))
            assert_trees_close(got, kept)
    np.testing.assert_array_equal(terminal[1].timestep, jnp.where(over, 256, 4))
    assert (terminal[1].last_distance[over] == -1.0).all()


def test_override_by_position_and_by_keyword(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    states = batch_of(small_state)
    states = dataclasses.replace(states, timestep=jnp.full(BATCH, 255))
    override = batch_of(small_state)
    actions = jnp.zeros((BATCH, 6), jnp.int32)
    by_position = jax.vmap(small_env.step, in_axes=(0, 0, 0, None, 0))(
        keys, states, actions, EnvParams(), override
    )
    by_keyword = jax.vmap(small_env.step)(keys, states, actions, override_reset_state=override)
    assert_trees_close(by_position, by_keyword)
    np.testing.assert_allclose(by_position[1].physics.velocity, override.physics.velocity)


def test_terminal_observation_on_request(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    env = dataclasses.replace(small_env, keep_terminal_observation=True)
    state = dataclasses.replace(small_state, timestep=jnp.int32(255))
    action = env.actions.noop_action()
    obs, _, _, done, info = env.step(keys[0], state, action)
    terminal = dataclasses.replace(small_env, auto_reset=False).step(keys[0], state, action)[0]
    assert done
    assert_trees_close(info["terminal_observation"], terminal)
    assert_trees_close(obs, env.reset(keys[0])[0])


def test_nan_ends_the_episode(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    broken = dataclasses.replace(
        small_state,
        physics=dataclasses.replace(
            small_state.physics,
            velocity=jnp.asarray(small_state.physics.velocity).at[4].set(jnp.nan),
        ),
    )
    obs, state, reward, done, info = small_env.step(
        keys[0], broken, small_env.actions.noop_action()
    )
    assert done
    assert info["nan"]
    assert not info["truncated"]
    assert reward == 0.0
    for leaf in jax.tree.leaves((obs, state)):
        assert np.isfinite(np.asarray(leaf, np.float64)).all()


def test_nan_action_is_caught(small_static: StaticEnvParams, small_state: EnvState) -> None:
    env = make_kinetix_env("continuous", "symbolic_flat", None, EnvParams(), small_static, False)
    _, _, reward, done, info = env.step(jax.random.key(0), small_state, jnp.full(6, jnp.nan))
    assert done
    assert info["nan"]
    assert np.isfinite(reward)


@pytest.mark.parametrize("physics", ["balanced", "jax2d"])
def test_a_nan_action_is_caught_where_no_body_feels_it(physics: str) -> None:
    level, static, params = load_from_json_file("s/goalkeeper", physics=physics)
    env = make_kinetix_env("continuous", "blind", None, params, static, False)
    step = jax.jit(env.step)
    for action, caught in ((jnp.full(6, jnp.nan), True), (jnp.full(6, jnp.inf), False)):
        _, _, reward, done, info = step(jax.random.key(0), level, action, params)
        assert (bool(done), bool(info["nan"])) == (caught, caught)
        assert np.isfinite(reward)


def test_time_limits_of_the_level_and_of_the_parameters(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    def done_after(state: EnvState, params: EnvParams) -> bool:
        return bool(small_env.step(keys[0], state, jnp.zeros(6, jnp.int32), params)[3])

    def with_limit(limit: int) -> EnvState:
        labels = dataclasses.replace(small_state.labels, max_timesteps=jnp.int32(limit))
        return dataclasses.replace(small_state, labels=labels)

    assert done_after(with_limit(1), EnvParams())
    assert not done_after(with_limit(2), EnvParams(max_timesteps=1))
    assert done_after(with_limit(0), EnvParams(max_timesteps=1))
    endless: Any = jnp.inf
    assert not done_after(with_limit(1), EnvParams(max_timesteps=endless))
    assert not done_after(with_limit(0), EnvParams(max_timesteps=endless))


def test_no_gradient_flows(small_env: KinetixEnv, small_state: EnvState, keys: jax.Array) -> None:
    def reward(push: jax.Array) -> jax.Array:
        velocity = jnp.asarray(small_state.physics.velocity) + push
        physics = dataclasses.replace(small_state.physics, velocity=velocity)
        state = dataclasses.replace(small_state, physics=physics, last_distance=jnp.float32(3.0))
        return small_env.step(keys[0], state, jnp.zeros(6, jnp.int32))[2]

    assert jax.grad(reward)(jnp.float32(0.5)) == 0.0


def test_environments_differ_by_every_parameter(small_env: KinetixEnv) -> None:
    seen = {small_env}
    same = dataclasses.replace(small_env)
    assert same in seen
    for name, value in dataclasses.asdict(EnvParams()).items():
        params = EnvParams(**{name: value + 1})
        assert dataclasses.replace(small_env, env_params=params) not in seen
    static = small_env.static_env_params
    for change in ({"frame_skip": 3}, {"touch_includes_joined": False}, {"downscale": 2}):
        other = dataclasses.replace(static, **change)
        assert dataclasses.replace(small_env, static_env_params=other) not in seen


def test_parameters_take_effect_without_a_new_environment(
    small_env: KinetixEnv, small_state: EnvState, keys: jax.Array
) -> None:
    action = jnp.zeros(6, jnp.int32)
    slow = small_env.step(keys[0], small_state, action, EnvParams(dt=1 / 120))[1]
    fast = small_env.step(keys[0], small_state, action, EnvParams())[1]
    fall = [float(state.bodies.velocity[4, 1]) for state in (slow, fast)]
    np.testing.assert_allclose(fall[1] / fall[0], 2.0, rtol=1e-5)


def test_without_a_level_the_message_says_what_is_missing(small_static: StaticEnvParams) -> None:
    env = make_kinetix_env("discrete", "blind", None, EnvParams(), small_static)
    with pytest.raises(KinetixError, match="reset_fn=None"):
        env.reset(jax.random.key(0))


def test_a_level_of_another_size_is_refused(small_env: KinetixEnv) -> None:
    other = level_state(Level(name="m"), static_env_params_from_size("m", physics="drift"))
    with pytest.raises(KinetixError, match="slots of polygons"):
        small_env.reset(jax.random.key(0), EnvParams(), other)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"action_type": "steer"}, "multi_discrete"),
        ({"observation_type": "smell"}, "symbolic_entity"),
        ({"static_env_params": StaticEnvParams(frame_skip=0)}, "frame_skip"),
        ({"parity": "kinetix-2"}, "kinetix-3"),
    ],
)
def test_bad_arguments_are_named(arguments: dict, message: str) -> None:
    with pytest.raises(KinetixError, match=message):
        make_kinetix_env(**arguments)


def test_levels_without_any_entity_and_without_slots() -> None:
    """Capacity zero of everything but the arena."""
    static = static_env_params_from_size("4,0,0,0", physics="drift")
    env = make_kinetix_env(
        "multi_discrete",
        "symbolic_entity",
        make_reset_fn_list_of_levels(Level(name="empty"), static),
        EnvParams(),
        static,
    )
    obs, state = env.reset(jax.random.key(0))
    obs, state, reward, done, info = env.step(jax.random.key(0), state, env.actions.noop_action())
    assert bool(env.observation_space().contains(obs))
    assert reward == 0.0
    assert info["distance"] == 0.0
    assert not done
    assert state.timestep == 1


def test_dummy_environment_stands_still(small_static: StaticEnvParams) -> None:
    env = make_kinetix_env(
        "discrete", "symbolic_flat", None, EnvParams(), small_static, create_dummy_env=True
    )
    assert isinstance(env, DummyEnv)
    obs, state = env.reset(jax.random.key(0))
    after = env.step(jax.random.key(0), state, env.action_space().sample(jax.random.key(1)))
    assert_trees_close(after[:2], (obs, state), tolerance=0.0)
    assert not after[3]
    assert "terminal_observation" not in after[4]
    assert bool(env.observation_space().contains(obs))
    kept = DummyEnv(env=dataclasses.replace(env.env, keep_terminal_observation=True))
    action = env.actions.noop_action()
    info = jax.eval_shape(kept.step, jax.random.key(0), state, action)[4]
    assert info["terminal_observation"].shape == obs.shape


def test_log_wrapper_counts_episodes(small_env: KinetixEnv, small_state: EnvState) -> None:
    ball = Level(
        name="drop",
        size="s",
        next_id=3,
        bodies=(
            Body(id=1, shape=Circle(radius=0.3), position=(1.0, 1.7), role="green"),
            Body(id=2, shape=Circle(radius=0.3), position=(1.0, 1.0), role="blue", fixed=True),
        ),
    )
    start = level_state(ball, small_env.static_env_params)
    env = LogWrapper(dataclasses.replace(small_env, reset_fn=lambda key: start))
    _, state = env.reset(jax.random.key(0))
    total, lengths = 0.0, 0
    for _ in range(20):
        _, state, reward, done, info = env.step(jax.random.key(0), state, env.actions.noop_action())
        total, lengths = total + float(reward), lengths + 1
        if done:
            break
        assert not info["returned_episode"]
    assert info["returned_episode"]
    assert info["returned_episode_solved"]
    np.testing.assert_allclose(info["returned_episode_returns"], total, rtol=1e-6)
    assert info["returned_episode_lengths"] == lengths
    assert state.episode_lengths == 0
    assert state.env_state.timestep == 0
    assert info["timestep"] == lengths


def test_level_lists_are_drawn_evenly_and_by_key(small_static: StaticEnvParams) -> None:
    levels = [small_level(), Level(name="empty")]
    reset = make_reset_fn_list_of_levels(levels, small_static)
    keys = jax.random.split(jax.random.key(5), 400)
    drawn = jax.vmap(reset)(keys).world.joints.active.any(axis=1)
    share = float(drawn.mean())
    assert abs(share - 0.5) < 4 * 0.5 / 20
    np.testing.assert_array_equal(
        drawn[:3], [bool(reset(key).world.joints.active.any()) for key in keys[:3]]
    )


def test_a_state_tells_what_ended_it_though_the_shapes_have_parted_since() -> None:
    b = LevelBuilder("Bounce", gravity=(0, 0), arena=False)
    b.circle(2.5, 2.5, 0.2, role="green", velocity=(20, 0), restitution=1, friction=0)
    b.circle(3.9, 2.5, 0.2, role="blue", restitution=1, friction=0, fixed=True)
    env = make_named_env(b.build(), auto_reset=False)
    _, first = env.reset(jax.random.key(0))
    ball = int(np.argmax(np.abs(first.physics.velocity[:, 0])))
    shifts = jnp.linspace(0, 0.7, 24)

    def play(shift: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        position = first.physics.position.at[ball, 0].add(shift)
        start = dataclasses.replace(
            first, physics=dataclasses.replace(first.physics, position=position)
        )

        def once(state: EnvState, _: None) -> tuple[EnvState, tuple[jax.Array, ...]]:
            _, state, reward, done, _ = env.step(jax.random.key(0), state, jnp.zeros(6, jnp.int32))
            told = env.compute_reward_info(state)[0]
            return state, (reward > 0.5, told > 0.5, done)

        return jax.lax.scan(once, start, length=5)[1]

    won, told, done = jax.jit(jax.vmap(play))(shifts)
    assert won.any(axis=1).sum() >= 12
    assert np.array_equal(told & done, won & done)


def test_classes_are_whole_numbers() -> None:
    one, several = Discrete(n=3), MultiDiscrete(number_of_dims_per_distribution=(3, 2))
    assert one.contains(2) and not one.contains(1.5)
    assert several.contains([2, 1.0]) and not several.contains([0.5, 1])


@pytest.mark.parametrize(
    "space",
    [
        Discrete(n=3),
        MultiDiscrete(number_of_dims_per_distribution=(3, 2)),
        Box(low=-1.0, high=1.0, shape=(2,)),
        Binary(shape=(2,)),
    ],
    ids=lambda space: type(space).__name__,
)
def test_values_of_another_shape_lie_in_no_space(space: Space) -> None:
    inside = jnp.zeros(space.shape, space.dtype)
    assert space.contains(inside)
    others = [jnp.zeros(shape, space.dtype) for shape in ((), (2,), (3,), (2, 2))]
    assert not any(space.contains(x) for x in others if x.shape != space.shape)


def test_a_copy_of_a_wrapper_is_a_wrapper(small_env: KinetixEnv) -> None:
    for kind in (LogWrapper, GymnaxWrapper):
        copied = copy.deepcopy(kind(small_env))
        assert isinstance(copied, kind)
        assert copied.num_actions == small_env.num_actions
