"""The command palette: everything can be found, and what cannot be done says why."""

import pytest

from editor import actions
from editor.actions import ACTIONS
from editor.actions.base import always, editing, playing, selecting
from editor.base.events import KeyEvent
from editor.window.panels.found import _FIELDS
from editor.window.panels.palette import _ALSO, _behind, _score, entries, scene_entries
from tests.editor.core.helpers import a_level, a_session


def find(gui, words):
    gui.session.view.palette = True
    gui.frames(4)
    gui.text(words)
    gui.frames(2)


def test_every_action_is_there_and_what_is_not_possible_says_why():
    session = a_session()
    found = {entry.label: entry for entry in entries(session)}
    for action in ACTIONS:
        if action.menu and action.id != "app.palette":
            assert {action.label, f"Gallery: {action.label}"} & set(found)
    assert found["Delete"].refusal == "Select something first."
    assert found["Pause"].refusal == "Play the level first: Space."
    assert not found["Select All"].refusal
    session.selection = (1,)
    assert not {entry.label: entry for entry in entries(session)}["Delete"].refusal


@pytest.mark.parametrize("action", ACTIONS, ids=lambda action: action.id)
def test_whatever_can_be_refused_has_a_reason(action):
    assert action.refusal or action.enabled in (always, editing, playing, selecting)
    session = a_session()
    assert bool(actions.refusal(session, action)) is not actions.available(session, action)


def test_choosing_what_is_not_possible_tells_the_reason(make_gui):
    gui = make_gui(session=a_session())
    find(gui, "mirror left")
    gui.key("return")
    assert gui.session.toasts[-1].text == "Mirror Left–Right: Select something first."


def test_gravity_is_typed_from_the_palette(make_gui):
    gui = make_gui(level=a_level())
    find(gui, "gravity y")
    gui.key("return")
    gui.frames(8)
    gui.text("-1.6")
    gui.key("return")
    assert gui.level.gravity[1] == pytest.approx(-1.6)


def test_a_field_of_the_selection_is_typed_from_the_palette(make_gui):
    gui = make_gui(level=a_level())
    gui.session.view.front = "agents"
    gui.frames(6)
    gui.session.selection = (1,)
    find(gui, "density")
    gui.key("return")
    gui.frames(8)
    gui.text("2.5")
    gui.key("return")
    assert gui.level.body(1).density == pytest.approx(2.5)


def test_a_single_drawing_and_a_setting_are_switched_from_the_palette(make_gui):
    gui = make_gui(level=a_level())
    find(gui, "bounding boxes")
    gui.key("return")
    gui.frames(2)
    assert gui.session.view.debug_draw
    assert gui.session.settings.debug_draw == ["aabbs"]
    find(gui, "radians")
    gui.key("return")
    gui.frames(2)
    assert gui.session.settings.radians


@pytest.mark.parametrize(
    ("typed", "first"),
    [
        ("wheel", "Drop a Motor Wheel"),
        ("rope", "Drop a Rope"),
        ("bridge", "Drop a Bridge"),
        ("arm", "Drop an Arm"),
        ("random", "Random Level"),
        ("save", "Save"),
        ("undo", "Undo"),
        ("goalkeeper", "goalkeeper"),
        ("light theme", "Theme: Light"),
        ("level random", "Random Level"),
        ("mirr lr", "Mirror Left–Right"),
        ("d6 br", "D6 bridge"),
        ("flip hor", "Mirror Left–Right"),
        ("flip vert", "Mirror Up–Down"),
        ("box", "Rectangle"),
        ("hinge", "Joint"),
        ("settings", "Preferences…"),
        ("log", "Log"),
        ("problems", "Problems"),
    ],
)
def test_what_is_meant_comes_first(typed, first):
    """Commands before levels, scenes and agents; whole words before letters here and there."""
    session = a_session()
    offered = [*entries(session), *scene_entries(session)]
    rated = [
        (rating + _behind(entry), number, entry.label)
        for number, entry in enumerate(offered)
        if (rating := _score(entry.label, typed)) is not None
    ]
    assert min(rated)[2] == first


def test_other_words_belong_to_something_that_can_be_found():
    labels = {entry.label for entry in entries(a_session())}
    labels |= {label for _, label, _ in _FIELDS}
    assert set(_ALSO) <= labels


def test_in_a_low_window_the_chosen_row_stays_in_sight(make_gui):
    gui = make_gui(size=(640, 400))
    gui.session.view.palette = True
    gui.frames(3)
    for _ in range(15):
        gui.key("down")
    shown = [name for name in gui.session.probe if name.startswith("palette.")]
    assert "palette.15" in shown
    for name in shown:
        assert gui.probe(name).high[1] <= 400 - 24, name


def test_what_is_typed_as_the_palette_opens_is_no_shortcut(make_gui):
    gui = make_gui()
    tool = gui.session.tool
    keys = [("left ctrl", True), ("left shift", True), ("p", True), ("p", False)]
    keys += [("left shift", False), ("left ctrl", False), ("c", True), ("c", False)]
    gui.host.frames(1, *(KeyEvent(key=key, pressed=pressed) for key, pressed in keys))
    gui.frames(12)
    assert gui.session.view.palette
    assert gui.session.tool == tool
