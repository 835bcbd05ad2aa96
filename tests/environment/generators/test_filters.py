"""The filter of trivial levels, and the other sources of levels."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.environment.env import make_kinetix_env
from kinetix.environment.generators.filters import (
    choose_unsolved,
    noop_solved,
    sample_filtered_levels,
)
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import level_sampler
from kinetix.environment.generators.starts import accel_start_sampler, mixed_sampler
from kinetix.environment.params import EnvParams, physics_engine, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.environment.state import stack_states
from kinetix.errors import KinetixError
from kinetix.level.model import Body, Circle, Level


def test_solved_levels_are_taken_only_when_needed() -> None:
    solved = jnp.arange(200) % 2 == 0
    draw = jax.jit(choose_unsolved, static_argnums=2)
    kept = np.asarray(draw(jax.random.key(0), solved, 90))
    assert len(set(kept.tolist())) == 90
    assert (kept % 2 == 0).mean() < 0.05
    everything = np.asarray(draw(jax.random.key(1), solved, 200))
    assert sorted(everything.tolist()) == list(range(200))
    counts = np.zeros(200)
    for seed in range(40):
        counts[np.asarray(draw(jax.random.key(seed), solved, 50))] += 1
    assert counts[1::2].std() < 5


@pytest.mark.slow
@pytest.mark.parametrize("action_type", ["discrete", "multi_discrete"])
def test_levels_that_the_noop_solves(action_type: str) -> None:
    static = static_env_params_from_size("s", physics="jax2d")
    ball = Circle(radius=0.3)

    def tower(x: float, role: str = "blue") -> Level:
        low = Body(id=1, shape=ball, position=(1.0, 0.7), role="green")
        return Level(
            name="tower", bodies=(low, Body(id=2, shape=ball, position=(x, 2.0), role=role))
        )

    levels = [level_state(tower(x), static) for x in (1.0, 4.0)]
    levels.append(level_state(tower(1.0, "red"), static))
    states = stack_states(levels)
    env = make_kinetix_env(action_type, "symbolic_flat", None, EnvParams(), static)
    assert np.asarray(noop_solved(env, states, EnvParams())).tolist() == [True, False, False]
    assert not np.asarray(noop_solved(env, states, EnvParams(), steps=3)).any()
    sampler = jax.jit(level_sampler(physics_engine(static), UEDParams()))
    kept = sample_filtered_levels(jax.random.key(0), 64, sampler, env, EnvParams())
    assert kept.timestep.shape == (64,)
    raw = sample_filtered_levels(jax.random.key(0), 64, sampler, env, EnvParams(), steps=0)
    solved = [float(noop_solved(env, some, EnvParams()).mean()) for some in (kept, raw)]
    assert solved[0] == 0
    assert solved[1] > 0.05


def test_mixed_sizes_need_room_for_the_smallest() -> None:
    engine = physics_engine(static_env_params_from_size("5,1,1,1"))
    with pytest.raises(KinetixError, match="size 5,1,1,1: random levels of all sizes need"):
        mixed_sampler(engine)


@pytest.mark.slow
def test_mixed_sizes() -> None:
    engine = physics_engine(static_env_params_from_size("m", physics="jax2d"))
    keys = jax.random.split(jax.random.key(2), 2048)
    state = jax.jit(jax.vmap(mixed_sampler(engine)))(keys)
    active = np.asarray(state.world.bodies.active)
    # Size s fills one polygon and two circles, and leaves the last slot of each kind empty.
    small = ~active[:, 5] & ~active[:, 8]
    assert 0.49 < small.mean() < 0.56
    assert active.sum(1).max() == 9


@pytest.mark.slow
def test_accel_starts() -> None:
    engine = physics_engine(static_env_params_from_size("m", physics="jax2d"))
    keys = jax.random.split(jax.random.key(2), 2048)
    state = jax.tree.map(np.asarray, jax.jit(jax.vmap(accel_start_sampler(engine)))(keys))
    role, active = state.labels.role, state.world.bodies.active
    for wanted in (1, 2):
        assert ((role == wanted) & active).sum(1).tolist() == [1] * 2048
    joint = state.world.joints.active.any(1)
    thruster = state.world.thrusters.active.any(1)
    assert abs(joint.mean() - 2 / 3) < 0.06
    assert (joint | thruster).mean() > 0.8
    assert (active.sum(1) == 6 + joint).all()
    assert not (role == 3).any()
    assert state.world.bodies.radius.max() > 0.45
