"""Mutations: what each of them does, where it does nothing, and that levels stay sound."""

import dataclasses
import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.spec import ARENA_BODIES
from kinetix.environment.generators.draft import Draft, draft_of, states
from kinetix.environment.generators.edits import ACCEL_WEIGHTS, accel_edit, mutate_state
from kinetix.environment.generators.mutators import MUTATORS, NUMBERS, SETTLED
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import physics_engine, static_env_params_from_size
from kinetix.errors import KinetixError
from kinetix.level.sizes import SIZES

WORLDS = 512
SIZE = SIZES["m"]
QUIRKS = UEDParams()
PLAIN = UEDParams(kinetix_quirks=False)
ENGINE = physics_engine(static_env_params_from_size("m", physics="jax2d"))


@pytest.fixture(scope="module")
def before(drafts: dict[str, Draft]) -> Draft:
    return jax.tree.map(lambda leaf: jnp.asarray(leaf[..., :WORLDS]), drafts["m"])


@pytest.fixture(scope="module")
def after(before: Draft) -> dict[str, Draft]:
    """Every mutation (before settling), in the even worlds only."""
    u = jnp.asarray(np.random.default_rng(4).random((NUMBERS, WORLDS), np.float32))
    marked = jnp.arange(WORLDS) % 2 == 0

    @jax.jit
    def apply(draft: Draft) -> dict[str, Draft]:
        found = {name: mutate(draft, u, marked, QUIRKS, SIZE) for name, mutate in MUTATORS.items()}
        for name in ("change_size", "change_location"):
            found[f"{name}_plain"] = MUTATORS[name](draft, u, marked, PLAIN, SIZE)
        dense = dataclasses.replace(
            draft.figures, density=jnp.full_like(draft.figures.density, 2.0)
        )
        dense_draft = dataclasses.replace(draft, figures=dense)
        for name, ued in (("quirks", QUIRKS), ("plain", PLAIN)):
            found[f"density_{name}"] = MUTATORS["add_shape"](dense_draft, u, marked, ued, SIZE)
        left = dataclasses.replace(draft, motor_auto=draft.motor_auto | ~draft.joints.active)
        found["left"] = MUTATORS["add_connected_shape"](left, u, marked, QUIRKS, SIZE)
        return found

    return jax.tree.map(np.asarray, apply(before))


def changed(before: Draft, after: Draft) -> np.ndarray:
    """Mark the worlds that differ in anything."""
    differ = [
        (np.asarray(a) != np.asarray(b)).reshape(-1, WORLDS).any(0)
        for a, b in zip(jax.tree.leaves(before), jax.tree.leaves(after), strict=True)
    ]
    return np.any(differ, axis=0)


def drawn(draft: Draft) -> np.ndarray:
    active = np.asarray(draft.figures.active)
    return active & (np.arange(len(active))[:, None] >= ARENA_BODIES)


@pytest.mark.parametrize("name", list(MUTATORS))
def test_only_marked_worlds_change(name: str, before: Draft, after: dict[str, Draft]) -> None:
    differ = changed(before, after[name])
    assert not differ[1::2].any()
    assert differ[::2].mean() > 0.1


@pytest.mark.parametrize("name", list(MUTATORS))
def test_levels_stay_sound(name: str, after: dict[str, Draft]) -> None:
    draft = after[name]
    for leaf in jax.tree.leaves(draft):
        assert np.isfinite(leaf).all()
    figures, joints, thrusters = draft.figures, draft.joints, draft.thrusters
    assert figures.active[:ARENA_BODIES].all()
    assert figures.fixed[:ARENA_BODIES].all()
    for end in (joints.body_a, joints.body_b):
        assert np.take_along_axis(figures.active, end, 0)[joints.active].all()
    assert (joints.body_a != joints.body_b)[joints.active].all()
    assert np.take_along_axis(figures.active, thrusters.body, 0)[thrusters.active].all()
    assert (thrusters.body >= ARENA_BODIES)[thrusters.active].all()
    circle = drawn(draft) & figures.circle
    assert figures.radius[circle].min() >= 0.05
    width = figures.vertices.max(1) - figures.vertices.min(1)
    assert np.moveaxis(width, 1, -1)[drawn(draft) & ~figures.circle].min() > 0.05


