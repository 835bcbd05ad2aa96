"""N1 and N2 as tables: what a dragged point or body is drawn to."""

import math
import random

import pytest

from editor.editing.snapping import (
    Rules,
    Snapped,
    features,
    snap_angle,
    snap_point,
    snap_shift,
    targets,
)
from kinetix.level.model import Body, Circle, Level, Polygon

BOX = Polygon(vertices=((0.5, 0.3), (-0.5, 0.3), (-0.5, -0.3), (0.5, -0.3)))
SMART = Rules(smart=True, grid=None, catch=0.08, release=0.12)
GRID = Rules(smart=False, grid=0.25, catch=0.08, release=0.12)


def level(*bodies):
    return Level(name="x", bodies=bodies)


RESTING = level(
    Body(id=1, shape=BOX, position=(2.0, 3.0)),
    Body(id=2, shape=Circle(radius=0.4), position=(4.0, 1.5)),
)


@pytest.mark.parametrize(
    ("what", "point", "expected"),
    [
        ("centre of a box", (2.03, 2.96), (2.0, 3.0)),
        ("vertex", (2.55, 3.35), (2.5, 3.3)),
        ("middle of an edge", (2.03, 3.26), (2.0, 3.3)),
        ("quadrant of a circle", (4.37, 1.53), (4.4, 1.5)),
        ("x of a vertex alone", (1.46, 0.9), (1.5, 0.9)),
        ("floor", (0.7, 0.45), (0.7, 0.4)),
        ("left wall", (0.05, 0.9), (0.0, 0.9)),
        ("ceiling", (3.2, 4.93), (3.2, 5.0)),
        ("nothing near", (3.2, 2.2), (3.2, 2.2)),
    ],
)
def test_points_snap(what, point, expected):
    snapped = snap_point(point, SMART, targets(RESTING))
    assert snapped.point == pytest.approx(expected, abs=1e-6), what


