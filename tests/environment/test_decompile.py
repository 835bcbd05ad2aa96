"""A state becomes a level and the level the same state."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import kinetix
from kinetix.environment.params import physics_engine
from kinetix.environment.reset import level_state
from kinetix.level.codec import dumps, loads
from tests.environment.conftest import assert_trees_close


def in_file(level):
    """The level as it is read again from its file."""
    return loads(dumps(level))


@pytest.mark.parametrize("name", ["s/first_flight", "m/leapfrog", "l/car_park", "l/clockwork"])
def test_a_bundled_level_and_its_state_are_one(name):
    level = kinetix.load_level(name)
    static = kinetix.static_env_params_from_size(name[0])
    state = level_state(level, static)
    again = kinetix.level_of(state, name)
    assert (again.name, again.inertia_model) == (name, level.inertia_model)
    assert_trees_close(level_state(in_file(again), static), state, 1e-6)


def test_a_random_level_gets_the_usual_time_limit_and_no_masses_of_its_own():
    static = kinetix.static_env_params_from_size("6,2,1,1")
    params = kinetix.EnvParams()
    engine = physics_engine(static)
    state = kinetix.sample_kinetix_level(jax.random.key(3), engine, params, static)
    level = in_file(kinetix.level_of(state))
    assert level.max_timesteps == params.max_timesteps
    assert all(body.mass_properties is None for body in level.bodies)
    again = level_state(level, static)
    for name in ("position", "rotation", "active"):
        np.testing.assert_allclose(getattr(again.bodies, name), getattr(state.bodies, name))


def test_a_changed_state_keeps_its_change(small_state):
    moved = small_state.replace(
        gravity=jnp.array([0.0, -1.5]),
        circle=small_state.circle.replace(position=small_state.circle.position + 0.25),
    )
    level, before = kinetix.level_of(moved), kinetix.level_of(small_state)
    assert level.gravity == (0.0, -1.5)
    shift = np.subtract([b.position for b in level.bodies], [b.position for b in before.bodies])
    assert shift.max() == pytest.approx(0.25, abs=1e-6)


def test_what_is_no_single_state_is_refused(small_state, tmp_path):
    from kinetix.util.saving import export_env_state_to_json

    states = jax.tree.map(lambda x: jnp.stack([x, x]), small_state)
    with pytest.raises(kinetix.KinetixError, match=r"a batch of shape \(2,\): .*x\[0\], states"):
        kinetix.level_of(states)
    with pytest.raises(kinetix.KinetixError, match=r"a batch of shape \(2,\): .*x\[0\], states"):
        export_env_state_to_json(tmp_path / "batch", states, None, kinetix.EnvParams())
    with pytest.raises(kinetix.KinetixError, match="got Level; the order is level_of"):
        kinetix.level_of(kinetix.level_of(small_state))
    with pytest.raises(kinetix.KinetixError, match="no values within"):
        jax.jit(kinetix.level_of)(small_state)
    with pytest.raises(kinetix.KinetixError, match="name 3: expected a title"):
        kinetix.level_of(small_state, 3)


def test_whoever_saves_or_shows_a_state_learns_how(small_state, tmp_path):
    for function in (lambda state: kinetix.save_level(state, tmp_path / "x"), kinetix.show):
        with pytest.raises(kinetix.KinetixError, match=r"got EnvState; kinetix\.level_of\(state"):
            function(small_state)