def test_removing_and_adding(before: Draft, after: dict[str, Draft]) -> None:
    count = drawn(before).sum(0)
    marked = np.arange(WORLDS) % 2 == 0
    assert (count - drawn(after["remove_shape"]).sum(0) == marked).all()
    joints, thrusters = before.joints.active.sum(0), before.thrusters.active.sum(0)
    removed = joints - after["remove_joint"].joints.active.sum(0)
    assert (removed == (marked & (joints > 0))).all()
    removed = thrusters - after["remove_thruster"].thrusters.active.sum(0)
    assert (removed == (marked & (thrusters > 0))).all()
    room = count < SIZE.bodies - ARENA_BODIES
    assert (drawn(after["add_shape"]).sum(0) - count == (marked & room)).all()
    grown = after["add_connected_shape"]
    room = room & np.asarray(joints < SIZE.joints)
    assert (drawn(grown).sum(0) - count == (marked & room)).all()
    assert (grown.joints.active.sum(0) - joints == (marked & room)).all()
    free = drawn(before) & ~np.asarray(before.figures.fixed)
    room = (np.asarray(thrusters) < SIZE.thrusters) & free.any(0)
    assert (after["add_thruster"].thrusters.active.sum(0) - thrusters == (marked & room)).all()


def test_a_new_joint_has_nothing_of_a_removed_one(before: Draft, after: dict[str, Draft]) -> None:
    grown = after["left"]
    new = grown.joints.active & ~np.asarray(before.joints.active)
    assert new.any() and not grown.motor_auto[new].any()
    assert (grown.motor_auto | grown.joints.active)[:, 1::2].all()


def test_swapping_roles_keeps_them(before: Draft, after: dict[str, Draft]) -> None:
    old, new = np.asarray(before.figures.role), after["swap_role"].figures.role
    there = drawn(before)
    differ = ((old != new) & there).sum(0)
    assert set(differ.tolist()) == {0, 2}
    assert (np.sort(np.where(there, old, -1), 0) == np.sort(np.where(there, new, -1), 0)).all()
    kinds = np.array([len(set(old[there[:, k], k])) for k in range(WORLDS)])
    assert (differ[::2] == 2)[kinds[::2] > 1].all()


def test_fixtures_and_gravity(before: Draft, after: dict[str, Draft]) -> None:
    toggled = np.asarray(before.figures.fixed) ^ after["toggle_fixture"].figures.fixed
    assert (toggled.sum(0) == (np.arange(WORLDS) % 2 == 0)).all()
    pull = after["change_gravity"].gravity[1, ::2]
    assert ((pull >= np.float32(-9.8)) & (pull <= 0)).all()
    assert abs((pull == np.float32(-9.8)).mean() - 0.5) < 0.15


def test_q2_the_density_of_a_slot(after: dict[str, Draft], before: Draft) -> None:
    new = drawn(after["density_quirks"]) & ~drawn(before)
    assert new.any()
    assert (after["density_quirks"].figures.density[new] == 2).all()
    assert (after["density_plain"].figures.density[new] == 1).all()


def test_q9_resized_bodies(before: Draft, after: dict[str, Draft]) -> None:
    old, new = before.thrusters.position, after["change_size"].thrusters.position
    assert (np.asarray(old) == new).all()
    assert (np.asarray(old) != after["change_size_plain"].thrusters.position).any()
    figures, joints = after["change_size"].figures, after["change_size"].joints
    # Anchors stay inside their bodies.
    half = np.take_along_axis(np.abs(figures.vertices).max(1), joints.body_a[:, None], 0)
    polygon = ~np.take_along_axis(figures.circle, joints.body_a, 0) & joints.active
    inside = (np.abs(joints.anchor_a) <= half + 1e-5).all(1)
    assert inside[polygon & (joints.body_a >= ARENA_BODIES)].all()


def test_q10_moved_components(before: Draft, after: dict[str, Draft]) -> None:
    for name in ("change_location", "change_location_plain"):
        moved = after[name].figures.position - np.asarray(before.figures.position)
        assert not moved[:ARENA_BODIES].any()
        a, b = (
            np.take_along_axis(moved, np.asarray(end)[:, None], 0)
            for end in (before.joints.body_a, before.joints.body_b)
        )
        both = (np.asarray(before.joints.body_a) >= ARENA_BODIES) & np.asarray(before.joints.active)
        assert np.abs(a - b).max(1)[both].max() < 1e-6
    figures = after["change_location_plain"].figures
    reach = np.linalg.norm(figures.vertices, axis=2).max(1) + figures.radius
    step = np.abs(figures.position - np.asarray(before.figures.position)).max(1)
    touched = (step > 0) & drawn(before)
    x, y = np.moveaxis(figures.position, 1, 0)
    assert (x >= -1e-5)[touched & figures.circle].all()
    assert (y - figures.radius >= 0.4 - 1e-5)[touched & figures.circle].all()
    assert (x <= 5 + reach)[touched].all()


