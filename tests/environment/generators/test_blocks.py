"""The building blocks: roles, contact counts, and the quirks Q1 … Q8 one by one."""

import dataclasses
import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.spec import Capacity
from kinetix.environment.generators.blocks import (
    Proposals,
    Surroundings,
    connected_shape,
    draw_role,
    free_shape,
    joint_of,
    look_around,
    size_limit,
    thrusters_on,
)
from kinetix.environment.generators.boxes import boxes, count_box_contacts
from kinetix.environment.generators.contacts import count_contacts
from kinetix.environment.generators.draft import empty_draft
from kinetix.environment.generators.draws import (
    PER_JOINT,
    PER_SHAPE,
    PER_THRUSTER,
    choose,
    joint_draws,
    shape_draws,
    thruster_draws,
)
from kinetix.environment.generators.figures import Figures, centroid, inertia, mass
from kinetix.environment.generators.params import UEDParams

WORLDS = 4096
QUIRKS = UEDParams()
PLAIN = UEDParams(kinetix_quirks=False)


def numbers(*shape: int, seed: int = 0) -> Any:
    return jnp.asarray(np.random.default_rng(seed).random((*shape, WORLDS), np.float32))


def surroundings(*missing: bool) -> Surroundings:
    green, blue, red = (jnp.full((1, 1), flag) for flag in missing)
    yes = jnp.ones((1, 1), bool)
    return Surroundings(
        polygon_room=yes,
        circle_room=yes,
        joint_room=yes,
        green_missing=green,
        blue_missing=blue,
        red_missing=red,
    )


@pytest.mark.parametrize(
    ("missing", "chances"),
    [
        ((True, True, True), (0, 0.5, 0.5, 0)),
        ((True, False, True), (0, 1, 0, 0)),
        ((False, True, False), (0, 0, 1, 0)),
        ((False, False, True), (0.75, 0, 0, 0.25)),
        ((False, False, False), (1, 0, 0, 0)),
    ],
)
def test_roles(missing: tuple[bool, ...], chances: tuple[float, ...]) -> None:
    u = jnp.asarray(np.random.default_rng(1).random((1, 100_000), np.float32))
    role = np.asarray(draw_role(u, surroundings(*missing)))
    for kind, chance in enumerate(chances):
        error = math.sqrt(chance * (1 - chance) / role.size)
        assert abs((role == kind).mean() - chance) <= 5 * error


def test_a_role_that_nothing_allows_is_neutral() -> None:
    u = jnp.linspace(0, 0.999, 50)[None]
    role = draw_role(u, surroundings(False, True, True), (True, True, False, True))
    assert not np.asarray(role).any()


def test_choose_follows_the_weights_and_never_takes_a_zero() -> None:
    u = jnp.asarray(np.linspace(0, 1, 1000, endpoint=False, dtype=np.float32))
    weights = jnp.broadcast_to(jnp.array([0.0, 1.0, 0.0, 3.0, 0.0])[:, None], (5, 1000))
    row = np.asarray(choose(u, weights))
    assert np.bincount(row, minlength=5).tolist() == [0, 250, 0, 750, 0]


def box_contacts(new: Figures, others: Figures) -> Any:
    """Contacts with others, of which any may be rectangle or circle."""
    rectangles, discs = (
        dataclasses.replace(others, active=others.active & part)
        for part in (~others.circle, others.circle)
    )
    rows = others.active.shape[0]
    return count_box_contacts(boxes(new), boxes(rectangles), boxes(discs), (rows, rows))


def test_boxes_count_the_same_contacts_as_polygons(drafts: dict[str, Any]) -> None:
    figures = jax.tree.map(lambda leaf: jnp.asarray(leaf[..., :1024]), drafts["l"].figures)
    new = jax.tree.map(lambda leaf: leaf[4:], figures)
    exact = jax.jit(count_contacts)(new, figures)
    fast = jax.jit(box_contacts)(new, figures)
    assert np.array_equal(exact, fast)
    assert np.asarray(exact).max() > 4


