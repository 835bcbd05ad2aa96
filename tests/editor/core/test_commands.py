"""Commands that the tools' tests do not reach: fields, mirror, order, clipboard, removal."""

import json
import math

import numpy as np
import pytest

from editor.base.arithmetic import Change
from editor.documents.commands import clip
from editor.documents.commands.fields import (
    AdjustField,
    PasteProperties,
    ResetFields,
    SetField,
    SetLevelField,
    read_field,
    shared_value,
)
from editor.documents.commands.group import (
    Mirror,
    Move,
    MoveEach,
    Remove,
    Reorder,
    Rotate,
    Scale,
    SetVertices,
    polygon_body,
)
from editor.documents.commands.joints import (
    AddJoint,
    MoveJoint,
    Reanchor,
    ReassignJoint,
    RehangJoint,
)
from editor.documents.commands.level import Permute
from editor.documents.commands.rigid import with_parts
from editor.documents.commands.sizes import ResetCorners
from editor.editing.tools.rectangle import rectangle
from kinetix.errors import CommandError
from kinetix.level.geometry import (
    polygon_fault,
    referenced_body,
    relative_angle,
    to_local,
    to_world,
    world_vertices,
)
from kinetix.level.model import (
    MAX_NAME,
    Body,
    Circle,
    Joint,
    Level,
    Limits,
    Motor,
    Polygon,
    Thruster,
)
from kinetix.level.validate import validate
from tests.editor.core.helpers import a_level, gap

KITE = Polygon(vertices=((0.5, 0.0), (0.0, 0.2), (-0.5, 0.0), (0.0, -0.2)))


@pytest.mark.parametrize(
    ("ids", "field", "value"),
    [
        ((3,), "density", 2.0),
        ((3, 4), "shape.radius", 0.5),
        ((3,), "position.x", 1.5),
        ((3,), "position", (1.5, 2.5)),
        ((3,), "velocity.y", -3.0),
        ((3,), "role", "red"),
        ((5,), "motor.speed", 2.5),
        ((5,), "motor.on", False),
        ((5,), "limits.min", -0.5),
        ((5,), "kind", "fixed"),
        ((6,), "power", 3.0),
        ((6,), "binding", 1),
        (("floor",), "role", "red"),
        (("left_wall",), "friction", 0.25),
    ],
)
def test_fields_are_set_by_their_dotted_names(ids, field, value):
    level = SetField(ids=ids, field=field, value=value).apply(a_level())
    for entity_id in ids:
        owner = (
            getattr(level.arena, entity_id)
            if isinstance(entity_id, str)
            else level.entity(entity_id)
        )
        expected = value if isinstance(value, str) else pytest.approx(value)
        assert read_field(owner, field) == expected


@pytest.mark.parametrize(
    ("field", "value", "says"),
    [
        ("density", -1.0, "density"),
        ("density", float("nan"), "density"),
        ("role", "purple", "role"),
        ("shape.radius", 99.0, "radius"),
        ("densty", 1.0, "There is no field"),
        ("position.z", 1.0, "no item"),
        ("id", 7, "There is no field"),
    ],
)
def test_what_the_format_forbids_is_refused_with_a_sentence(field, value, says):
    with pytest.raises(CommandError, match=says):
        SetField(ids=(3,), field=field, value=value).apply(a_level())


def test_entities_without_the_field_are_passed_over():
    level = SetField(ids=(3, 5, 6), field="density", value=2.0).apply(a_level())
    assert level.body(3).density == 2.0
    assert level.joints == a_level().joints


def test_an_absent_part_appears_and_stays_absent_when_nothing_changes():
    assert a_level().joints[0].limits is None
    changed = SetField(ids=(5,), field="limits.max", value=0.5).apply(a_level())
    assert changed.joints[0].limits == Limits(on=False, min=0.0, max=0.5)
    unchanged = SetField(ids=(5,), field="limits.max", value=0.0).apply(a_level())
    assert unchanged == a_level()


