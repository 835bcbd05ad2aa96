"""Parts and templates: valid wherever they are dropped, whole, and undone at once."""

import math

import pytest

from editor import actions
from editor.actions.files import examples
from editor.documents.commands.parts import PARTS
from editor.editing.picking import joint_position
from kinetix.level.geometry import referenced_body, to_world
from kinetix.level.model import Level
from kinetix.level.validate import validate
from tests.editor.core.helpers import Hand, a_session


@pytest.mark.parametrize("part", PARTS)
def test_a_part_is_dropped_at_the_pointer_and_is_sound(part):
    session = a_session(Level(name="Empty"))
    Hand(session).move((2.0, 3.0))
    actions.run(session, f"part.{part}")
    level = session.document.level
    assert level.bodies
    assert level.joints
    for joint in level.joints:
        a = to_world(referenced_body(level, joint.a), joint.anchor_a)
        b = to_world(referenced_body(level, joint.b), joint.anchor_b)
        assert math.dist(a, b) < 1e-5
        assert math.dist(joint_position(level, joint), (2.0, 3.0)) < 1.5
    wrong = [issue for issue in validate(level) if issue.severity == "error"]
    # What an empty level lacks is no fault of the part.
    assert {issue.code for issue in wrong} <= {issue.code for issue in validate(Level(name="x"))}
    assert set(session.selection) == {body.id for body in level.bodies}
    session.document.undo()
    assert session.document.level.bodies == ()


def test_a_wheel_is_driven_and_a_rope_is_free():
    assert all(joint.motor.on for joint in PARTS["wheel"][2]().joints)
    assert not any(joint.motor.on for joint in PARTS["rope"][2]().joints)
    assert [joint.motor.binding for joint in PARTS["arm"][2]().joints] == [0, 1]
    assert all(joint.limits.on for joint in PARTS["arm"][2]().joints)


@pytest.mark.parametrize("template", examples.TEMPLATES)
def test_a_new_level_begins_as_a_template_and_has_no_file(template):
    session = a_session()
    examples.new_from(session, template)
    document = session.document
    assert document.path is None
    assert document.level.bodies
    assert document.level.solution is None
    assert document.level.name.startswith("New ")
    assert not [issue for issue in document.problems if issue.severity == "error"]