def one(**changes: Any) -> Figures:
    """A unit square at the origin, as the only row of the only world, unless changed."""
    corners = np.array([[0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [-0.5, 0.5]], np.float32)
    values: dict[str, Any] = {
        "position": np.zeros(2, np.float32),
        "rotation": np.float32(0),
        "vertices": corners,
        "vertex_count": np.int32(4),
        "radius": np.float32(0),
        "circle": np.bool_(False),
        "role": np.int32(0),
        "density": np.float32(1),
        "fixed": np.bool_(False),
        "active": np.bool_(True),
    }
    values |= changes
    return Figures(**{name: jnp.asarray(value)[None, ..., None] for name, value in values.items()})


TRIANGLE = np.array([[-0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [0, 0]], np.float32)


@pytest.mark.parametrize(
    ("changes", "contacts"),
    [
        ({"position": np.float32([0.9, 0])}, 2),
        ({"position": np.float32([1.1, 0])}, 0),
        ({"position": np.float32([1.15, 0]), "rotation": np.float32(math.pi / 4)}, 1),
        ({"circle": np.bool_(True), "radius": np.float32(0.5), "position": np.float32([1, 0])}, 1),
        ({"circle": np.bool_(True), "radius": np.float32(0.1)}, 1),
        (
            {
                "circle": np.bool_(True),
                "radius": np.float32(0.5),
                "position": np.float32([0.9, 0.9]),
            },
            0,
        ),
        ({"position": np.float32([0.9, 0]), "active": np.bool_(False)}, 0),
    ],
)
def test_contacts_with_a_unit_square(changes: dict[str, Any], contacts: int) -> None:
    new, square = one(**changes), one()
    assert int(count_contacts(new, square)[0, 0]) == contacts
    assert int(count_contacts(square, new)[0, 0]) == contacts
    assert int(box_contacts(new, square)[0, 0]) == contacts
    assert int(box_contacts(square, new)[0, 0]) == contacts


def test_a_triangle_has_no_fourth_corner() -> None:
    triangle = one(vertices=TRIANGLE, vertex_count=np.int32(3))
    assert int(count_contacts(one(position=np.float32([0.6, 0.6])), triangle)[0, 0]) == 0
    assert int(count_contacts(one(position=np.float32([-0.9, 0])), triangle)[0, 0]) == 2


def test_masses() -> None:
    square, disc = one(), one(circle=np.bool_(True), radius=np.float32(2))
    triangle = one(vertices=TRIANGLE - TRIANGLE[:3].mean(0), vertex_count=np.int32(3))
    assert float(mass(square)[0, 0]) == pytest.approx(1)
    assert float(inertia(square, "kinetix")[0, 0]) == pytest.approx(1 / 6)
    assert float(inertia(disc, "kinetix")[0, 0]) == pytest.approx(math.pi * 16 / 4, rel=1e-6)
    assert float(inertia(disc, "exact")[0, 0]) == pytest.approx(math.pi * 16 / 2, rel=1e-6)
    # A right triangle with legs a about its centroid: m·a²/9.
    assert float(mass(triangle)[0, 0]) == pytest.approx(0.5)
    assert float(inertia(triangle, "exact")[0, 0]) == pytest.approx(0.5 / 9, rel=1e-5)
    trapezoid = np.array([[1, 1], [2, 0], [-2, 0], [-1, 1]], np.float32)
    shape = one(vertices=trapezoid)
    assert np.asarray(centroid(shape, "kinetix"))[0, :, 0].tolist() == [0, 0.5]
    assert np.allclose(np.asarray(centroid(shape, "exact"))[0, :, 0], [0, 4 / 9], atol=1e-6)


@jax.jit
def _free_both(rows: Any) -> Any:
    around = surroundings(False, False, True)
    goal = surroundings(True, False, True)
    return {
        name: free_shape(shape_draws(rows), which, False, ued, size_limit(ued)).figure
        for name, which, ued in (
            ("quirks", around, QUIRKS),
            ("plain", around, PLAIN),
            ("goal_quirks", goal, QUIRKS),
            ("goal_plain", goal, PLAIN),
        )
    }


def test_q3_and_q4_free_shapes() -> None:
    rows = numbers(PER_SHAPE, 8)
    found = jax.tree.map(np.asarray, _free_both(rows))
    nearest = {}
    for name in ("quirks", "plain"):
        figure = found[name]
        x, y = np.moveaxis(figure.position, -2, 0)
        to_wall = np.minimum(np.minimum(x, 5 - x), np.minimum(y - 0.4, 5 - y))
        movable = figure.circle & ~figure.fixed  # Q4 may lower fixed ones into the floor.
        assert (to_wall - figure.radius >= -1e-5)[movable].all()
        long = np.asarray(shape_draws(rows).long) < 0.3
        nearest[name] = to_wall[movable & (figure.radius < 0.14) & long].min()
    # Q3: a small circle whose rectangle would have been long keeps away from walls and floor.
    assert nearest["quirks"] >= 0.1414
    assert nearest["plain"] < 0.1414
    sunk = {}
    for name in ("goal_quirks", "goal_plain"):
        figure = found[name]
        disc = figure.circle & figure.fixed
        sunk[name] = (figure.position[..., 1, :] < 0.4 + figure.radius - 1e-6)[disc].mean()
        assert (figure.role == 1).all()
    assert sunk["goal_quirks"] > 0.02
    assert sunk["goal_plain"] == 0


def test_fixed_shapes_follow_their_mass() -> None:
    figure = jax.tree.map(np.asarray, _free_both(numbers(PER_SHAPE, 8, seed=2))["quirks"])
    chance = np.minimum(1, 0.02 + 4 * np.asarray(mass(figure)))
    assert abs(figure.fixed.mean() - chance.mean()) < 5 * math.sqrt(0.25 / figure.fixed.size)
    assert figure.fixed[chance >= 1].all()


def one_jointed_pair() -> Any:
    """Two rectangles that are jointed twice over, and a free circle, in every world."""
    draft = empty_draft(WORLDS, Capacity(polygons=8, circles=2, joints=4, thrusters=1))
    half = jnp.array([[0.3, 0.2], [0.3, -0.2], [-0.3, -0.2], [-0.3, 0.2]])[..., None]
    figures = draft.figures
    return dataclasses.replace(
        figures,
        vertices=figures.vertices.at[4].set(half).at[5].set(half),
        active=figures.active.at[4].set(True).at[5].set(True),
        position=figures.position.at[4].set(2.0).at[5].set(3.0),
        rotation=figures.rotation.at[4].set(0.4),
    )


def connected(figures: Figures, counts: Any, ued: UEDParams, *, row: int = 6) -> Proposals:
    yes = jnp.ones((WORLDS,), bool)
    around = look_around(figures, polygon_room=yes, circle_room=yes, joint_room=yes)
    draw = jax.jit(
        lambda rows: connected_shape(
            shape_draws(rows), figures, counts, around, ued, size_limit(ued), new_polygon_row=row
        )
    )
    return jax.tree.map(np.asarray, draw(numbers(PER_SHAPE, 2)))


def test_q5_the_arena_as_a_partner() -> None:
    figures = one_jointed_pair()
    taken = jnp.zeros((10, WORLDS), jnp.int32).at[4].set(2).at[5].set(2)
    quirky = connected(figures, taken, QUIRKS)
    assert quirky.joint.all()
    assert set(np.unique(quirky.target)) == {0, 1, 2, 3, 4, 5}
    assert not connected(figures, taken, PLAIN).joint.any()


def test_targets_with_free_ends_are_preferred() -> None:
    figures = one_jointed_pair()
    counts = jnp.zeros((10, WORLDS), jnp.int32).at[4].set(1)
    found = connected(figures, counts, QUIRKS)
    assert abs((found.target == 4).mean() - 1 / 3) < 0.03
    fixed = dataclasses.replace(figures, fixed=figures.fixed.at[5].set(True))
    found = connected(fixed, counts, QUIRKS)
    assert abs((found.target == 5).mean() - 0.05 / 0.55) < 0.03


def test_q8_the_swapped_anchors() -> None:
    figures = one_jointed_pair()
    counts = jnp.zeros((10, WORLDS), jnp.int32)
    quirky, plain = connected(figures, counts, QUIRKS), connected(figures, counts, PLAIN)
    assert (quirky.target_first == plain.target_first).all()
    assert (quirky.valid != plain.valid)[quirky.target_first].any()
    first = connected(figures, counts, QUIRKS, row=4), connected(figures, counts, PLAIN, row=4)
    own = ~first[0].target_first
    assert own.any()
    assert (first[0].valid == first[1].valid)[own].all()


def chosen_pair() -> Proposals:
    figures = one_jointed_pair()
    proposals = connected(figures, jnp.zeros((10, WORLDS), jnp.int32), PLAIN)
    return jax.tree.map(lambda leaf: jnp.asarray(leaf[0]), proposals)


def test_q1_q6_q7_the_joint() -> None:
    proposal = chosen_pair()
    draws = joint_draws(numbers(PER_JOINT, seed=5))

    @jax.jit
    def joints(proposal: Proposals) -> Any:
        enough, none = jnp.full((WORLDS,), 2), jnp.zeros((WORLDS,), jnp.int32)
        return {
            (ued.kinetix_quirks, force, few): joint_of(
                proposal,
                6,
                draws,
                force_rjoint=force,
                revolute_count=none if few else enough,
                ued=ued,
            )
            for ued in (QUIRKS, PLAIN)
            for force in (False, True)
            for few in (False, True)
        }

    made = jax.tree.map(np.asarray, joints(proposal))
    found = {key: joint for key, (joint, _) in made.items()}
    assert not found[True, False, True].fixed.any()
    assert not found[True, True, False].fixed.any()
    assert abs(found[True, False, False].fixed.mean() - 0.5) < 0.04
    assert abs(found[False, False, False].fixed.mean() - 0.1) < 0.03
    assert abs(found[True, True, True].motor_on.mean() - 0.8) < 0.04
    assert found[False, True, True].motor_on.all()
    mixed = found[True, False, False]
    assert not mixed.reference_angle[~mixed.fixed].any()
    plain = found[False, False, False]
    turn = np.where(
        proposal.target_first,
        proposal.figure.rotation - proposal.target_rotation,
        proposal.target_rotation - proposal.figure.rotation,
    )
    assert np.allclose(plain.reference_angle, turn, atol=1e-6)
    assert not mixed.motor_power[mixed.fixed].any()
    round_one = np.asarray(proposal.figure.circle) & ~mixed.fixed
    assert (mixed.motor_power[round_one] == 1).all()
    assert not mixed.limited[round_one].any()
    assert (np.asarray(mixed.body_a) < np.asarray(mixed.body_b))[~round_one].all()
    assert set(np.unique(made[True, False, False][1])) == {0, 1, 2, 3}


def test_thrusters() -> None:
    figures = one_jointed_pair()
    figures = dataclasses.replace(figures, fixed=figures.fixed.at[5].set(True))
    eligible = figures.active & ~figures.fixed
    rows = numbers(PER_THRUSTER, 2, seed=7)
    found, _ = jax.tree.map(
        np.asarray,
        jax.jit(lambda rows: thrusters_on(thruster_draws(rows), figures, eligible, QUIRKS))(rows),
    )
    assert (found.body == 4).all()
    assert found.active.all()
    acceleration = 10 * found.power / 0.24
    assert acceleration.min() >= 10
    assert acceleration.max() <= 40
    outward = np.arctan2(found.position[:, 1], found.position[:, 0])
    aligned = np.abs(np.sin(found.angle - outward)) < 1e-5
    assert abs(aligned.mean() - 0.8) < 0.03
    inward = np.cos(found.angle - outward)[aligned] < 0
    assert abs(inward.mean() - 0.5) < 0.03
    nobody = jnp.zeros_like(eligible)
    none, _ = thrusters_on(thruster_draws(rows), figures, nobody, QUIRKS)
    assert not np.asarray(none.active).any()