@pytest.mark.parametrize(
    "command",
    [
        SetField(ids=(1, 2), field="shape.radius", value=0.6),
        AdjustField(ids=(1, 2), field="shape.radius", change=Change(amount=4, operator="*")),
        ResetFields(rows=((2, "shape.radius", 0.6),)),
    ],
    ids=str,
)
def test_anchors_and_thrusters_of_a_circle_keep_their_place_on_it(command):
    thruster = Thruster(id=7, body=2, position=(0.0, -0.15))
    level = MoveJoint(joint=5, point=(2.2, 2.15)).apply(a_level())
    level = command.apply(level.replace(thrusters=(thruster,), next_id=8))
    assert level.body(2).shape.radius == pytest.approx(0.6)
    assert level.body(2).position == a_level().body(2).position
    assert level.body(1) == a_level().body(1)
    assert level.thrusters[0].position == pytest.approx((0.0, -0.6), abs=1e-6)
    assert level.joints[0].anchor_b == pytest.approx((0.0, 0.6), abs=1e-6)
    assert gap(level, level.joints[0]) < 1e-6


def test_a_radius_that_cannot_be_is_mended():
    broken = a_level().body(2).replace(shape=Circle(radius=0.0))
    level = a_level().replace(bodies=(a_level().body(1), broken))
    level = SetField(ids=(2,), field="shape.radius", value=0.5).apply(level)
    assert level.body(2).shape.radius == 0.5
    assert level.joints[0].anchor_b == (0.0, 0.0)


def test_setting_an_angle_lets_joints_follow():
    level = SetField(ids=(1,), field="angle", value=1.0).apply(a_level())
    assert gap(level, level.joints[0]) < 1e-6


def a_car():
    """A board on two wheels."""
    board = Body(id=1, shape=rectangle(1.0, 0.2), position=(2.0, 1.0))
    wheels = [
        Body(id=k, shape=Circle(radius=0.2), position=(x, 0.9)) for k, x in ((2, 1.6), (3, 2.4))
    ]
    level = Level(name="Car", bodies=(board, *wheels))
    for wheel in wheels:
        command = AddJoint(bodies=(1, wheel.id), point=wheel.position, kind="revolute")
        level = command.apply(level)
    return level


@pytest.mark.parametrize(
    "command",
    [
        SetField(ids=(1, 2, 3), field="angle", value=0.5),
        SetField(ids=(1, 2, 3), field="position.x", value=3.0),
        SetField(ids=(3, 2, 1), field="position", value=(3.0, 2.0)),
        AdjustField(ids=(1, 2, 3), field="angle", change=Change(amount=0.5, operator="+")),
        ResetFields(rows=((1, "angle", 0.5), (2, "angle", -0.5), (3, "angle", 1.0))),
        MoveEach(shifts=(((1,), (0.1, 0.0)), ((2,), (0.5, 0.0)), ((3,), (-0.5, 0.0))), label="x"),
    ],
    ids=str,
)
def test_a_jointed_machine_stays_whole_and_its_wheels_turn_about_their_centres(command):
    level = command.apply(a_car())
    for joint in level.joints:
        assert gap(level, joint) < 1e-6
        assert joint.anchor_b == pytest.approx((0.0, 0.0), abs=1e-6)


def test_a_machine_that_moves_as_a_whole_keeps_its_joints():
    change = Change(amount=1.0, operator="+")
    level = AdjustField(ids=(1, 2, 3), field="position.x", change=change).apply(a_car())
    for before, after in zip(a_car().joints, level.joints, strict=True):
        assert after.anchor_a == pytest.approx(before.anchor_a, abs=1e-6)
        assert after.anchor_b == pytest.approx(before.anchor_b, abs=1e-6)


