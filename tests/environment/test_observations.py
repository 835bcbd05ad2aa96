"""Common properties of all kinds of observation, and relations between them."""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.spec import ARENA_BODIES
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.inverse import state_from_entities, state_from_flat
from kinetix.environment.named import make_named_env
from kinetix.environment.observations import (
    OBSERVATIONS,
    AbstractObservation,
    EntityObservations,
    FlatObservations,
    FlatPaddedObservations,
    Layout,
)
from kinetix.environment.observations.rows import joint_rows
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.rearrange import expand_state, permute_state
from kinetix.environment.reset import level_state
from kinetix.environment.spaces import Dict, ObservationType
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from tests.environment.conftest import assert_trees_close, small_level


@functools.partial(jax.jit, static_argnums=0)
def seen(observations: AbstractObservation, state: EnvState) -> Any:
    """The observation of a state, compiled once for each kind."""
    return observations(state)


@pytest.fixture(scope="module")
def layout(small_static: StaticEnvParams) -> Layout:
    return Layout.of(EnvParams(), small_static)


@pytest.fixture(scope="module")
def moving(small_state: EnvState) -> EnvState:
    """The small level with contacts and everything in motion."""
    shape = small_state.physics.position.shape
    drawn = np.random.default_rng(3).normal(size=shape).astype(np.float32)
    physics = dataclasses.replace(
        small_state.physics,
        velocity=jnp.asarray(drawn),
        rotation=jnp.asarray(drawn[:, 0] * 3),
        angular_velocity=jnp.asarray(drawn[:, 1] * 4),
        touching=jnp.arange(small_state.physics.touching.size) % 2 == 0,
    )
    return dataclasses.replace(small_state, physics=physics)


def test_every_type_has_a_class() -> None:
    assert {kind.value for kind in ObservationType} == set(OBSERVATIONS)


@pytest.mark.parametrize("name", list(OBSERVATIONS))
def test_inside_its_space_and_finite_on_random_play(
    small_env: KinetixEnv, layout: Layout, name: str
) -> None:
    env = dataclasses.replace(small_env, observations=OBSERVATIONS[name](layout=layout))
    space = env.observation_space()

    def play(key: jax.Array) -> tuple[jax.Array, jax.Array]:
        obs, state = env.reset(key)

        def step(carry: tuple, key: jax.Array) -> tuple:
            obs, state, *_ = env.step(key, carry[1], env.actions.random_action(key))
            finite = [jnp.isfinite(x).all() for x in jax.tree.leaves(obs)]
            return (obs, state), space.contains(obs) & jnp.all(jnp.stack(finite))

        (obs, _), inside = jax.lax.scan(step, (obs, state), jax.random.split(key, 12))
        return inside, obs

    inside, obs = jax.jit(jax.vmap(play))(jax.random.split(jax.random.key(2), 2))
    assert inside.all()
    if isinstance(space, Dict):
        for part, described in space.spaces.items():
            shown = getattr(obs, part)
            assert shown.shape[1:] == described.shape, part
            assert shown.dtype == described.dtype, part
    else:
        assert obs.shape[1:] == space.shape


@pytest.mark.parametrize("name", list(OBSERVATIONS))
def test_columns_name_every_entry_of_the_last_axis(layout: Layout, name: str) -> None:
    observations = OBSERVATIONS[name](layout=layout)
    space = observations.space
    for part, columns in observations.columns.items():
        if isinstance(space, Dict):
            assert space.spaces[part].shape[-1] == len(columns), part
        else:
            assert space.shape[-1] == len(columns), part


@pytest.mark.parametrize(("size", "length"), [("s", 140), ("m", 247), ("l", 679)])
def test_published_widths(size: str, length: int) -> None:
    layout = Layout.of(EnvParams(), static_env_params_from_size(size, physics="drift"))
    assert len(layout.flat) == length
    assert len({feature.name for feature in layout.flat}) == length
    default = Layout.of(EnvParams(), StaticEnvParams(physics="drift"))
    assert len(default.flat) == 1675
    shapes = {"s": (6, 41), "m": (10, 45), "l": (21, 59)}
    assert FlatPaddedObservations(layout=layout).space.shape == shapes[size]


