"""Geometry against numbers found in other ways."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetix.level.geometry import (
    STANDARD_ARENA,
    area_centroid,
    bounds,
    circle_about_middle,
    contains,
    inside_box,
    inverse_mass,
    overlap_depth,
    polygon_fault,
    recentred,
    referenced_body,
    reverse_winding,
    shape_mass,
    signed_area,
    signed_distance,
    to_local,
    to_world,
    touches_box,
    vertex_mean,
)
from kinetix.level.model import Body, Circle, Level, Polygon
from tests.level.strategies import polygons

TRIANGLE = Polygon(vertices=((0.0, 2.0), (-1.0, -1.0), (1.0, -1.0)))
few = settings(max_examples=50, deadline=None)


def samples(polygon, n=400):
    """Centres of a fine grid of cells that lie in a polygon, and the cell's area."""
    left, bottom, right, top = bounds(Body(id=1, shape=polygon, position=(0, 0)))
    xs = left + (np.arange(n) + 0.5) * (right - left) / n
    ys = bottom + (np.arange(n) + 0.5) * (top - bottom) / n
    grid = np.stack(np.meshgrid(xs, ys), -1).reshape(-1, 2)
    inside = np.ones(len(grid), bool)
    corners = np.array(polygon.vertices)
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        d = q - p
        inside &= d[0] * (grid[:, 1] - p[1]) - d[1] * (grid[:, 0] - p[0]) >= 0
    return grid[inside], (right - left) * (top - bottom) / n**2


@few
@given(polygons())
def test_the_circle_about_the_middle_touches_an_edge_and_crosses_none(polygon):
    centre, radius = circle_about_middle(polygon)
    body = Body(id=1, shape=polygon, position=(0, 0))
    assert signed_distance(body, centre) == pytest.approx(-radius)
    assert centre == pytest.approx(area_centroid(polygon.vertices))


@settings(max_examples=10, deadline=None)
@given(polygons())
def test_area_centroid_and_inertia_agree_with_sums_over_a_grid(polygon):
    points, cell = samples(polygon)
    area = len(points) * cell
    assert signed_area(polygon.vertices) == pytest.approx(area, rel=0.02)
    assert area_centroid(polygon.vertices) == pytest.approx(points.mean(axis=0), abs=0.02)
    mass, _ = shape_mass(polygon, 3.0, "exact")
    assert mass == pytest.approx(3 * area, rel=0.02)
    body = recentred(Body(id=1, shape=polygon, position=(0, 0)), "exact")
    inertia = 3 * ((points - points.mean(axis=0)) ** 2).sum() * cell
    assert shape_mass(body.shape, 3.0, "exact")[1] == pytest.approx(inertia, rel=0.03)


def test_masses_of_circles_and_boxes():
    disc = Circle(radius=0.5)
    mass = 2 * math.pi * 0.25
    assert shape_mass(disc, 2.0, "exact") == pytest.approx((mass, mass * 0.25 / 2))
    assert shape_mass(disc, 2.0, "kinetix") == pytest.approx((mass, mass * 0.25 / 4))
    box = Polygon(vertices=((0.5, 0.25), (-0.5, 0.25), (-0.5, -0.25), (0.5, -0.25)))
    expected = (0.5, 0.5 * (1 + 0.25) / 12)
    assert shape_mass(box, 1.0, "exact") == pytest.approx(expected)
    assert shape_mass(box, 1.0, "kinetix") == pytest.approx(expected)


def test_an_equilateral_triangle_has_two_thirds_of_its_inertia_in_the_published_model():
    corners = [
        (math.cos(a), math.sin(a)) for a in (0.3, 0.3 + 2 * math.pi / 3, 0.3 + 4 * math.pi / 3)
    ]
    shape = Polygon(vertices=tuple(corners))
    exact, kinetix = (shape_mass(shape, 1.0, model) for model in ("exact", "kinetix"))
    assert kinetix[0] == exact[0]
    assert kinetix[1] == pytest.approx(exact[1] * 2 / 3, rel=1e-6)


def test_fixed_bodies_have_no_inverse_mass():
    body = Body(id=1, shape=Circle(radius=1), position=(0, 0))
    assert inverse_mass(body.replace(fixed=True), "exact") == (0, 0)
    assert inverse_mass(body, "exact")[0] == np.float32(1 / math.pi)


def test_the_winding_rule_is_its_own_inverse_and_keeps_the_first_vertex():
    corners = ((0.0, 1.0), (2.0, 3.0), (4.0, 5.0), (6.0, 7.0))
    assert reverse_winding(corners) == ((0.0, 1.0), (6.0, 7.0), (4.0, 5.0), (2.0, 3.0))
    assert reverse_winding(reverse_winding(corners)) == corners