def test_turned_welds_keep_their_new_angle(drafts: dict[str, Draft]) -> None:
    draft = jax.tree.map(lambda leaf: jnp.asarray(leaf[..., :WORLDS]), drafts["l"])
    u = jnp.asarray(np.random.default_rng(6).random((NUMBERS, WORLDS), np.float32))
    everywhere = jnp.ones((WORLDS,), bool)
    turn = MUTATORS["change_rotation"]
    new = jax.tree.map(
        np.asarray, jax.jit(lambda d: turn(d, u, everywhere, QUIRKS, SIZES["l"]))(draft)
    )
    joints = new.joints
    n = np.arange(WORLDS)
    angle = new.figures.rotation[joints.body_b, n] - new.figures.rotation[joints.body_a, n]
    weld = joints.active & joints.fixed
    assert np.abs(angle - joints.reference_angle)[weld].max() < 1e-5
    step = new.figures.rotation - np.asarray(draft.figures.rotation)
    assert (np.count_nonzero(step, axis=0) <= 1).all()
    assert step.max() <= math.pi / 2


def test_a_freed_body_turns_about_its_centre_of_mass(before: Draft) -> None:
    figures = before.figures
    row = 4
    off = dataclasses.replace(
        figures,
        vertices=figures.vertices.at[row].add(0.25),
        active=jnp.zeros_like(figures.active).at[:ARENA_BODIES].set(True).at[row].set(True),
        fixed=jnp.ones_like(figures.fixed),
    )
    draft = dataclasses.replace(
        before,
        figures=off,
        joints=dataclasses.replace(before.joints, active=jnp.zeros_like(before.joints.active)),
    )
    u = jnp.zeros((NUMBERS, WORLDS))
    toggle = jax.jit(
        lambda d: MUTATORS["toggle_fixture"](d, u, jnp.ones((WORLDS,), bool), QUIRKS, SIZE)
    )
    new = toggle(draft).figures
    corners = np.asarray(new.vertices)[row]
    assert not np.asarray(new.fixed)[row].any()
    assert np.abs(corners.mean(0)).max() < 1e-5
    angle = np.asarray(new.rotation)[row]
    c, s = np.cos(angle), np.sin(angle)
    shift = np.asarray(new.position - off.position)[row]
    assert np.allclose(shift, 0.25 * np.stack([c - s, s + c]), atol=1e-5)


def test_drafts_and_states_are_two_forms_of_the_same(before: Draft) -> None:
    state = states(before, ENGINE, "kinetix")
    back = draft_of(state)
    for a, b in zip(jax.tree.leaves(before), jax.tree.leaves(back), strict=True):
        assert np.array_equal(a, b)


def test_unknown_mutations_are_named(before: Draft) -> None:
    state = jax.tree.map(lambda leaf: leaf[0], states(before, ENGINE, "kinetix"))
    with pytest.raises(KinetixError, match="change_size"):
        mutate_state(jax.random.key(0), state, "change_colour")


@pytest.mark.slow
def test_the_accel_edit(before: Draft) -> None:
    state = states(before, ENGINE, "kinetix")
    keys = jax.random.split(jax.random.key(2), WORLDS)
    edit = jax.jit(jax.vmap(lambda key, state: accel_edit(key, state, 4)))
    after = edit(keys, state)
    draft = jax.tree.map(np.asarray, draft_of(after))
    for leaf in jax.tree.leaves(after):
        assert np.isfinite(np.asarray(leaf)).all()
    assert changed(before, draft).mean() > 0.95
    assert not draft.velocity.any()
    assert set(ACCEL_WEIGHTS) | {"remove_joint", "remove_shape", "change_gravity"} == set(MUTATORS)
    joints = draft.joints
    n = np.arange(WORLDS)

    def place(body: Any, anchor: Any) -> Any:
        angle = draft.figures.rotation[body, n]
        c, s = np.cos(angle), np.sin(angle)
        turned = np.stack([c * anchor[0] - s * anchor[1], s * anchor[0] + c * anchor[1]])
        return draft.figures.position[body, :, n].T + turned

    gap = np.abs(
        place(joints.body_a[0], joints.anchor_a[0]) - place(joints.body_b[0], joints.anchor_b[0])
    ).max(0)
    assert np.median(gap[joints.active[0]]) < 0.02
    assert set(ACCEL_WEIGHTS) >= SETTLED
