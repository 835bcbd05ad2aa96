"""The menu of a right click."""

import pytest

from editor import actions
from editor.actions import BY_ID
from editor.actions.editing import context
from editor.documents.commands.fields import read_field
from editor.documents.document import Document
from tests.editor.core.helpers import Hand, a_level, a_session, texts


def menu(session, at):
    hand = Hand(session)
    hand.move(at)
    hand.press(at, 3)
    hand.release(at, 3)
    (prompt,) = session.prompts
    return prompt


def choose(session, at, key):
    prompt = menu(session, at)
    assert key in [choice.id for choice in prompt.choices]
    session.answer(prompt, key)
    actions.update(session, 1 / 60)


def test_what_lies_there_comes_first_and_can_be_selected():
    session = a_session()
    prompt = menu(session, (2.2, 2.0))
    listed = [choice.ids for choice in prompt.choices if choice.ids]
    assert listed == [(5,), (2,), (1,)]
    session.answer(prompt, "1")
    assert session.selection == (2,)


@pytest.mark.parametrize(
    ("key", "check"),
    [
        ("change.make red", lambda level: level.body(3).role == "red"),
        ("change.fix in place", lambda level: level.body(3).fixed),
        ("edit.delete", lambda level: all(body.id != 3 for body in level.bodies)),
        ("edit.duplicate", lambda level: len(level.bodies) == 5),
    ],
)
def test_one_does_there_what_one_would(key, check):
    session = a_session()
    choose(session, (4.0, 3.0), key)
    assert check(session.document.level)
    session.document.undo()
    assert session.document.level == a_level().replace(next_id=session.document.level.next_id)


def test_a_joint_gets_limits_and_becomes_a_weld():
    session = a_session()
    choose(session, (2.2, 2.0), "change.limit the angle")
    assert session.document.level.joints[0].limits.on
    assert session.selection == (5,)
    choose(session, (2.2, 2.0), "change.make a weld")
    assert session.document.level.joints[0].kind == "fixed"


def test_the_whole_selection_is_meant_when_it_was_clicked():
    session = a_session()
    session.selection = (1, 3)
    choose(session, (4.0, 3.0), "change.make blue")
    assert session.document.level.body(1).role == session.document.level.body(3).role == "blue"


def test_an_empty_place_offers_to_paste_and_draw():
    session = a_session()
    session.selection = (3,)
    actions.run(session, "edit.copy")
    choose(session, (0.5, 3.0), "edit.paste")
    assert session.document.level.bodies[-1].position == pytest.approx((0.5, 3.0), abs=0.05)
    choose(session, (0.5, 2.0), "tool.circle")
    assert session.tool.id == "circle"


def test_every_row_is_an_action():
    assert {*context._ARRANGING, *context._EMPTY} <= set(BY_ID)


def test_leaving_the_menu_changes_nothing():
    session = a_session()
    session.selection = (1,)
    prompt = menu(session, (4.0, 3.0))
    session.answer(prompt, None)
    assert session.selection == (1,)
    assert not session.document.dirty


@pytest.mark.parametrize("key", ["edit.delete", "change.make red", "0"])
def test_the_menu_is_about_the_level_in_which_it_was_opened(key):
    session = a_session()
    asked = session.document
    prompt = menu(session, (4.0, 3.0))
    session.open_tab(Document(a_level()))
    session.answer(prompt, key)
    assert session.document.level == asked.level == a_level()
    assert session.selection == ()
    assert "open the menu again" in texts(session)[-1]


@pytest.mark.parametrize(("entity", "field"), [(5, "motor.binding"), (6, "binding")])
def test_a_key_goes_to_the_level_that_it_was_asked_for(entity, field):
    session = a_session()
    asked = session.document
    context.ask_key(session, entity, (0.0, 0.0))
    session.open_tab(Document(a_level()))
    session.answer(session.prompts[-1], "1")
    assert read_field(asked.level.entity(entity), field) == 1
    assert session.document.level == a_level()


def test_hiding_needs_something_selected_and_all_can_be_shown_again():
    session = a_session()
    assert not actions.run(session, "edit.hide") and not actions.run(session, "edit.show_all")
    assert "edit.show_all" not in [choice.id for choice in menu(session, (3.0, 1.5)).choices]
    session = a_session()
    document = session.document
    session.selection = (3,)
    assert actions.run(session, "edit.hide")
    assert document.hidden == {3}
    names = [choice.id for choice in menu(session, (3.0, 1.5)).choices]
    assert "edit.show_all" in names and "edit.hide" not in names
    assert actions.run(session, "edit.show_all")
    assert not document.hidden
