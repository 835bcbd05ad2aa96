"""Levels made in Python that no file could hold: `validate` tells, and nothing crashes."""

import numpy as np
import pytest

from kinetix.errors import LevelError
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import check_level, dumps, loads
from kinetix.level.model import Geometry, Motor, Solution
from kinetix.level.validate import validate


def two_bodies():
    builder = LevelBuilder("Two")
    first = builder.circle(1.0, 2.0, 0.2, role="green")
    builder.circle(3.0, 2.0, 0.2, role="blue")
    builder.hinge(builder.floor, first, (1.0, 2.0))
    builder.thruster(first, (1.0, 2.0), angle=0.0, power=1.0)
    return builder.build()


def with_body(**changes):
    level = two_bodies()
    return level.replace(bodies=(level.bodies[0].replace(**changes), *level.bodies[1:]))


def with_floor(**changes):
    level = two_bodies()
    return level.replace(arena=level.arena.replace(floor=level.arena.floor.replace(**changes)))


def faults(level):
    return [issue.path for issue in validate(level) if issue.code == "E106"]


@pytest.mark.parametrize(
    ("level", "path"),
    [
        (with_body(role="purple"), "$.bodies[0].role"),
        (with_floor(role="pink"), "$.arena.floor.role"),
        (two_bodies().replace(size="xl"), "$.size"),
    ],
)
def test_words_that_do_not_exist_are_told(level, path):
    assert faults(level) == [path]


@pytest.mark.parametrize("level", [with_body(role="purple"), with_floor(collision="soft")])
def test_words_that_do_not_exist_are_refused_in_kinetix_envs_format(level):
    with pytest.raises(LevelError, match=r"'(purple|soft)': expected "):
        dumps(level, format="kinetix-env")


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"next_id": 3}, "$.joints[0].id"),
        ({"tags": ("a", "b", "a")}, "$.tags[2]"),
        (
            {
                "solution": Solution(
                    physics="balanced",
                    frame_skip=2,
                    actions=((100_000, (0,) * 6), (1, (0,) * 6)),
                )
            },
            "$.solution.actions",
        ),
    ],
)
def test_what_the_reader_refuses_of_a_whole_level_is_told(changes, path):
    level = two_bodies().replace(**changes)
    assert path in faults(level)
    with pytest.raises(LevelError):
        check_level(level, "level")


def test_an_id_that_stands_twice_is_told():
    level = two_bodies()
    assert faults(with_body(id=level.bodies[1].id))[0] == "$.bodies[1].id"


def test_ids_that_are_no_numbers_do_not_crash():
    assert "$.bodies[0].id" in faults(with_body(id="one"))


@pytest.mark.parametrize("binding", [True, 1.0])
def test_a_binding_is_a_whole_number(binding):
    builder = LevelBuilder("One")
    body = builder.circle(1.0, 2.0, 0.2)
    with pytest.raises(LevelError, match="binding"):
        builder.thruster(body, (1.0, 2.0), angle=0.0, power=1.0, binding=binding)
    with pytest.raises(LevelError, match="binding"):
        builder.hinge(builder.floor, body, (1.0, 2.0), motor=Motor(binding=binding))


SLAB = ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))


def far_parts():
    level = two_bodies()
    (joint,), (thruster,) = level.joints, level.thrusters
    wide = tuple((x * 1e20, y) for x, y in SLAB)
    yield level.replace(thrusters=(thruster.replace(position=(3e38, 3e38)),))
    yield level.replace(thrusters=(thruster.replace(angle=1e38),))
    yield level.replace(joints=(joint.replace(anchor_a=(1e20, 0.0)),))
    yield level.replace(joints=(joint.replace(kind="fixed", reference_angle=1e38),))
    yield with_floor(geometry=Geometry(position=(0.0, 1e30), vertices=SLAB))
    yield with_floor(geometry=Geometry(position=(0.0, 0.0), vertices=wide))
    yield with_body(angle=-1e38)


@pytest.mark.parametrize("level", list(far_parts()))
def test_lengths_and_angles_that_nothing_can_be_computed_of_are_refused(level):
    assert [issue.code for issue in validate(level)].count("E106") >= 1
    with pytest.raises(LevelError, match="expected -1"):
        check_level(level, "level")


def test_anchors_of_a_joint_that_has_no_effect_are_not_said_to_be_pulled():
    level = two_bodies()
    (joint,) = level.joints
    apart = joint.replace(a="floor", b="left_wall", anchor_a=(1.0, 1.0))
    codes = {issue.code for issue in validate(level.replace(joints=(apart,)))}
    assert "W207" in codes and "W209" not in codes


def test_bindings_may_be_numbers_of_numpy():
    builder = LevelBuilder("Drawn")
    body = builder.circle(1.0, 2.0, 0.5)
    one = np.int64(1)
    builder.thruster(body, (1.0, 2.0), angle=0.0, power=1.0, binding=one)
    builder.hinge(builder.floor, body, (1.0, 2.0), motor=Motor(binding=one))
    assert loads(dumps(builder.build())).thrusters[0].binding == 1
