"""Faces that bodies meet, and room for contacts, against plane geometry."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.collision import circle_circle, circle_polygon, polygon_polygon
from kinetix.engine.collision.compact import compact
from kinetix.engine.collision.moving import (
    MovingCircle,
    MovingPolygon,
    carried,
    meeting,
    round_meeting,
    steady,
)
from kinetix.engine.maths import Vec
from kinetix.engine.pairs import may_push, pair_counts
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.spec import Capacity, SceneSpec
from kinetix.engine.store import Store
from kinetix.level.geometry import overlap_depth, world_vertices
from kinetix.level.model import Body, Polygon

DT = jnp.asarray([1 / 60])
STORE = Store.beside(DT)


def one(value: float) -> jnp.ndarray:
    return jnp.full((1, 1), value, jnp.float32)


def at(x: float, y: float) -> Vec:
    return Vec(x=one(x), y=one(y))


def box(centre, velocity=(0.0, 0.0), size=(1.0, 1.0), spin=0.0) -> MovingPolygon:
    w, h = size[0] / 2, size[1] / 2
    return polygon([(-w, -h), (-w, h), (w, h), (w, -h)], centre, velocity, spin)


def polygon(clockwise, centre, velocity=(0.0, 0.0), spin=0.0) -> MovingPolygon:
    corners = np.array(clockwise, np.float32)
    edge = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([-edge[:, 1], edge[:, 0]], 1) / np.hypot(*edge.T)[:, None]

    def columns(values: np.ndarray) -> Vec:
        return Vec(x=jnp.asarray(values[None, :, 0, None]), y=jnp.asarray(values[None, :, 1, None]))

    return MovingPolygon(
        centre=at(*centre),
        velocity=at(*velocity),
        corners=columns(corners),
        normals=columns(normals),
        offsets=jnp.asarray((normals * corners).sum(1)[None, :, None]),
        spin=one(spin),
    )


def disc(centre, radius, velocity=(0.0, 0.0)) -> MovingCircle:
    return MovingCircle(centre=at(*centre), velocity=at(*velocity), radius=one(radius))


@functools.partial(jax.jit, static_argnums=0)
def points(kernels, a, b):
    coming = kernels.approach(a, b, DT)
    return kernels.points(a, b, coming, one(10.0), DT, STORE)


def contacts(kernels, a, b):
    """(normal of a contact, gap) of the points that exist."""
    return [
        ((float(s.normal.x[0, 0]), float(s.normal.y[0, 0])), float(s.separation[0, 0]))
        for s in points(kernels, a, b)
        if s.exists[0, 0]
    ]


def closing(normal, velocity_a, velocity_b=(0.0, 0.0)) -> float:
    """Return the speed at which b and a approach along a normal from a to b."""
    return -sum(n * (vb - va) for n, va, vb in zip(normal, velocity_a, velocity_b, strict=True))


@pytest.mark.parametrize("speed", [0.5, 5.0, 60.0])
@pytest.mark.parametrize("ahead", [0.0005, 0.2, 0.6])
@pytest.mark.parametrize("lower", [-0.0004, 0.0, 0.002])
def test_the_side_of_a_flush_neighbour_stops_nothing(speed, ahead, lower):
    """A box or disc that slides over a floor towards the next tile, flush or a little lower."""
    tile = box((1 + ahead, -0.5 - lower))
    for a, kernels in (
        (box((0.3, 0.2), (speed, 0), (0.4, 0.4)), polygon_polygon),
        (disc((0.3, 0.2), 0.2, (speed, 0)), circle_polygon),
    ):
        for normal, gap in contacts(kernels, a, tile):
            approach = closing(normal, (speed, 0.0))
            assert approach * DT[0] <= max(gap, 0) + 1e-6, (normal, gap)


def test_corners_that_meet_along_a_face_push_nothing():
    """A box on loose tiles, a hair's breadth above them, comes to the edge of the next one."""
    for above in (0.0, 1e-6, 1e-4):
        tile, a = (
            box((0.65, -0.1), size=(0.25, 0.2)),
            box((0.3667, 0.15 + above), (1.0, 0.0), (0.3, 0.3)),
        )
        for normal, gap in contacts(polygon_polygon, tile, a):
            assert closing(normal, (0, 0), (1.0, 0.0)) * DT[0] <= max(gap, 0) + 1e-6, normal


@pytest.mark.parametrize("speed", [5.0, 60.0])
def test_a_step_of_five_centimetres_stops(speed):
    distance = 0.2 * speed / 60
    tile = box((0.5 + 0.2 + distance, -0.5 + 0.05))
    for a, kernels in (
        (box((0, 0.2), (speed, 0), (0.4, 0.4)), polygon_polygon),
        (disc((0.1, 0.2), 0.2, (speed, 0)), circle_polygon),
    ):
        found = contacts(kernels, a, tile)
        assert any(closing(normal, (speed, 0.0)) * DT[0] > gap for normal, gap in found)


def bodies_of(centre, angle, size, rng):
    """Return a random triangle or quadrilateral for the kernels, and as a body of a level."""
    turns = np.sort(rng.uniform(0, 0.5, 4) + np.arange(4) * 0.5)[: rng.integers(3, 5)] * np.pi
    corners = size * np.stack([np.cos(turns + angle), np.sin(turns + angle) * 0.2], 1)
    corners -= corners.mean(0)
    shape = Polygon(vertices=tuple(map(tuple, corners.tolist())))
    body = Body(id=1, shape=shape, position=tuple(centre))
    return polygon(corners[::-1], centre), body


