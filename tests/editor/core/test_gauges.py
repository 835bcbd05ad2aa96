"""Handles of quantities: what stands where, and what dragging it does."""

import math

import pytest

from editor.base.overlay import Arc, HandleKind
from editor.documents.commands.fields import read_field
from editor.editing.gauges import KINDS, handles_of, limit_base, marks_of
from editor.editing.picking import joint_position
from editor.window.panels.number_info import field_info
from kinetix.level.model import Body, Joint, Level, Limits, Thruster
from tests.editor.core.helpers import Hand, a_level, a_session


def limited():
    level = a_level()
    joint = level.joints[0].replace(limits=Limits(min=-0.5, max=1.0), reference_angle=0.2)
    return level.replace(joints=(joint,))


def place(session, kind):
    handles = handles_of(session.document.level, session.selection, session.metres)
    return next(handle.at for handle in handles if handle.kind is kind)


def around(centre, angle, metres):
    return centre[0] + metres * math.cos(angle), centre[1] + metres * math.sin(angle)


@pytest.mark.parametrize(
    ("kind", "which", "angle"),
    [(HandleKind.LIMIT_MIN, "min", -1.2), (HandleKind.LIMIT_MAX, "max", 2.0)],
)
def test_the_ends_of_the_wedge_are_the_limits_of_the_joint(kind, which, angle):
    session = a_session(limited())
    session.selection = (5,)
    level = session.document.level
    joint = level.joints[0]
    at, base = joint_position(level, joint), limit_base(level, joint)
    Hand(session).drag(place(session, kind), around(at, base + angle, 0.4), ctrl=True)
    limits = session.document.level.joints[0].limits
    assert getattr(limits, which) == pytest.approx(angle, abs=1e-3)
    assert session.document.history.undo_label.startswith(f"{which.capitalize()} angle →")


def test_a_limit_stops_at_the_other_one_and_snaps_to_round_angles():
    session = a_session(limited())
    session.selection = (5,)
    level = session.document.level
    joint = level.joints[0]
    at, base = joint_position(level, joint), limit_base(level, joint)
    hand = Hand(session)
    hand.drag(place(session, HandleKind.LIMIT_MIN), around(at, base + 1.4, 0.4))
    assert session.document.level.joints[0].limits.min == pytest.approx(1.0)
    hand.drag(place(session, HandleKind.LIMIT_MAX), around(at, base + 1.58, 0.4))
    maximum = session.document.level.joints[0].limits.max
    assert maximum == pytest.approx(math.radians(90), abs=1e-6)


def test_the_wedge_is_there_without_any_debug_drawing():
    level = limited()
    arcs = [mark for mark in marks_of(level, (5,), 0.01) if isinstance(mark, Arc)]
    wedge = next(arc for arc in arcs if arc.filled)
    assert wedge.end - wedge.start == pytest.approx(1.5)
    assert not [mark for mark in marks_of(a_level(), (5,), 0.01) if getattr(mark, "filled", False)]


def test_motor_speed_power_velocity_spin_and_gravity_are_dragged_and_undone():
    session = a_session(limited())
    hand, document = Hand(session), session.document
    cases = (
        (HandleKind.MOTOR, (5,), lambda level: level.joints[0].motor.speed),
        (HandleKind.POWER, (6,), lambda level: level.thrusters[0].power),
        (HandleKind.VELOCITY, (3,), lambda level: level.body(3).velocity),
        (HandleKind.SPIN, (3,), lambda level: level.body(3).angular_velocity),
        (HandleKind.GRAVITY, (), lambda level: level.gravity),
    )
    for kind, selection, value in cases:
        session.selection = selection
        before = value(document.level)
        x, y = place(session, kind)
        hand.drag((x, y), (x + 0.2, y - 0.13))
        after = value(document.level)
        assert after != before, kind
        assert session.selection == selection
        # The handle stands where it was dropped, but for rounding.
        assert math.dist(place(session, kind), (x, y)) > 0.02
        document.undo()
        assert value(document.level) == before


def after_typing(kind, selection, typed):
    """The level once a handle was dragged a little and a number was typed meanwhile."""
    session = a_session(limited())
    session.selection = selection
    hand = Hand(session)
    x, y = place(session, kind)
    hand.press((x, y))
    hand.hold((x, y + 0.05))
    hand.type(typed)
    hand.release((x, y + 0.05))
    return session.document.level


@pytest.mark.parametrize(
    ("kind", "selection", "typed", "value"),
    [
        (HandleKind.POWER, (6,), "2.5", lambda level: level.thrusters[0].power == 2.5),
        (HandleKind.POWER, (6,), "-2", lambda level: level.thrusters[0].power == 0.0),
        (HandleKind.MOTOR, (5,), "-1.5", lambda level: level.joints[0].motor.speed == -1.5),
        (HandleKind.SPIN, (3,), "-4", lambda level: level.body(3).angular_velocity == -4.0),
        (
            HandleKind.LIMIT_MIN,
            (5,),
            "-60",
            lambda level: level.joints[0].limits.min == pytest.approx(math.radians(-60)),
        ),
        (HandleKind.GRAVITY, (), "3", lambda level: level.gravity == (0.0, -3.0)),
        (HandleKind.GRAVITY, (), "-3", lambda level: level.gravity == (0.0, -3.0)),
    ],
)
def test_a_typed_number_is_the_value(kind, selection, typed, value):
    assert value(after_typing(kind, selection, typed))


@pytest.mark.parametrize(
    ("kind", "selection", "record", "field"),
    [
        (HandleKind.POWER, (6,), Thruster, "power"),
        (HandleKind.MOTOR, (5,), Joint, "motor.speed"),
        (HandleKind.LIMIT_MAX, (5,), Joint, "limits.max"),
        (HandleKind.SPIN, (3,), Body, "angular_velocity"),
        (HandleKind.GRAVITY, (), Level, "gravity.1"),
    ],
)
def test_a_typed_number_stops_where_the_model_does(kind, selection, record, field):
    level = after_typing(kind, selection, "987654321")
    changed = level.entity(selection[0]) if selection else level
    assert abs(read_field(changed, field)) == field_info(record, field).high


def test_fixed_bodies_welds_and_groups_have_none():
    level = limited()
    weld = level.joints[0].replace(kind="fixed")
    assert handles_of(level.replace(joints=(weld,)), (5,), 0.01) == ()
    assert handles_of(level, (4,), 0.01) == ()
    assert handles_of(level, (1, 2), 0.01) == ()
    assert {handle.kind for handle in handles_of(level, (3,), 0.01)} <= KINDS
