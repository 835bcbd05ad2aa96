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


@pytest.mark.parametrize(
    ("part", "field", "slot", "value", "expected"),
    [
        ("polygon", "inverse_mass", 4, 0.0, r"polygon\[4\]: expected both or none of inv"),
        ("circle", "inverse_inertia", 0, 0.0, r"circle\[0\]: expected both or none of inv"),
        ("polygon", "active", 0, False, r"polygon\[0\]: expected it to be active.* its floor"),
        ("circle", "collision_mode", 1, 3, r"circle\[1\]: expected a collision_mode from 0 to 2"),
    ],
)
def test_a_body_that_no_level_has_is_refused(small_state, part, field, slot, value, expected):
    bodies = getattr(small_state, part)
    bodies = bodies.replace(**{field: jnp.asarray(getattr(bodies, field)).at[slot].set(value)})
    with pytest.raises(kinetix.LevelError, match=expected):
        kinetix.level_of(small_state.replace(**{part: bodies}))


@pytest.mark.parametrize("role", [-1, 4])
def test_a_role_that_no_level_has_is_refused(small_state, role):
    roles = jnp.asarray(small_state.circle_shape_roles).at[1].set(role)
    with pytest.raises(kinetix.LevelError, match=r"circle\[1\]: expected a role from 0 to 3"):
        kinetix.level_of(small_state.replace(circle_shape_roles=roles))


@pytest.mark.parametrize(("part", "slot"), [("circle", 0), ("polygon", 4)])
def test_a_body_that_was_switched_off_takes_its_joints_and_thrusters_along(small_state, part, slot):
    bodies = getattr(small_state, part)
    bodies = bodies.replace(active=jnp.asarray(bodies.active).at[slot].set(False))
    level = kinetix.level_of(small_state.replace(**{part: bodies}))
    assert (len(level.bodies), level.joints) == (2, ())
    assert [thruster.body for thruster in level.thrusters] == ([1] if part == "circle" else [])