@pytest.mark.parametrize(
    ("corners", "dragged"),
    [
        (((2.0, 2.0), (1.0, 2.0), (1.0, 1.8), (2.0, 1.8)), (2.3, 2.4)),
        (((2.0, 2.0), (1.0, 2.0), (1.0, 1.0)), (2.3, 1.4)),
        (((2.0, 2.0), (1.0, 2.0), (1.0, 1.0)), (0.6, 1.7)),
    ],
    ids=["board", "triangle", "triangle turned inside out"],
)
def test_corners_go_back_to_where_the_body_is_now(corners, dragged):
    """The corners that were not dragged stay, so that thrusters are where they were on the body."""
    body = polygon_body(corners, Level(name="x"))
    thruster = Thruster(id=2, body=1, position=(0.1, 0.0))
    level = Level(name="x", bodies=(body,), thrusters=(thruster,))
    reshaped = SetVertices(body=1, vertices=(dragged, *corners[1:])).apply(level)
    moves = (Rotate(ids=(1,), angle=0.3), Move(ids=(1,), shift=(1.0, 1.0)))
    back = ResetCorners(body=1, shape=body.shape)
    for command in (*moves, back):
        reshaped = command.apply(reshaped)
    assert reshaped.body(1).shape == body.shape
    assert reshaped.thrusters[0].position == pytest.approx(thruster.position, abs=1e-6)


def test_a_scaled_shape_gets_its_corners_back_about_its_middle():
    scaled = Scale(ids=(1,), factor=2.0, pivot=(2.0, 2.0)).apply(a_level())
    back = ResetCorners(body=1, shape=a_level().body(1).shape).apply(scaled)
    assert back.body(1) == a_level().body(1)


WELD = Joint(id=9, kind="fixed", a=1, b=2, anchor_a=(0, 0), anchor_b=(0, 0))


@pytest.mark.parametrize(
    "command",
    [
        SetField(ids=(5,), field="kind", value="fixed"),
        SetField(ids=(5,), field="limits.on", value=True),
        ResetFields(rows=((5, "kind", "fixed"),)),
        PasteProperties(ids=(5,), source=WELD),
        PasteProperties(ids=(5,), source=WELD.replace(kind="revolute", limits=Limits(max=1.0))),
    ],
    ids=str,
)
def test_new_welds_and_limits_are_measured_from_how_they_are_drawn(command):
    turned = Rotate(ids=(2,), angle=math.pi / 2).apply(a_level())
    assert turned.joints[0].reference_angle == 0.0
    assert command.apply(turned).joints[0].reference_angle == pytest.approx(math.pi / 2)
    alone = turned.replace(bodies=turned.bodies[1:])
    assert command.apply(alone).joints[0].reference_angle == 0.0


def test_limits_that_are_switched_off_and_on_again_are_where_they_were():
    joint = a_level().joints[0].replace(limits=Limits(min=-0.8, max=0.8))
    level = Rotate(ids=(2,), angle=0.5).apply(a_level().replace(joints=(joint,)))
    after = level
    for on in (False, True):
        after = SetField(ids=(5,), field="limits.on", value=on).apply(after)
    assert after == level


@pytest.mark.parametrize("drawn", [0.4363, 5.0, -3.0], ids=str)
@pytest.mark.parametrize("ids", [(1,), (1, 2)], ids=str)
@pytest.mark.parametrize("limits", [None, Limits(min=-1.0, max=4.0)], ids=["free", "limited"])
def test_whole_turns_leave_shapes_at_the_angle_that_they_were_drawn_at(drawn, ids, limits):
    """A box with a wheel, hinged to the arena: the hinge counts whole turns, the eye does not."""
    level = a_level()
    hinge = Joint(
        id=9, kind="revolute", a="floor", b=1, anchor_a=(0, 0), anchor_b=(0, 0), limits=limits
    )
    box, wheel = level.body(1).replace(angle=drawn), level.body(2).replace(angle=drawn + 2.0)
    hinge = hinge.replace(reference_angle=drawn - 1.0)
    start = level.replace(bodies=(box, wheel, *level.bodies[2:]), joints=(*level.joints, hinge))
    level = start
    for _ in range(8):
        level = Rotate(ids=ids, angle=math.pi / 4).apply(level)
        if ids == (1, 2):
            assert level.body(2).angle - level.body(1).angle == pytest.approx(2.0)
    for old, new in zip(start.bodies, level.bodies, strict=True):
        assert new.angle == pytest.approx(old.angle)
    # A quarter back from a whole turn is a quarter back, and not three quarters on.
    for angle in (1.5, -3.0):
        level = Rotate(ids=ids, angle=angle).apply(level)
    turn = level.body(1).angle - hinge.reference_angle
    assert limits is None or turn == pytest.approx(-0.5)