def test_a_slanted_edge_catches_points():
    slanted = level(Body(id=1, shape=BOX, position=(1.3, 1.7), angle=0.5))
    corners = features(slanted.bodies[0])[1:5]
    (x0, y0), (x1, y1) = corners[0], corners[1]
    share = 0.25
    on = (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
    length = math.dist(corners[0], corners[1])
    normal = ((y1 - y0) / length, -(x1 - x0) / length)
    off = (on[0] + 0.02 * normal[0], on[1] + 0.02 * normal[1])
    near = Rules(smart=True, grid=None, catch=0.03, release=0.04)
    assert snap_point(off, near, targets(slanted)).point == pytest.approx(on, abs=1e-6)


@pytest.mark.parametrize(
    ("what", "shift", "expected"),
    [
        ("bottom edge onto the floor", (0.15, -1.13), (0.15, -1.1)),
        ("left edge to the right edge of the box", (1.73, 0.6), (1.7, 0.6)),
        ("centre over centre", (1.03, 0.7), (1.0, 0.7)),
        ("top edge flush with the top of the box", (0.4, 1.55), (0.4, 1.6)),
    ],
)
def test_bodies_snap_with_edges_and_centre(what, shift, expected):
    moving = Body(
        id=9,
        shape=Polygon(vertices=((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))),
        position=(1.0, 1.7),
    )
    # The circle's own lines lie elsewhere, the box's are those of the table.
    alone = level(RESTING.bodies[0])
    snapped = snap_shift([moving], shift, SMART, targets(alone))
    assert snapped.point == pytest.approx(expected, abs=1e-5), what


def test_equal_gaps_catch():
    small = Polygon(vertices=((0.1, 0.37), (-0.1, 0.37), (-0.1, -0.37), (0.1, -0.37)))
    row = level(
        Body(id=1, shape=small, position=(0.7, 2.03)),
        Body(id=2, shape=small, position=(1.41, 2.03)),
    )
    moving = Body(id=9, shape=Circle(radius=0.1), position=(3.0, 2.1))
    snapped = snap_shift([moving], (-0.83, 0.0), SMART, targets(row))
    assert 3.0 + snapped.point[0] == pytest.approx(2.12, abs=1e-5)


def test_the_grid_takes_the_centre():
    moving = Body(id=9, shape=Circle(radius=0.13), position=(1.0, 1.0))
    snapped = snap_shift([moving], (0.3, 0.11), GRID, targets(RESTING))
    assert snapped.point == pytest.approx((0.25, 0.11), abs=1e-6)


def test_smart_goes_before_the_grid():
    both = Rules(smart=True, grid=0.25, catch=0.08, release=0.12)
    snapped = snap_point((2.46, 0.76), both, targets(RESTING))
    assert snapped.point == pytest.approx((2.5, 0.75), abs=1e-6)


def test_a_snap_holds_longer_than_it_catches():
    available = targets(RESTING)
    caught = snap_point((1.95, 0.9), SMART, available)
    assert caught.held_x == pytest.approx(2.0)
    held = snap_point((1.9, 0.9), SMART, available, caught)
    assert held.point[0] == pytest.approx(2.0)
    assert snap_point((1.9, 0.9), SMART, available).point[0] == pytest.approx(1.9)
    assert snap_point((1.87, 0.9), SMART, available, held).point[0] == pytest.approx(1.87)


def test_guides_lead_from_the_target_to_the_point():
    snapped = snap_point((2.03, 0.9), SMART, targets(RESTING))
    (guide,) = snapped.guides
    assert guide.a[0] == pytest.approx(2.0)
    assert guide.b == pytest.approx((2.0, 0.9))


def test_moving_bodies_are_no_targets():
    assert targets(RESTING, {1, 2}).boxes == ()


def test_nothing_is_ever_moved_further_than_the_threshold():
    draw = random.Random(3)
    rules = Rules(smart=True, grid=0.1, catch=0.08, release=0.12)
    for _ in range(300):
        bodies = [
            Body(
                id=k,
                shape=draw.choice((BOX, Circle(radius=0.2))),
                position=(draw.uniform(0, 5), draw.uniform(0, 5)),
                angle=draw.uniform(-3, 3),
            )
            for k in range(1, 5)
        ]
        available = targets(level(*bodies[1:]))
        previous = None
        for _ in range(3):
            shift = (draw.uniform(-1, 1), draw.uniform(-1, 1))
            previous = snap_shift(bodies[:1], shift, rules, available, previous)
            for wanted, got in zip(shift, previous.point, strict=True):
                assert abs(wanted - got) <= rules.release + 1e-6


def test_no_rule_no_snap():
    off = Rules(smart=False, grid=None, catch=0.08, release=0.12)
    assert snap_point((2.01, 3.01), off, targets(RESTING)) == Snapped(point=(2.01, 3.01))


@pytest.mark.parametrize(
    ("degrees", "expected"), [(7.4, 0), (7.6, 15), (-52, -45), (181, 180), (44.9, 45)]
)
def test_angles_snap(degrees, expected):
    snapped = snap_angle(math.radians(degrees), math.radians(15))
    assert math.degrees(snapped) == pytest.approx(expected, abs=1e-9)


def test_equal_gaps_are_shown_with_their_width():
    from editor.editing.snapping import measured

    def ball(number, x):
        return Body(id=number, shape=Circle(radius=0.2), position=(x, 2.2))

    moving = ball(3, 2.13)
    available = targets(level(ball(1, 0.8), ball(2, 3.6)))
    rules = Rules(smart=True, grid=None, catch=0.08, release=0.12)
    snapped = snap_shift((moving,), (0.03, 0.0), rules, available)
    assert snapped.point[0] == pytest.approx(0.07, abs=1e-6)
    gaps = [guide for guide in snapped.guides if guide.arrow]
    widths = [math.dist(gap.a, gap.b) for gap in gaps]
    assert widths == pytest.approx([1.0, 1.0], abs=1e-5)
    assert "1.00 m" in [getattr(mark, "text", "") for mark in measured(snapped.guides)]
