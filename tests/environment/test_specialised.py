"""A step compiled for one level alone plays like the one that fits every level."""

import dataclasses
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.spec import Features
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.named import make_named_env
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.reset import (
    level_state,
    load_from_json_file,
    static_env_params_with_level,
)
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.features import features_of
from tests.environment.conftest import small_level

STEPS = 60


def player(static: StaticEnvParams) -> Callable[[EnvState], np.ndarray]:
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

    return lambda state: np.asarray(play(env.reset(keys[0], EnvParams(), state)[1], actions))


def nearby(state: EnvState, count: int) -> list[EnvState]:
    """The same level with its free bodies about a micrometre away."""
    free = np.asarray(state.world.bodies.inverse_mass) > 0
    away = np.random.default_rng(0).normal(scale=1e-6, size=(count, len(free), 2))
    positions = (state.physics.position + away * free[:, None]).astype(np.float32)
    return [
        dataclasses.replace(state, physics=dataclasses.replace(state.physics, position=position))
        for position in positions
    ]


@pytest.mark.slow
def test_leaving_out_what_a_level_lacks_changes_nothing() -> None:
    """But for rounding, of which a contact may make as much as of a start a micrometre away."""
    static = static_env_params_from_size("s", physics="fast")
    start = level_state(small_level(), static)
    features = features_of(start.world)
    assert features != Features()
    assert not features.restitution
    play = player(static)
    generic = play(start)
    specialised = player(dataclasses.replace(static, features=features))(start)
    assert np.isfinite(generic).all()
    assert np.abs(generic[-1] - generic[0]).max() > 0.3

    def apart(other: np.ndarray) -> np.ndarray:
        """The largest difference from the generic step's until each step."""
        return np.maximum.accumulate(np.abs(other - generic).max(axis=(1, 2)))

    amplified = np.max([apart(play(other)) for other in nearby(start, 12)], axis=0)
    assert amplified[STEPS // 2] < 1e-3
    np.testing.assert_array_less(apart(specialised), 1e-5 + 2 * amplified)


def test_a_level_of_which_a_step_would_leave_parts_out_is_refused() -> None:
    """It would be played without its thrusters, and nobody would know why it is never won."""
    env = make_named_env("s/goalkeeper", auto_reset=False, physics="fast")
    flight, _, _ = load_from_json_file("s/first_flight", physics="fast")
    with pytest.raises(KinetixError, match=r"leaves out .*thrusters"):
        env.reset(jax.random.key(0), None, flight)
    with pytest.raises(KinetixError, match="with this level included"):
        env.reset(jax.random.key(0), flight)
    with pytest.raises(KinetixError, match=r"s/first_flight: .*thrusters"):
        level_state("s/first_flight", env.static_env_params)
    static = static_env_params_with_level("s/first_flight", env.static_env_params)
    assert level_state("s/first_flight", static) is not None
    assert static_env_params_with_level("s/goalkeeper", static) is static