def test_what_moves_at_the_start_moves_on_as_it_is_turned():
    level = a_level()
    start = level.replace(bodies=tuple(b.replace(velocity=(2.0, 0.0)) for b in level.bodies))
    turned = Rotate(ids=(1, 2), angle=math.pi / 2).apply(start)
    assert [turned.body(k).velocity for k in (1, 2)] == [pytest.approx((0.0, 2.0))] * 2
    assert all(b.velocity == (2.0, 0.0) for b in turned.bodies if b.id not in (1, 2))


def test_a_frame_that_is_hardly_off_its_centre_is_put_there_as_the_shape_grows():
    level = a_level()
    off = Polygon(vertices=tuple((x + 5e-5, y) for x, y in level.body(1).shape.vertices))
    level = level.replace(bodies=(level.body(1).replace(shape=off), *level.bodies[1:]))
    assert "E107" not in {each.code for each in validate(level)}
    grown = Scale(ids=(1, 2), factor=3.0, pivot=(2.0, 2.0)).apply(level)
    assert "E107" not in {each.code for each in validate(grown)}
    assert world_vertices(grown.body(1))[0] == pytest.approx((2.60015, 2.6))
    (joint,), (thruster,) = grown.joints, grown.thrusters
    assert to_world(grown.body(1), joint.anchor_a) == pytest.approx(grown.body(2).position)
    assert to_world(grown.body(1), thruster.position) == pytest.approx((1.55, 2.3))


def test_two_jointed_circles_get_a_radius_together():
    level = a_level()
    discs = tuple(
        body.replace(shape=Circle(radius=0.3)) if body.id in (1, 2) else body
        for body in level.bodies
    )
    joint = level.joints[0].replace(anchor_b=(-0.1, 0.0))
    level = level.replace(bodies=discs, joints=(joint,))
    level = SetField(ids=(1, 2), field="shape.radius", value=0.6).apply(level)
    assert level.joints[0].anchor_b == pytest.approx((-0.2, 0.0), abs=1e-6)
    assert gap(level, level.joints[0]) < 1e-6


def test_a_weld_keeps_the_angle_that_was_given_to_it():
    joint = a_level().joints[0].replace(kind="fixed", reference_angle=0.3)
    level = a_level().replace(joints=(joint,))
    for field, value in (("kind", "fixed"), ("limits.max", 1.0), ("motor.on", False)):
        after = SetField(ids=(5,), field=field, value=value).apply(level)
        assert after.joints[0].reference_angle == joint.reference_angle


def test_mixed_values_are_told():
    level = a_level()
    assert shared_value(level, (3, 4), "shape.radius") == (pytest.approx(0.2), True)
    assert shared_value(level, (2, 3), "shape.radius")[1] is False
    with pytest.raises(CommandError):
        shared_value(level, (5,), "density")
    with pytest.raises(CommandError, match="Nothing is selected"):
        shared_value(level, (), "density")


def test_labels_say_what_was_done():
    assert SetField(ids=(5,), field="motor.power", value=2.5).label == "Motor power → 2.5"
    assert SetField(ids=(5,), field="motor.on", value=False).label == "Motor on → off"
    assert SetField(ids=(3,), field="position", value=(1, 2)).label == "Position → (1, 2)"
    assert SetField(ids=(3,), field="restitution", value=0.5).label == "Bounciness → 0.5"


