"""The locomotion family."""

import dataclasses
import math
from typing import Any

import jax
import numpy as np
import pytest

from kinetix.engine.spec import ARENA_BODIES
from kinetix.environment.generators.draft import Draft
from kinetix.environment.generators.locomotion import LocomotionParams, draw_locomotion
from kinetix.errors import KinetixError
from kinetix.level.sizes import SIZES

SIZE = SIZES["locomotion"]
WORLDS = 2048


def drawn(params: LocomotionParams) -> Draft:
    keys = jax.random.split(jax.random.PRNGKey(5), WORLDS)
    return jax.tree.map(np.asarray, jax.jit(lambda k: draw_locomotion(k, SIZE, params))(keys))


@pytest.fixture(scope="module")
def usual() -> Draft:
    return drawn(LocomotionParams())


def test_the_creature(usual: Draft) -> None:
    figures, joints = usual.figures, usual.joints
    assert figures.active[: ARENA_BODIES + 6].all()
    assert (joints.active.sum(0) == 5).all()
    assert joints.motor_on[joints.active].all()
    assert (joints.motor_power[joints.active] == 3).all()
    assert np.allclose(joints.limit_max[joints.active], math.pi / 4)
    assert usual.motor_binding[:4, 0].tolist() == [0, 1, 2, 3]
    assert (joints.body_a < joints.body_b)[joints.active].all()
    assert (figures.role[4] == 1).all()
    extra = joints.body_a[4]
    assert set(np.unique(extra)) == {4, 7}
    assert abs((extra == 4).mean() - 0.5) < 0.06
    assert set(np.unique(usual.motor_binding[4])) == {0, 1, 2}
    assert not usual.thrusters.active.any()


def test_sizes_and_places(usual: Draft) -> None:
    figures = usual.figures
    size = figures.vertices.max(1) - figures.vertices.min(1)
    for row, default in ((4, (0.6, 0.2)), (5, (0.1, 0.3)), (7, (0.1, 0.2))):
        share = size[row] / np.array(default)[:, None]
        assert share.min() + 1e-6 >= 0.5
        assert share.max() <= 1.5 + 1e-6
        assert np.abs(share.mean(1) - 1).max() < 0.04
    assert (figures.vertices[4, 0, 0] < 0).all()
    assert (figures.vertices[4, 0, 1] > 0).all()
    here = figures.active & ~figures.circle & (np.arange(len(figures.active)) >= 4)[:, None]
    low = (figures.position - size / 2)[here.nonzero()[0], :, here.nonzero()[1]]
    high = (figures.position + size / 2)[here.nonzero()[0], :, here.nonzero()[1]]
    assert low[:, 0].min() >= 0.2 - 1e-5
    assert low[:, 1].min() >= 0.5 - 1e-5
    assert high[:, 0].max() <= 4.8 + 1e-5
    goal = SIZE.polygons
    assert (figures.role[goal] == 2).all()
    assert figures.fixed[goal].all()
    x, y = figures.position[goal]
    assert (y == 1).all()
    left = figures.position[4, 0] < 2.5
    assert ((x >= 2.0) & (x <= 4.5))[left].all()
    assert ((x >= 0.5) & (x <= 3.0))[~left].all()
    assert abs((figures.role[0] == 3).mean() - 0.25) < 0.05
    assert set(np.unique(figures.role[0])) == {0, 3}


def test_limbs_hang_together(usual: Draft) -> None:
    figures, joints = usual.figures, usual.joints
    n = np.arange(WORLDS)

    def place(body: Any, anchor: Any) -> Any:
        angle = figures.rotation[body, n]
        c, s = np.cos(angle), np.sin(angle)
        turned = np.stack([c * anchor[0] - s * anchor[1], s * anchor[0] + c * anchor[1]])
        return figures.position[body, :, n].T + turned

    for k in range(5):
        gap = place(joints.body_a[k], joints.anchor_a[k]) - place(
            joints.body_b[k], joints.anchor_b[k]
        )
        assert np.abs(gap).max() < 1e-5


@pytest.mark.slow
def test_options() -> None:
    params = LocomotionParams(
        random_motors=True,
        body_rotation_range=0.5,
        add_ankles=False,
        num_random_legs_min=0,
        num_random_legs_max=3,
        friction_range=0.4,
        friction_exclude=0.2,
        density_range=0.5,
        leg_dim_exclude=0.25,
        ensure_leg_dims_equal=True,
        ensure_limb_thickness_equal=True,
        fix_goal_position=True,
        do_permute_state=True,
        kinetix_quirks=False,
    )
    draft = drawn(params)
    figures, joints = draft.figures, draft.joints
    assert set(np.unique(joints.active.sum(0))) == {2, 3, 4, 5}
    assert set(np.unique(draft.motor_binding[joints.active])) == {0, 1, 2, 3}
    limb = figures.active & ~figures.circle & (np.arange(len(figures.active)) >= 4)[:, None]
    friction = draft.friction[limb]
    assert ((np.abs(friction - 1) >= 0.2 - 1e-6) & (np.abs(friction - 1) <= 0.4 + 1e-6)).all()
    assert figures.density[limb].std() > 0.2
    blue = figures.active & figures.circle
    assert (blue.sum(0) == 1).all()
    x = figures.position[:, 0][blue]
    assert set(np.round(np.unique(x), 4)) == {1.75, 3.25}
    green = limb & (figures.role == 1)
    assert set(np.argmax(green, 0)) == {4, 5, 6, 7, 8, 9}
    width = (figures.vertices.max(1) - figures.vertices.min(1))[:, 0]
    legs = limb & ~green
    thinnest = np.where(legs, width, np.inf).min(0)
    thickest = np.where(legs, width, -np.inf).max(0)
    assert np.abs(thinnest - thickest).max() < 1e-6
    share = thinnest / 0.1
    assert ((np.abs(share - 1) >= 0.25 - 1e-5) & (np.abs(share - 1) <= 0.5 + 1e-5)).all()


@pytest.mark.slow
def test_the_right_chain_without_the_quirk(usual: Draft) -> None:
    plain = drawn(dataclasses.replace(LocomotionParams(), kinetix_quirks=False))
    assert set(np.unique(plain.joints.body_a[4])) == {4, 7, 8}


def test_too_few_slots_are_refused() -> None:
    with pytest.raises(KinetixError, match="at least"):
        draw_locomotion(jax.numpy.zeros((1, 2), jax.numpy.uint32), SIZES["s"], LocomotionParams())