@few
@given(polygons(), st.sampled_from(["exact", "kinetix"]), st.floats(-7, 7))
def test_recentring_moves_nothing_in_the_world(polygon, model, angle):
    body = Body(id=1, shape=polygon, position=(1, 2), angle=angle)
    better = recentred(body, model)
    centre = (area_centroid if model == "exact" else vertex_mean)(better.shape.vertices)
    assert math.hypot(*centre) < 1e-5
    for before, after in zip(body.shape.vertices, better.shape.vertices, strict=True):
        assert to_world(body, before) == pytest.approx(to_world(better, after), abs=1e-5)


def test_local_and_world_points():
    body = Body(id=1, shape=Circle(radius=1), position=(1, 2), angle=math.pi / 2)
    assert to_world(body, (1.0, 0.0)) == pytest.approx((1, 3), abs=1e-6)
    assert to_local(body, (1.0, 3.0)) == pytest.approx((1, 0), abs=1e-6)


def test_polygon_faults():
    assert polygon_fault(TRIANGLE.vertices) is None
    assert "clockwise" in polygon_fault(reverse_winding(TRIANGLE.vertices))
    assert "closer" in polygon_fault(((0, 0), (1, 0), (1, 0.0005)))
    assert "area" in polygon_fault(((0, 0), (0.005, 0), (0, 0.005)))
    assert "convex" in polygon_fault(((0, 0), (1, 0), (0.2, 0.2), (0, 1)))
    assert "convex" in polygon_fault(((0, 0), (0.5, 0), (1, 0), (0, 1)))
    assert "3 or 4" in polygon_fault(((0, 0), (1, 0)))
    assert "finite" in polygon_fault(((0, 0), (1, 0), (0, math.inf)))


def test_signed_distances():
    body = Body(id=1, shape=TRIANGLE, position=(10, 0))
    assert signed_distance(body, (10, -2)) == pytest.approx(1)
    assert signed_distance(body, (10, -0.75)) == pytest.approx(-0.25)
    assert contains(body, (10, 0))
    assert not contains(body, (11, 1))
    disc = Body(id=1, shape=Circle(radius=2), position=(0, 0))
    assert signed_distance(disc, (3, 4)) == pytest.approx(3)


def box(x, y, w=1.0, h=1.0, angle=0.0):
    corners = ((w / 2, h / 2), (-w / 2, h / 2), (-w / 2, -h / 2), (w / 2, -h / 2))
    return Body(id=1, shape=Polygon(vertices=corners), position=(x, y), angle=angle)


def disc(x, y, r=0.5):
    return Body(id=1, shape=Circle(radius=r), position=(x, y))


@pytest.mark.parametrize(
    ("a", "b", "depth"),
    [
        (box(0, 0), box(0.9, 0.2), 0.1),
        (box(0, 0), box(1, 0), 0.0),
        (box(0, 0), box(1.5, 0.2), -0.5),
        (box(0, 0), box(1.3, 1.4), -0.5),
        (box(0, 0), box(0, 1.1, angle=math.pi / 4), 0.5 + math.sqrt(0.5) - 1.1),
        (disc(0, 0), disc(0.6, 0.8), 0.0),
        (disc(0, 0), disc(0.9, 0), 0.1),
        (disc(0, 0), box(0.9, 0), 0.1),
        (disc(1, 1), box(0, 0), 0.5 - math.sqrt(0.5)),
        (disc(0, 0.1), box(0, 0), 0.9),
    ],
)
def test_overlap_depth(a, b, depth):
    assert overlap_depth(a, b) == pytest.approx(depth, abs=1e-6)
    assert overlap_depth(b, a) == pytest.approx(depth, abs=1e-6)


def test_boxes():
    assert inside_box(box(0, 0), (-0.5, -0.5, 0.5, 0.5))
    assert not inside_box(box(0, 0, angle=0.1), (-0.5, -0.5, 0.5, 0.5))
    diamond = box(0, 0, angle=math.pi / 4)
    assert touches_box(diamond, (0.3, 0.3, 1, 1))
    assert not touches_box(diamond, (0.45, 0.45, 1, 1))
    assert touches_box(disc(0, 0), (0.3, 0.3, 1, 1))
    assert not touches_box(disc(0, 0), (0.4, 0.4, 1, 1))


def test_the_arena_occupies_what_the_format_says():
    level = Level(name="x")
    expected = {
        "floor": (0, -10, 5, 0.4),
        "left_wall": (-5, 0, 0, 5),
        "right_wall": (5, 0, 10, 5),
        "ceiling": (0, 5, 5, 15.4),
    }
    for name, box_of in expected.items():
        body = referenced_body(level, name)
        assert bounds(body) == pytest.approx(box_of, abs=1e-6)
        assert body.fixed
        assert polygon_fault(STANDARD_ARENA[name].vertices) is None
    with pytest.raises(KeyError):
        referenced_body(level, 3)