def test_level_fields():
    level = SetLevelField(field="gravity.y", value=-3.0).apply(a_level())
    assert level.gravity == (0.0, -3.0)
    assert SetLevelField(field="name", value="Other").apply(level).name == "Other"
    assert SetLevelField(field="size", value="l").apply(level).size == "l"
    with pytest.raises(CommandError):
        SetLevelField(field="name", value="").apply(level)
    with pytest.raises(CommandError):
        SetLevelField(field="bodies", value=()).apply(level)


def test_mirroring_twice_changes_nothing():
    level = a_level()
    for axis in "xy":
        once = Mirror(ids=(1, 2, 3), axis=axis).apply(level)
        assert once != level
        twice = Mirror(ids=(1, 2, 3), axis=axis).apply(once)
        for before, after in zip(level.entities(), twice.entities(), strict=True):
            for name in ("position", "anchor_a", "anchor_b"):
                if hasattr(before, name):
                    assert getattr(after, name) == pytest.approx(getattr(before, name), abs=1e-5)
            if isinstance(before, Body | Thruster):
                turn = math.remainder(after.angle - before.angle, math.tau)
                assert turn == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_mirrored_outline_is_the_outline_mirrored(axis):
    body = Body(id=1, shape=KITE, position=(1.0, 2.0), angle=0.4, velocity=(1.0, 2.0))
    level = Mirror(ids=(1,), axis=axis).apply(Level(name="x", bodies=(body,)))
    after = level.bodies[0]
    k = "xy".index(axis)
    low, high = (f(v[k] for v in world_vertices(body)) for f in (min, max))
    expected = []
    for vertex in world_vertices(body):
        flipped = list(vertex)
        flipped[k] = low + high - flipped[k]
        expected.append(tuple(flipped))
    found = world_vertices(after)
    for vertex in expected:
        assert min(math.dist(vertex, other) for other in found) < 1e-5
    assert polygon_fault(after.shape.vertices) is None
    assert after.velocity[k] == -body.velocity[k]


def test_a_joint_to_the_floor_stays_whole_when_the_floor_is_selected_too():
    joint = a_level().joints[0]
    floor = referenced_body(a_level(), "floor")
    anchor = to_local(floor, to_world(a_level().body(joint.a), joint.anchor_a))
    level = a_level().replace(joints=(joint.replace(b="floor", anchor_b=anchor),))
    alone = Mirror(ids=(joint.a,), axis="x").apply(level)
    assert gap(alone, alone.joints[0]) < 1e-6
    assert Mirror(ids=(joint.a, "floor"), axis="x").apply(level) == alone


def test_a_mirrored_motor_turns_the_other_way():
    joint = a_level().joints[0].replace(limits=Limits(min=-0.2, max=1.0), reference_angle=0.3)
    level = Mirror(ids=(1, 2), axis="x").apply(a_level().replace(joints=(joint,)))
    after = level.joints[0]
    assert (after.limits.min, after.limits.max) == pytest.approx((-1.0, 0.2))
    assert after.motor.speed == -joint.motor.speed
    assert after.reference_angle == pytest.approx(-0.3)
    assert gap(level, after) < 1e-6


@pytest.mark.parametrize("ids", [(1,), (1, 2)], ids=str)
@pytest.mark.parametrize("ends", [("floor", 1), (1, "floor"), (1, 2), (2, 1)], ids=str)
def test_a_mirrored_joint_is_as_far_from_its_limits_whatever_it_hangs_on(ends, ids):
    level = Rotate(ids=(2,), angle=0.4).apply(Rotate(ids=(1,), angle=0.9).apply(a_level()))
    a, b = ends
    at_a, at_b = (to_local(referenced_body(level, end), (2.2, 2.0)) for end in ends)
    limits = Limits(min=0.0, max=1.0)
    joint = level.joints[0].replace(a=a, b=b, anchor_a=at_a, anchor_b=at_b, limits=limits)
    level = level.replace(joints=(joint.replace(reference_angle=0.1),))
    image = Mirror(ids=ids, axis="x").apply(level)
    after = image.joints[0]
    angle, turned = (
        relative_angle(each, each.joints[0]) - each.joints[0].reference_angle
        for each in (level, image)
    )
    assert turned == pytest.approx(-angle, abs=1e-6)
    assert (after.limits.min, after.limits.max) == (-1.0, 0.0)
    assert after.motor.speed == -joint.motor.speed
    assert gap(image, after) < 1e-6


