"""Exact consequences of the rules of random levels."""

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.generators.draws import Tape
from kinetix.environment.generators.figures import area
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.sample import draw_levels, level_sampler
from kinetix.environment.params import physics_engine, static_env_params_from_size


def assert_share(successes: Any, chance: float) -> None:
    """The share of successes is within five standard errors of the chance."""
    successes = np.asarray(successes)
    error = math.sqrt(chance * (1 - chance) / successes.size)
    assert abs(successes.mean() - chance) <= 5 * error, (successes.mean(), chance)


def bodies(draft: Any) -> np.ndarray:
    return draft.figures.active & (np.arange(len(draft.figures.active))[:, None] >= ARENA_BODIES)


def assert_uniform(values: np.ndarray, low: float, high: float) -> None:
    """The sample fits the uniform distribution (Kolmogorov–Smirnov, one in a million)."""
    ordered = np.sort((values - low) / (high - low))
    assert ordered[0] >= -1e-5
    assert ordered[-1] <= 1 + 1e-5
    steps = np.arange(1, ordered.size + 1) / ordered.size
    assert np.abs(ordered - steps).max() < 2.7 / math.sqrt(ordered.size)


@pytest.mark.parametrize("size", ["s", "m", "l"])
def test_what_holds_in_every_level(size: str, drafts: dict[str, Any]) -> None:
    draft = drafts[size]
    figures, joints, thrusters = draft.figures, draft.joints, draft.thrusters
    here = bodies(draft)
    for leaf in jax.tree.leaves(draft):
        assert np.isfinite(leaf).all()
    assert (draft.gravity == np.array([[0], [-9.81]], np.float32)).all()
    assert not draft.velocity.any()
    assert not draft.angular_velocity.any()
    assert (figures.vertex_count == 4).all()
    counted = here.copy()
    counted[0] = True
    for role in (1, 2):
        assert ((figures.role == role) & counted).sum(0).min() == 1
        assert ((figures.role == role) & counted).sum(0).max() == 1
    assert ((figures.role == 3) & here).sum(0).max() <= 1
    goal = ((figures.role == 1) | (figures.role == 2)) & here
    assert (goal & ~figures.fixed).any(0).all()
    blue_floor = figures.role[0] == 2
    assert not ((figures.role == 2) & here)[:, blue_floor].any()
    green = (figures.role == 1) & here
    assert not figures.fixed[:, blue_floor][green[:, blue_floor]].any()
    red_floor = figures.role[0] == 3
    assert not ((figures.role == 3) & here)[:, red_floor].any()
    assert (joints.active | thrusters.active.any(0)[None]).any(0).all()
    hub = joints.active & ~joints.fixed
    assert not joints.motor_on[~hub].any()
    assert not joints.limited[~hub].any()
    assert not joints.reference_angle[hub].any()
    on = np.take_along_axis(figures.active, thrusters.body, 0)
    loose = ~np.take_along_axis(figures.fixed, thrusters.body, 0)
    assert (on & loose)[thrusters.active].all()


@pytest.mark.parametrize("size", ["s", "m", "l"])
def test_chances(size: str, drafts: dict[str, Any]) -> None:
    draft = drafts[size]
    figures, thrusters = draft.figures, draft.thrusters
    for role, chance in enumerate((0.90, 0.0, 0.02, 0.08)):
        assert_share(figures.role[0] == role, chance)
    count = thrusters.active.sum(0)
    shares = {"s": (1 / 3, 2 / 3)}.get(size, (0.7 / 3, 2 / 3 * 0.7 + 0.3 / 3, 0.2))
    for k, chance in enumerate(shares):
        assert_share(count == k, chance)
    hub = draft.joints.active & ~draft.joints.fixed
    assert_share(draft.joints.motor_on[hub], 0.8)
    assert_uniform(draft.joints.motor_speed[hub], 0.4, 3.0)
    weight = np.take_along_axis(np.asarray(area(figures)), thrusters.body, 0)
    assert_uniform((10 * thrusters.power / weight)[thrusters.active], 10, 40)


