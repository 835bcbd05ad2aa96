"""Changed keys: they work, have one meaning, and can be as at first again."""

import pytest

from editor import actions
from editor.actions import BY_ID, rebinding
from editor.base.controls import DEFAULT_KEYS, Drive
from editor.base.settings import Settings


def test_a_bound_chord_does_the_action_and_the_old_one_no_more(session, hand):
    rebinding.bind(session, BY_ID["edit.select_all"], "ctrl+k")
    hand.key("a", ctrl=True)
    assert session.selection == ()
    hand.key("k", ctrl=True)
    assert len(session.selection) == 6


@pytest.mark.parametrize(
    ("action", "chord", "other"),
    [
        ("edit.select_all", "ctrl+d", "Duplicate"),
        ("edit.select_all", "ctrl+s", "Save"),
        ("edit.select_all", "shift+left", "Nudge Left"),
        ("edit.select_all", "ctrl+alt+j", ""),
        ("gallery.rename", "ctrl+l", ""),
        ("run.step", "space", "Pause"),
        ("run.step", "w", "Motors of group 3, forwards"),
        ("edit.cut", ".", ""),
    ],
)
def test_conflicts_are_named(session, action, chord, other):
    assert rebinding.conflict(session, BY_ID[action], chord) == other


def test_a_chord_that_was_a_variant_of_another_action_does_what_it_was_given_to(session, hand):
    circle = BY_ID["tool.circle"]
    rebinding.bind(session, circle, "shift+left")
    assert actions.find(session, "shift+left") is circle
    assert actions.find(session, "left") is BY_ID["transform.nudge_left"]
    assert actions.find(session, "shift+right") is BY_ID["transform.nudge_right"]


def test_taking_a_chord_leaves_it_one_meaning(session):
    rebinding.bind(session, BY_ID["edit.lock"], "ctrl+d")
    assert actions.chords(session, BY_ID["edit.lock"]) == ("ctrl+d",)
    assert actions.chords(session, BY_ID["edit.duplicate"]) == ()
    rebinding.bind(session, BY_ID["edit.lock"], "ctrl+l")
    assert "edit.lock" not in session.settings.keys, "the default needs no entry"
    rebinding.reset_all(session)
    assert actions.chords(session, BY_ID["edit.duplicate"]) == ("ctrl+d",)


def test_driving_keys_change_and_survive_a_restart(session, tmp_path):
    rebinding.bind_drive(session, Drive(channel=0, value=1), "j")
    assert session.control_keys["j"] == Drive(channel=0, value=1)
    assert "left" not in session.control_keys and len(session.control_keys) == len(DEFAULT_KEYS)
    session.settings.save(tmp_path / "settings.json")
    session.settings = Settings.load(tmp_path / "settings.json")
    session.hands.held = {"j"}
    assert session.action[0] == 1
    rebinding.bind_drive(session, Drive(channel=0, value=1), "left")
    assert session.settings.controls == {}


def test_a_driving_key_takes_the_step_key(session):
    assert rebinding.drive_conflict(session, Drive(channel=0, value=1), ".") == "Step"
    rebinding.bind_drive(session, Drive(channel=0, value=1), ".")
    assert actions.chords(session, BY_ID["run.step"]) == ()


def test_capturing_takes_one_chord_and_modifiers_alone_do_not_count(session, hand):
    taken = []
    session.hands.capture = lambda chord: (
        taken.append(chord),
        setattr(session.hands, "capture", None),
    )
    hand.key("left ctrl")
    hand.key("a", ctrl=True)
    assert taken == ["ctrl+a"] and session.selection == ()