def test_columns_of_limits_say_that_the_reference_angle_is_taken_off_twice(
    layout: Layout, moving: EnvState
) -> None:
    world = moving.world
    turned = jnp.full_like(world.joints.reference_angle, 0.75)
    joints = dataclasses.replace(
        world.joints, reference_angle=turned, limited=jnp.ones_like(world.joints.limited)
    )
    world = dataclasses.replace(world, joints=joints)
    rows, _ = joint_rows(dataclasses.replace(moving, world=world), layout)
    hinge = np.flatnonzero(joints.active & ~joints.fixed)[0]
    for end in ("min", "max"):
        name = f"limit_{end}_from_reference"
        ((column, meaning),) = [
            (k, each.meaning) for k, each in enumerate(layout.joint) if each.name == name
        ]
        assert rows[hinge, column] == getattr(joints, f"limit_{end}")[hinge] - 0.75
        assert "takes it off twice" in meaning


def test_flat_is_the_padded_form_without_padding(layout: Layout, moving: EnvState) -> None:
    flat = seen(FlatObservations(layout=layout), moving)
    padded = seen(FlatPaddedObservations(layout=layout), moving)
    widths = [len(layout.polygon)] * 2 + [len(layout.circle)] * 2
    widths += [len(layout.flat_joint), len(layout.flat_thruster)]
    rows = [row[:width] for row, width in zip(padded, widths, strict=True)]
    np.testing.assert_array_equal(jnp.concatenate([*rows, padded[0, -1:]]), flat)
    np.testing.assert_array_equal(padded[:, -5:-1].argmax(axis=1), [0, 0, 1, 1, 2, 3])


def test_entities_move_with_their_slots(moving: EnvState) -> None:
    """Permuting the slots permutes rows, masks and indices, and changes nothing else."""
    static = static_env_params_from_size("7,4,3,2", physics="drift")
    state = jax.jit(expand_state, static_argnums=1)(moving, static)
    observe = EntityObservations(layout=Layout.of(EnvParams(), static))
    permuted = jax.jit(permute_state)(jax.random.key(4), state)
    before, after = (jax.tree.map(np.asarray, seen(observe, each)) for each in (state, permuted))
    body_of = np.concatenate(
        [
            [int(np.argmax((before.polygons == row).all(axis=1))) for row in after.polygons],
            [7 + int(np.argmax((before.circles == row).all(axis=1))) for row in after.circles],
        ]
    )
    active = np.concatenate([after.polygon_mask, after.circle_mask])
    np.testing.assert_array_equal(body_of[:4], range(4))
    assert (body_of[active] != np.flatnonzero(active)).any()
    masks = np.concatenate([before.polygon_mask, before.circle_mask])
    np.testing.assert_array_equal(active.sum(), masks.sum())
    chosen = np.flatnonzero(active)
    for plane in range(3):
        np.testing.assert_array_equal(
            np.asarray(after.attention_mask)[plane][np.ix_(chosen, chosen)],
            np.asarray(before.attention_mask)[plane][np.ix_(body_of[chosen], body_of[chosen])],
        )
    assert not after.attention_mask[3].any()
    joint = int(np.argmax(after.joint_mask[:3]))
    np.testing.assert_array_equal(
        body_of[np.asarray(after.joint_indexes[joint])],
        before.joint_indexes[int(np.argmax(before.joint_mask[:3]))],
    )


def test_contact_plane_in_one_direction_or_both(layout: Layout, moving: EnvState) -> None:
    one_way = seen(EntityObservations(layout=layout), moving).attention_mask[3]
    symmetric = EntityObservations(layout=layout, symmetric_contacts=True)
    both_ways = seen(symmetric, moving).attention_mask[3]
    assert one_way.any()
    assert not (one_way & one_way.T).any()
    np.testing.assert_array_equal(both_ways, one_way | one_way.T)


def test_attention_can_be_left_out(layout: Layout, moving: EnvState) -> None:
    observations = EntityObservations(layout=layout, attention=False)
    shown = seen(observations, moving)
    assert shown.attention_mask is None
    assert "attention_mask" not in observations.space.spaces


def test_swapped_anchors_of_the_other_dialect(layout: Layout, moving: EnvState) -> None:
    ours = seen(EntityObservations(layout=layout), moving).joints
    theirs = seen(EntityObservations(layout=layout, js_anchor_order=True), moving).joints
    np.testing.assert_array_equal(theirs[:, 2:4], ours[:, 4:6])
    np.testing.assert_array_equal(theirs[:, 4:6], ours[:, 2:4])
    np.testing.assert_array_equal(theirs[:, 6:], ours[:, 6:])


