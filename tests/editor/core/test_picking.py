"""Picking against brute force, and how long it takes."""

import math
import random

import pytest

from editor.drawing.vectors import Placement, poses_of
from editor.editing.picking import (
    JOINT_RADIUS,
    THRUSTER_RADIUS,
    handles,
    inside,
    joint_position,
    stack,
)
from kinetix.level.geometry import area_centroid, signed_distance, to_world
from kinetix.level.model import Body, Circle, Joint, Level, Polygon, Thruster
from tests.editor.core.helpers import a_level
from tests.pace import share_of


def random_level(draw, count):
    bodies = []
    for k in range(count):
        if draw.random() < 0.5:
            shape = Circle(radius=draw.uniform(0.02, 0.6))
        else:
            angles = sorted(draw.uniform(0, math.tau) for _ in range(draw.choice((3, 4))))
            size = draw.uniform(0.05, 0.6)
            shape = Polygon(
                vertices=tuple((size * math.cos(a), size * math.sin(a)) for a in angles)
            )
        bodies.append(
            Body(
                id=k + 1,
                shape=shape,
                position=(draw.uniform(0, 5), draw.uniform(0, 5)),
                angle=draw.uniform(-7, 7),
            )
        )
    pairs = [draw.sample(range(1, count + 1), 2) for _ in range(count // 3)]
    point = lambda: (draw.uniform(-0.3, 0.3), draw.uniform(-0.3, 0.3))  # noqa: E731
    joints = tuple(
        Joint(id=100 + k, kind="fixed", a=a, b=b, anchor_a=point(), anchor_b=point())
        for k, (a, b) in enumerate(pairs)
    )
    thrusters = tuple(
        Thruster(id=200 + k, body=draw.randint(1, count), position=point())
        for k in range(count // 4)
    )
    return Level(name="random", bodies=tuple(bodies), joints=joints, thrusters=thrusters)


def brute_force(level, point, radius):
    """Layer by layer, straight from the definition."""
    near = []
    for joint in level.joints:
        distance = math.dist(joint_position(level, joint), point)
        if distance <= max(radius, JOINT_RADIUS):
            near.append((distance, joint.id))
    found = [entity for _, entity in sorted(near)]
    near = []
    for thruster in level.thrusters:
        distance = math.dist(to_world(level.body(thruster.body), thruster.position), point)
        if distance <= max(radius, THRUSTER_RADIUS):
            near.append((distance, thruster.id))
    found += [entity for _, entity in sorted(near)]
    for kind in (Circle, Polygon):
        for body in reversed(level.bodies):
            round_body = isinstance(body.shape, Circle)
            middle = (0, 0) if round_body else area_centroid(body.shape.vertices)
            near = math.dist(to_world(body, middle), point) <= radius
            under = signed_distance(body, point) <= 0 or near
            if isinstance(body.shape, kind) and under:
                found.append(body.id)
    return tuple(found)


def test_picking_agrees_with_brute_force_on_a_thousand_scenes():
    draw = random.Random(7)
    hits = 0
    for _ in range(1000):
        level = random_level(draw, draw.randint(2, 12))
        x, y = draw.choice(level.bodies).position
        point = (x + draw.gauss(0, 0.3), y + draw.gauss(0, 0.3))
        radius = draw.choice((0.004, 0.08, 0.4))
        picked = stack(level, point, radius)
        assert picked == brute_force(level, point, radius)
        hits += bool(picked)
    assert hits > 400


def test_small_things_can_be_picked_at_any_zoom():
    level = Level(name="x", bodies=(Body(id=1, shape=Circle(radius=0.02), position=(2, 2)),))
    assert stack(level, (2.07, 2.0), 0.08) == (1,)
    assert stack(level, (2.07, 2.0), 0.008) == ()


def test_a_body_is_picked_by_its_middle_not_by_the_origin_of_its_frame():
    far = Polygon(vertices=((1.01, 0.01), (0.99, 0.01), (0.99, -0.01), (1.01, -0.01)))
    level = Level(name="x", bodies=(Body(id=1, shape=far, position=(2, 2), fixed=True),))
    assert stack(level, (2.0, 2.0), 0.08) == ()
    assert stack(level, (3.05, 2.0), 0.08) == (1,)


def test_what_is_locked_or_hidden_is_passed_over():
    assert stack(a_level(), (4.0, 3.0), 0.08, without={3}) == ()


def test_the_arena_lies_below_everything():
    level = a_level()
    low = level.bodies[2].replace(position=(2.5, 0.3))
    level = level.replace(bodies=(*level.bodies[:2], low, level.bodies[3]))
    assert stack(level, (2.5, 0.3), 0.08, arena=True) == (3, "floor")


def test_a_joint_whose_body_is_gone_is_passed_over():
    level = a_level().replace(bodies=a_level().bodies[1:])
    assert stack(level, (2.2, 2.0), 0.08) == (2,)
    assert inside(level, (0, 0, 5, 5), touching=False) == (2, 3, 4)


def test_an_open_joint_is_where_the_renderer_draws_it():
    small, large = (Body(id=k, shape=Circle(radius=0.1 * k), position=(k, 2.0)) for k in (1, 2))
    joint = Joint(id=3, kind="fixed", a=1, b=2, anchor_a=(0.1, 0.0), anchor_b=(-0.1, 0.0))
    level = Level(name="x", bodies=(small, large), joints=(joint,))
    # Of the masses 1 and 4 the lighter one counts four times: 1.1 + 0.8 / 5.
    assert joint_position(level, joint) == pytest.approx((1.26, 2.0))
    drawn = Placement(level=level, poses=poses_of(level)).joint_point(joint)
    assert drawn == pytest.approx((1.26, 2.0))


def test_handles_have_no_place_without_bodies():
    assert handles(a_level(), (5,), 0.01) == ()
    assert handles(a_level(), (), 0.01) == ()
    assert len(handles(a_level(), (6,), 0.01)) == 1


def test_picking_among_fifty_is_fast():
    level = random_level(random.Random(1), 30)
    assert sum(1 for _ in level.entities()) >= 45

    def pick():
        for k in range(100):
            stack(level, (0.05 * k, 2.5), 0.08)

    # The target is 0.3 ms together with snapping; shared machines get twice that.
    assert share_of(100 * 0.6e-3, pick) <= 1