def test_size_s(drafts: dict[str, Any]) -> None:
    draft = drafts["s"]
    figures, joints = draft.figures, draft.joints
    here = bodies(draft)
    assert (here & ~figures.circle).sum(0).tolist() == [1] * here.shape[1]
    assert (here & figures.circle).sum(0).tolist() == [2] * here.shape[1]
    assert not (figures.fixed & here).any()
    joined, thrusting = joints.active[0], draft.thrusters.active[0]
    assert_share(joined, 2 / 3)
    assert_share(joined & thrusting, 1 / 3)
    assert not joints.fixed.any()
    assert (joints.motor_power[joints.active] == 1).all()
    assert not joints.limited.any()
    a_round = np.take_along_axis(figures.circle, joints.body_a, 0)[0]
    b_round = np.take_along_axis(figures.circle, joints.body_b, 0)[0]
    assert (a_round ^ b_round)[joined].all()
    centre = np.where(b_round, joints.anchor_b[0], joints.anchor_a[0])
    assert not centre[:, joined].any()
    red = ((figures.role == 3) & here).any(0)
    free = ~joined & (figures.role[0] == 0)
    assert_share(red[figures.role[0] == 0], 1 / 12)
    assert_share(red[free], 1 / 4)
    assert_uniform(figures.radius[figures.circle & figures.active], 0.1, 0.4)
    sides = np.moveaxis(np.abs(figures.vertices).max(1), 1, -1)[here & ~figures.circle]
    longest = 1 / (2 * math.sqrt(2))
    assert sides.min() >= 0.05
    assert sides.max() <= 2 * longest + 1e-6
    # One side is doubled in 0.3; it then exceeds the bound when it was drawn above half of it.
    doubled = (sides > longest).any(-1)
    assert_share(doubled, 0.3 * (longest / 2) / (longest - 0.05))
    # The other side of a doubled rectangle is untouched.
    assert_uniform(sides[doubled].min(-1), 0.05, longest)


def test_first_two_of_larger_sizes_are_placed_freely(drafts: dict[str, Any]) -> None:
    draft = drafts["m"]
    count = bodies(draft).sum(0)
    assert set(count.tolist()) <= {3, 4, 5}
    assert set(bodies(drafts["l"]).sum(0).tolist()) <= set(range(3, 13))


def test_joined_bodies_meet_at_their_joint(drafts: dict[str, Any]) -> None:
    draft = drafts["l"]
    figures, joints = draft.figures, draft.joints
    n = np.arange(joints.active.shape[1])

    def place(body: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        angle = figures.rotation[body, n]
        c, s = np.cos(angle), np.sin(angle)
        x, y = anchor
        return figures.position[body, :, n].T + np.stack([c * x - s * y, s * x + c * y])

    for k in range(len(joints.active)):
        gap = place(joints.body_a[k], joints.anchor_a[k]) - place(
            joints.body_b[k], joints.anchor_b[k]
        )
        assert np.abs(gap[:, joints.active[k]]).max() < 1e-4


def test_a_level_is_a_function_of_its_key_alone() -> None:
    engine = physics_engine(static_env_params_from_size("s", physics="jax2d"))
    sample = level_sampler(engine, UEDParams())
    keys = jax.random.split(jax.random.key(3), 6)
    batch = jax.jit(jax.vmap(sample))(keys)
    alone = jax.jit(sample)(keys[4])
    nested = jax.jit(jax.vmap(jax.vmap(sample)))(keys.reshape(2, 3))
    for one, many, grid in zip(*map(jax.tree.leaves, (alone, batch, nested)), strict=True):
        assert np.allclose(one, many[4], atol=1e-6)
        assert np.array_equal(many.reshape(grid.shape), grid)


@pytest.mark.slow
def test_triangles_and_odd_capacities() -> None:
    keys = jax.random.split(jax.random.PRNGKey(0), 512)
    capacity = Capacity(polygons=7, circles=2, joints=2, thrusters=1)
    ued = UEDParams(generate_triangles=True, legacy_ceiling=True)
    draft = jax.tree.map(np.asarray, jax.jit(lambda k: draw_levels(k, capacity, ued))(keys))
    polygon = bodies(draft) & ~draft.figures.circle
    assert 0.3 < (draft.figures.vertex_count[polygon] == 3).mean() < 0.7
    triangle = polygon & (draft.figures.vertex_count == 3)
    corners = np.moveaxis(draft.figures.vertices, -1, 1)[triangle]
    assert np.abs(corners[:, :3].mean(1)).max() < 1e-6
    assert not corners[:, 3].any()
    assert (draft.figures.vertices[3, 0] == np.array([[5.0], [5.2]], np.float32)).all()
    tiny = Capacity(polygons=5, circles=1, joints=1, thrusters=0)
    draft = jax.jit(lambda k: draw_levels(k, tiny, UEDParams()))(keys)
    assert int(jnp.sum(draft.figures.active, axis=0).max()) == 6


def test_the_tape_refuses_to_run_over() -> None:
    tape = Tape(jnp.zeros((2, 2), jnp.uint32), 5)
    assert tape.take(2, 2).shape == (2, 2, 2)
    with pytest.raises(ValueError, match="5 numbers"):
        tape.take(2)
