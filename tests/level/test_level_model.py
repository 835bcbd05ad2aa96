"""The model: rounding, defaults, metadata."""

import math

import pytest

from kinetix.level.model import (
    Body,
    Circle,
    Joint,
    Level,
    Limits,
    Motor,
    Polygon,
    Solution,
    round_real,
)


def test_reals_are_binary32_on_construction_and_on_replace():
    body = Body(id=1, shape=Circle(radius=0.3), position=(0.1, 2))
    assert body.shape.radius == round_real(0.3) != 0.3
    assert body.position == (round_real(0.1), 2.0)
    assert body.replace(angle=0.7).angle == round_real(0.7)


def test_minus_zero_becomes_zero_and_lists_become_tuples():
    body = Body(id=1, shape=Polygon(vertices=[[1, 0], [0, 1], [-1, -0.0]]), position=[-0.0, 0])
    assert math.copysign(1, body.position[0]) == 1
    assert body.shape.vertices == ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0))
    assert isinstance(hash(body), int)


def test_values_beyond_binary32_become_infinite_and_nan_stays():
    assert round_real(1e39) == math.inf
    assert round_real(-1e39) == -math.inf
    assert math.isnan(round_real(math.nan))


def test_next_id_follows_the_largest_id():
    level = Level(name="x", bodies=(Body(id=7, shape=Circle(radius=1), position=(0, 0)),))
    assert level.next_id == 8
    assert level.replace(bodies=()).next_id == 8
    assert Level(name="x").next_id == 1


def test_entities_are_found_by_id():
    joint = Joint(id=3, kind="fixed", a="floor", b=1, anchor_a=(0, 0), anchor_b=(0, 0))
    body = Body(id=1, shape=Circle(radius=1), position=(0, 0))
    level = Level(name="x", bodies=(body,), joints=(joint,))
    assert level.entity(3) is level.joints[0]
    assert level.body(1) is level.bodies[0]
    with pytest.raises(KeyError):
        level.body(3)
    with pytest.raises(KeyError):
        level.entity(2)


def test_a_solution_unrolls():
    solution = Solution(
        physics="balanced", frame_skip=2, actions=[[2, [1, 0, 0, 0, 0, 1]], [1, [0] * 6]]
    )
    assert list(solution.unrolled()) == [(1, 0, 0, 0, 0, 1)] * 2 + [(0,) * 6]


def test_levels_are_frozen():
    with pytest.raises(AttributeError):
        Level(name="x").name = "y"


def test_null_motor_and_limits_mean_off():
    assert Motor(on=False) == Motor(on=False, speed=1, power=1, binding=0, auto=False)
    assert Limits(on=False) == Limits(on=False, min=0, max=0)
