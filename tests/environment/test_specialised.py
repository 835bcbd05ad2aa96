"""A step compiled for one level alone plays like the one that fits every level."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.spec import Features
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.level.features import features_of
from tests.environment.conftest import small_level

STEPS = 60


def trajectory(state: EnvState, static: StaticEnvParams) -> np.ndarray:
    """Positions and angles of all bodies, [step, body, 3], under fixed random actions."""
    env = make_kinetix_env("multi_discrete", "blind", None, EnvParams(), static, auto_reset=False)
    keys = jax.random.split(jax.random.key(11), STEPS)
    actions = jax.vmap(env.action_space().sample)(keys)

    @jax.jit
    def play(state: EnvState, actions: jax.Array) -> jax.Array:
        def step(state: EnvState, action: jax.Array) -> tuple[EnvState, jax.Array]:
            _, state, *_ = env.step(keys[0], state, action)
            bodies = state.bodies
            return state, jnp.concatenate([bodies.position, bodies.rotation[:, None]], axis=1)

        return jax.lax.scan(step, state, actions)[1]

    return np.asarray(play(env.reset(keys[0], EnvParams(), state)[1], actions))


@pytest.mark.slow
def test_leaving_out_what_a_level_lacks_changes_nothing() -> None:
    static = static_env_params_from_size("s", physics="fast")
    start = level_state(small_level(), static)
    features = features_of(start.world)
    assert features != Features()
    assert not features.restitution
    generic = trajectory(start, static)
    specialised = trajectory(start, dataclasses.replace(static, features=features))
    assert np.isfinite(generic).all()
    moved = np.abs(generic[-1] - generic[0]).max()
    assert moved > 0.3
    np.testing.assert_allclose(specialised, generic, atol=1e-3)