def test_order_stays_within_a_kind():
    level = a_level()
    forward = Reorder(ids=(2,), step=1).apply(level)
    assert [b.id for b in forward.bodies] == [1, 3, 2, 4]
    assert Reorder(ids=(1,), step=1).apply(level) == level
    assert Reorder(ids=(4,), step=1).apply(level) == level
    back = Reorder(ids=(3, 4), step=-1).apply(level)
    assert [b.id for b in back.bodies] == [1, 3, 4, 2]


def test_removing_a_body_takes_what_hangs_on_it():
    level = Remove(ids=(1,)).apply(a_level())
    assert [e.id for e in level.entities()] == [2, 3, 4]
    assert Remove(ids=(6,)).apply(a_level()).thrusters == ()
    assert Remove(ids=("floor",)).apply(a_level()) == a_level()


def test_a_duplicate_equals_its_original_but_for_the_place():
    level = a_level()
    level = SetField(ids=(1, 2), field="role", value="red").apply(level)
    copy = clip.copied(level, (1, 2))
    pasted = clip.Paste(clip=copy, shift=(0.5, 0.25)).apply(level)
    for old, new in zip(level.bodies[:2], pasted.bodies[-2:], strict=True):
        assert new.position == pytest.approx((old.position[0] + 0.5, old.position[1] + 0.25))
        assert new.replace(id=old.id, position=old.position) == old
    joint, thruster = pasted.joints[-1], pasted.thrusters[-1]
    assert joint.replace(id=5, a=1, b=2) == level.joints[0]
    assert thruster.replace(id=6, body=1) == level.thrusters[0]
    assert {joint.a, joint.b} == {b.id for b in pasted.bodies[-2:]}
    assert len({e.id for e in pasted.entities()}) == 10


def test_a_clip_is_json_that_says_what_it_is():
    text = clip.dumps(clip.copied(a_level(), (1,)))
    tree = json.loads(text)
    assert (tree["format"], tree["version"]) == ("kinetix-clip", 1)
    assert clip.loads(text) == clip.copied(a_level(), (1,))
    assert clip.loads(text).joints == ()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "hello",
        "[1, 2]",
        '{"format": "kinetix-clip", "version": 2}',
        '{"format": "kinetix-clip", "version": 1, "bodies": 3}',
        '{"format": "kinetix-level", "version": 1}',
    ],
)
def test_other_text_on_the_clipboard_is_refused(text):
    with pytest.raises(CommandError, match="clipboard"):
        clip.loads(text)


@pytest.mark.parametrize(("source", "target"), [("kinetix", "exact"), ("exact", "kinetix")])
def test_shapes_are_pasted_between_levels_of_other_inertia_models(source, target):
    """The origin of a free body's frame is its centre of mass, as each level has it."""
    corners = ((2.0, 2.0), (1.0, 2.0), (1.0, 1.0), (1.2, 1.0))
    level = a_level().replace(inertia_model=source)
    trapezoid = polygon_body(corners, level, level.body(1))
    level = level.replace(bodies=(trapezoid, *level.bodies[1:]))
    level = Reanchor(joints=(5,)).apply(level)
    copy = clip.loads(clip.dumps(clip.copied(level, (1, 2))))
    empty = Level(name="x", inertia_model=target)
    pasted = clip.Paste(clip=copy, shift=(0.0, 0.0)).apply(empty)
    assert "E107" not in {issue.code for issue in validate(pasted)}
    assert np.allclose(world_vertices(pasted.bodies[0]), corners, atol=1e-6)
    assert gap(pasted, pasted.joints[0]) < 1e-6
    place = to_world(trapezoid, level.thrusters[0].position)
    now = to_world(pasted.bodies[0], pasted.thrusters[0].position)
    assert now == pytest.approx(place, abs=1e-6)