def test_the_separation_is_the_distance():
    """Also of sharp corners that point at each other, which no face's normal measures."""
    rng, nearest_at_corners = np.random.default_rng(0), 0
    approach = jax.jit(polygon_polygon.approach)
    for _ in range(300):
        a, body_a = bodies_of(rng.normal(size=2), rng.uniform(0, 6), rng.uniform(0.1, 1), rng)
        b, body_b = bodies_of(rng.normal(size=2) * 2, rng.uniform(0, 6), rng.uniform(0.1, 1), rng)
        distance = -overlap_depth(body_a, body_b)
        found = float(approach(a, b, DT).separation[0, 0])
        assert found == pytest.approx(distance, abs=1e-5)
        corners = [math.dist(p, q) for p in world_vertices(body_a) for q in world_vertices(body_b)]
        nearest_at_corners += min(corners) == pytest.approx(distance, abs=1e-6)
    assert nearest_at_corners > 50


def test_a_fast_body_is_seen_by_a_thin_wall_that_it_would_cross_in_one_step():
    wall = box((1.0, 0.0), size=(0.05, 2.0))
    for a, kernels in (
        (disc((0.0, 0.0), 0.02, (100.0, 0.0)), circle_polygon),
        (box((0.0, 0.0), (100.0, 0.0), (0.04, 0.04)), polygon_polygon),
    ):
        (first, *_) = contacts(kernels, a, wall)
        assert first[0] == pytest.approx((1.0, 0.0))
        assert first[1] == pytest.approx(1 - 0.025 - 0.02, abs=1e-4)


@pytest.mark.parametrize("kernels", [circle_polygon, polygon_polygon])
def test_who_passes_a_corner_in_a_straight_line_is_not_stopped(kernels):
    """Below the corner of a block at the start, beyond its side at the end of the step."""
    velocity = (40.0, 40.0)
    block = box((1.0, -0.5))
    start = (0.25, -0.12)
    a = (
        disc(start, 0.05, velocity)
        if kernels is circle_polygon
        else box(start, velocity, (0.1, 0.1))
    )
    for normal, gap in contacts(kernels, a, block):
        assert gap >= -1e-6
        assert closing(normal, velocity) * DT[0] <= gap + 1e-5


def test_discs_that_will_pass_each_other_do_not_push():
    velocity = (60.0, 0.0)
    a, b = disc((0, 0), 0.1, velocity), disc((0.5, 0.201), 0.1)
    ((normal, gap),) = contacts(circle_circle, a, b)
    assert closing(normal, velocity) * DT[0] <= gap + 1e-5


def test_the_normal_is_that_of_the_impact():
    """Impact parameter of half the sum of the radii: 30 degrees off the path."""
    normal, gap = round_meeting(at(1.0, 0.1), at(-60.0, 0.0), one(0.2), DT)
    assert float(normal.y[0, 0]) == pytest.approx(0.5, abs=1e-5)
    reached = float(gap[0, 0]) / (60 * float(normal.x[0, 0]))
    assert 1 - 60 * reached == pytest.approx(0.2 * np.cos(np.pi / 6), abs=1e-4)


def test_the_last_gap_that_closes_is_the_face_that_is_hit():
    gaps, closings = [one(0.1), one(0.5), one(-0.3)], [one(50.0), one(50.0), one(0.0)]
    time, face, meets = meeting(gaps, closings, DT)
    assert float(time[0, 0]) == pytest.approx(0.01) and int(face[0, 0]) == 1 and meets[0, 0]


def test_a_whirling_body_is_pushed_through_its_centre():
    arm, normal = at(0.3, 0.4), at(0.0, 1.0)
    calm, whirling = (steady(arm, normal, one(spin), DT) for spin in (30.0, 500.0))
    np.testing.assert_allclose([calm.x[0, 0], calm.y[0, 0]], [0.3, 0.4], rtol=1e-6)
    np.testing.assert_allclose([whirling.x[0, 0], whirling.y[0, 0]], [0.0, 0.4], atol=1e-7)


@pytest.mark.parametrize("spin", [30.0, -12.0])
def test_a_turning_corner_is_taken_where_it_is_in_the_middle_of_the_step(spin):
    turned = carried(at(0.3, 0.4), one(spin), DT[None] / 2)
    angle = spin * float(DT[0]) / 2
    cos, sin = np.cos(angle), np.sin(angle)
    expected = [0.3 * cos - 0.4 * sin, 0.4 * cos + 0.3 * sin]
    np.testing.assert_allclose([turned.x[0, 0], turned.y[0, 0]], expected, atol=1e-3)


@pytest.mark.parametrize(("size", "points"), [((5, 2), 12), ((6, 3), 21), ((12, 4), 60)])
def test_there_is_room_for_every_edge_of_a_planar_graph(size, points):
    capacity = Capacity(polygons=size[0], circles=size[1], joints=0, thrusters=0)
    room = usual_room(SceneSpec(capacity=capacity))
    assert room.points == points
    assert (room.polygon_polygon, room.circle_polygon, room.circle_circle) == pair_counts(capacity)


def test_compact_keeps_the_order_and_knows_what_is_used():
    mask = jnp.asarray([[1, 0], [0, 0], [1, 1], [1, 0]], bool)
    index, valid = compact(mask, 3)
    assert index[valid[:, 0], 0].tolist() == [0, 2, 3]
    assert index[valid[:, 1], 1].tolist() == [2]


def test_collision_modes_are_one_rule():
    table = [[bool(may_push(a, b)) for b in range(3)] for a in range(3)]
    assert table == [[False, False, True], [False, True, True], [True, True, True]]