def begun_later(state: EnvState, corners: int) -> EnvState:
    """The same scene, all of whose polygons but the arena's list their corners from a later one."""
    bodies = state.world.bodies
    arena, others = np.split(np.asarray(bodies.vertices), [ARENA_BODIES])
    vertices = jnp.asarray(np.concatenate([arena, np.roll(others, -corners, axis=1)]))
    bodies = dataclasses.replace(bodies, vertices=vertices)
    return dataclasses.replace(state, world=dataclasses.replace(state.world, bodies=bodies))


def test_lists_of_four_corners_are_seen_from_an_upper_one(layout: Layout, moving: EnvState) -> None:
    plain = EntityObservations(layout=layout)
    upper = EntityObservations(layout=layout, from_upper_corner=True)
    listed = [seen(upper, begun_later(moving, corners)).polygons for corners in range(4)]
    as_is = seen(plain, moving).polygons
    assert not np.array_equal(seen(plain, begun_later(moving, 2)).polygons, as_is)
    for from_upper_right in (0, 1, 2):
        np.testing.assert_array_equal(listed[from_upper_right], as_is)
    np.testing.assert_array_equal(listed[3], seen(plain, begun_later(moving, 3)).polygons)


def test_states_come_back_from_observations(
    layout: Layout, small_static: StaticEnvParams, moving: EnvState
) -> None:
    entities = seen(EntityObservations(layout=layout), moving)
    back = jax.jit(lambda obs: state_from_entities(obs, EnvParams(), small_static))(entities)
    again = seen(EntityObservations(layout=layout), back)
    assert_trees_close(
        again._replace(attention_mask=again.attention_mask[:3]),
        entities._replace(attention_mask=entities.attention_mask[:3]),
    )
    assert (back.bodies.rotation >= 0).all()
    flat = seen(FlatObservations(layout=layout), moving)
    back = jax.jit(lambda obs: state_from_flat(obs, EnvParams(), small_static))(flat)
    np.testing.assert_allclose(seen(FlatObservations(layout=layout), back), flat, atol=1e-5)
    moves = np.asarray(moving.world.bodies.inverse_mass) > 0
    np.testing.assert_allclose(
        back.world.bodies.inverse_mass[moves], moving.world.bodies.inverse_mass[moves], rtol=1e-4
    )


def test_expansion_changes_nothing_that_is_seen(layout: Layout, moving: EnvState) -> None:
    static = static_env_params_from_size("9,5,4,3", physics="drift")
    wide = Layout.of(EnvParams(), static)
    state = jax.jit(expand_state, static_argnums=1)(moving, static)
    small = seen(EntityObservations(layout=layout), moving)
    large = seen(EntityObservations(layout=wide), state)
    np.testing.assert_array_equal(large.polygons[:5], small.polygons)
    np.testing.assert_array_equal(large.circles[:2], small.circles)
    np.testing.assert_array_equal(
        large.joint_indexes[0], small.joint_indexes[0] + jnp.array([4, 0])
    )
    assert large.polygon_mask.sum() == small.polygon_mask.sum()


def test_a_level_that_is_too_large_says_by_how_much(moving: EnvState) -> None:
    with pytest.raises(KinetixError, match=r"2 circles into 1 \(1 too many\)"):
        expand_state(moving, static_env_params_from_size("5,1,1,1", physics="drift"))


def test_blind_observations_of_levels_that_last_longer_stay_at_their_last_entry(small_static):
    env = make_kinetix_env("discrete", "blind", None, EnvParams(max_timesteps=5), small_static)
    state = level_state(small_level(), small_static)
    late = dataclasses.replace(state, timestep=jnp.int32(9))
    np.testing.assert_array_equal(env.get_obs(late), [0, 0, 0, 0, 0, 1])
    endless = make_kinetix_env(
        "discrete", "blind", None, EnvParams(max_timesteps=jnp.inf), small_static
    )
    with pytest.raises(KinetixError, match=r"expected a finite EnvParams\.max_timesteps"):
        endless.observation_space()


def test_a_blind_environment_of_a_level_is_as_long_as_the_level():
    level = load_level("s/goalkeeper").replace(max_timesteps=300)
    env = make_named_env(level, observation_type="blind")
    assert env.observation_space().shape == (301,)