def test_a_clip_whose_joints_lead_nowhere_is_refused():
    whole = clip.copied(a_level(), (1, 2))
    with pytest.raises(CommandError, match="do not fit"):
        clip.loads(clip.dumps(whole.replace(bodies=whole.bodies[:1])))


def test_a_joint_to_the_arena_is_anchored_where_the_copy_is():
    joint = Joint(id=9, kind="revolute", a="floor", b=3, anchor_a=(1.5, 7.8), anchor_b=(0.0, 0.0))
    level = a_level().replace(joints=(joint,), next_id=10)
    pasted = clip.Paste(clip=clip.copied(level, (3,)), shift=(-1.0, 0.5)).apply(level)
    new = pasted.joints[-1]
    assert new.a == "floor"
    assert gap(pasted, new) < 1e-6


def test_pasting_properties_leaves_place_and_shape():
    level = a_level()
    source = level.bodies[2].replace(density=3.0, collision="ghost")
    after = PasteProperties(ids=(1, 4), source=source).apply(level)
    for body_id in (1, 4):
        old, new = level.body(body_id), after.body(body_id)
        assert (new.position, new.shape, new.angle) == (old.position, old.shape, old.angle)
        assert (new.density, new.collision, new.role) == (3.0, "ghost", "green")
    with pytest.raises(CommandError):
        PasteProperties(ids=(5,), source=source).apply(level)
    motor = Motor(speed=3.0, binding=2)
    source = level.joints[0].replace(motor=motor)
    assert PasteProperties(ids=(5,), source=source).apply(level).joints[0].motor == motor


def test_a_joint_can_hold_another_body():
    level = ReassignJoint(joint=5, end="b", body=3).apply(a_level())
    joint = level.joints[0]
    assert (joint.a, joint.b) == (1, 3)
    assert gap(level, joint) < 1e-6
    with pytest.raises(CommandError):
        ReassignJoint(joint=5, end="b", body=1).apply(a_level())


@pytest.mark.parametrize(
    ("bodies", "ends", "speed", "limits"),
    [((2, 3), (2, 3), -2.0, (-1.0, 0.5)), ((1, 3), (1, 3), 2.0, (-0.5, 1.0))],
    ids=["the wheel becomes a", "the box stays a"],
)
def test_a_rehung_joint_keeps_its_name_and_drives_what_it_drove(bodies, ends, speed, limits):
    joint = a_level().joints[0].replace(name="Axle", limits=Limits(min=-0.5, max=1.0))
    level = a_level().replace(joints=(joint,))
    after = RehangJoint(joint=5, bodies=bodies, point=(3.0, 2.0)).apply(level).joints[0]
    assert (after.name, after.a, after.b) == ("Axle", *ends)
    assert after.motor == joint.motor.replace(speed=speed)
    assert (after.limits.min, after.limits.max) == limits


def test_reanchoring_closes_the_gap():
    joint = a_level().joints[0].replace(anchor_b=(0.05, 0.0))
    level = a_level().replace(joints=(joint,))
    assert gap(level, joint) > 0.04
    assert gap(level, Reanchor(joints=(5,)).apply(level).joints[0]) < 1e-6


def test_permuting_changes_the_order_and_nothing_else():
    level = a_level()
    orders = set()
    for seed in range(10):
        permuted = Permute(seed=seed).apply(level)
        orders.add(tuple(b.id for b in permuted.bodies))
        assert {e.id: e for e in permuted.entities()} == {e.id: e for e in level.entities()}
    assert len(orders) > 1


def test_group_edits_need_a_body():
    for command in (Rotate(ids=(5,), angle=1.0), Mirror(ids=(), axis="x")):
        with pytest.raises(CommandError, match="Select a shape"):
            command.apply(a_level())
    with pytest.raises(CommandError, match="positive"):
        Scale(ids=(1,), factor=-1.0, pivot=(0, 0)).apply(a_level())


def test_a_polygon_body_has_its_origin_at_the_centre_of_mass():
    corners = ((0.0, 0.0), (0.0, 1.0), (2.0, 0.0))
    body = polygon_body(corners, Level(name="x"))
    assert body.position == pytest.approx((2 / 3, 1 / 3), abs=1e-6)
    assert polygon_fault(body.shape.vertices) is None


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text.replace('"density":1.0', '"density":1e999'),
        lambda text: text.replace('"density":1.0', '"density":-3.0'),
        lambda text: text.replace('"id":2', '"id":1'),
        lambda text: text[:-1] + ',"bodies":[]}',
        lambda text: text.replace("[", "[" * 3000),
        lambda text: text[:40] + "\udcff" + text[40:],
    ],
)
def test_a_damaged_clip_cannot_damage_a_level(damage):
    text = clip.dumps(clip.copied(a_level(), (1, 2)))
    assert damage(text) != text
    with pytest.raises(CommandError, match="nothing that can be pasted"):
        clip.loads(damage(text))


def test_joints_alone_can_be_copied_for_their_properties():
    joints = a_level().joints
    whole = clip.copied(a_level(), (joints[0].id,))
    assert clip.loads(clip.dumps(whole)) == whole


def test_parts_on_other_bodies_are_left_as_they_are():
    level = a_level()
    other = level.joints[0].replace(id=9, a=3, b=4)
    level = level.replace(joints=(*level.joints, other), next_id=10)
    after = with_parts(level, (1,), lambda at: (2 * at[0], 2 * at[1]))
    assert after.entity(9) is level.entity(9)  # a thousand of them would take seconds
    assert after.entity(5).anchor_a == pytest.approx((0.4, 0.0))
    assert after.entity(6).position == pytest.approx((-0.3, 0.2))


def test_copies_of_what_has_a_name_are_numbered():
    level = a_level()
    level = level.replace(
        bodies=(level.bodies[0].replace(name="Board"), *level.bodies[1:]),
        joints=(level.joints[0].replace(name="Axle"),),
        thrusters=(level.thrusters[0].replace(name="Jet 9"),),
    )
    found = clip.copied(level, (1, 2))
    twice = clip.Paste(clip=found, shift=(0.5, 0.0)).apply(
        clip.Paste(clip=found, shift=(0.3, 0.0)).apply(level)
    )
    names = [entity.name for entity in twice.entities() if entity.name]
    assert names == [
        *("Board", "Board 2", "Board 3"),
        *("Axle", "Axle 2", "Axle 3"),
        *("Jet 9", "Jet 10", "Jet 11"),
    ]
    third = clip.Paste(clip=clip.copied(twice, (twice.bodies[4].id,)), shift=(0.0, 1.0))
    assert third.apply(twice).bodies[-1].name == "Board 4"
    # Where a name is free it stays.
    elsewhere = clip.Paste(clip=found, shift=(0.0, 0.0)).apply(Level(name="Another"))
    assert [entity.name for entity in elsewhere.entities()] == ["Board", None, "Axle", "Jet 9"]


def test_a_long_name_is_cut_for_the_number_of_its_copy():
    longest = "x" * MAX_NAME
    level = Level(name="One", bodies=(a_level().bodies[0].replace(name=longest),))
    copy = clip.Paste(clip=clip.copied(level, (1,)), shift=(1.0, 0.0)).apply(level).bodies[-1]
    assert copy.name == "x" * (MAX_NAME - 2) + " 2"
