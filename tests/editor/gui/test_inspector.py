"""The inspector besides fields to edit: names, angles, an arena of the level's own."""

import math
import time

import pytest
from imgui_bundle import imgui

from editor.base.events import QuitEvent
from editor.base.settings import Settings
from editor.documents.commands.fields import SetField, read_field
from editor.documents.commands.group import Remove
from editor.documents.commands.sizes import extent
from editor.documents.document import Document
from editor.editing.picking import joint_position
from editor.toolkit import widgets
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Arena, ArenaBody, Body, Circle, Geometry, Level
from tests.editor.core.helpers import a_level, a_session


def type_into(gui, name, words):
    """A double click turns a drag field into a text field."""
    x, y = gui.probe(name).centre
    gui.move(x, y)
    for pressed in (True, False, True, False):
        gui.button(x, y, pressed=pressed)
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text(words)
    gui.key("return")
    gui.frames(2)


@pytest.mark.parametrize(("radians", "angle"), [(False, math.radians(1.5)), (True, 1.5)])
def test_angles_are_typed_in_the_unit_that_is_shown(make_gui, radians, angle):
    gui = make_gui(level=a_level())
    gui.session.settings.radians = radians
    gui.click("outliner.1")
    type_into(gui, "inspector.angle", "1.5")
    assert gui.level.body(1).angle == pytest.approx(angle)


def test_an_arena_of_the_levels_own_is_shown_and_cannot_be_changed(make_gui):
    level = a_level()
    corners = ((-2.0, -0.2), (2.0, -0.2), (2.0, 0.2), (-2.0, 0.2))
    own = ArenaBody(geometry=Geometry(position=(2.5, 0.1), vertices=corners))
    gui = make_gui(level=level.replace(arena=Arena(floor=own)))
    for part, shown in (("floor", True), ("ceiling", False)):
        gui.session.selection = (part,)
        gui.frames(3)
        assert gui.shows("inspector.role.red")
        assert gui.shows("inspector.geometry") is shown


def test_a_thing_is_renamed_by_a_double_click_in_the_outliner(make_gui):
    gui = make_gui(level=a_level())
    x, y = gui.probe("outliner.1").centre
    gui.move(x, y)
    for pressed in (True, False, True, False):
        gui.button(x, y, pressed=pressed)
    gui.frames(4)
    gui.text("Chassis")
    gui.key("return")
    gui.frames(3)
    assert gui.session.document.name_of(1) == "Chassis"
    assert gui.session.document.history.undo_label == "Name → Chassis"


def test_a_right_click_in_the_outliner_opens_the_menu_of_the_canvas(make_gui):
    gui = make_gui(level=a_level())
    gui.click_at(*gui.probe("outliner.1").centre, button=3)
    gui.frames(4)
    (menu,) = gui.session.prompts
    ids = [choice.id for choice in menu.choices]
    assert "edit.delete" in ids and "change.make green" in ids
    gui.session.answer(menu, "edit.delete")
    gui.frames(3)
    assert 1 not in [body.id for body in gui.level.bodies]


def test_larger_text_makes_rows_higher_and_is_kept(make_gui, tmp_path):
    gui = make_gui(level=a_level())
    before = gui.probe("outliner.1")
    gui.session.settings.text_scale = 1.3
    gui.frames(3)
    after = gui.probe("outliner.1")
    assert after.high[1] - after.low[1] > 1.1 * (before.high[1] - before.low[1])
    gui.session.settings.save(tmp_path / "settings.json")
    assert Settings.load(tmp_path / "settings.json").text_scale == 1.3


def edit_text(gui, name, words):
    """One click turns a field into a text, all of it selected."""
    gui.click(name)
    gui.text(words)
    gui.key("return")
    gui.frames(2)


def test_a_name_is_typed_into_the_inspector_and_undone(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    edit_text(gui, "inspector.name", "Chassis")
    assert gui.level.body(1).name == "Chassis"
    gui.session.queue("edit.undo")
    gui.frames(2)
    assert gui.level == a_level()


def test_a_name_that_was_typed_is_kept_when_the_selection_goes(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    gui.click("inspector.name")
    gui.text("Chassis")
    gui.click_world(3.0, 1.2)  # nothing lies there
    gui.frames(3)
    assert gui.session.selection == ()
    assert gui.level.body(1).name == "Chassis"
    assert gui.level.body(2).name is None


def test_a_name_for_what_is_gone_says_so(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.3")
    gui.click("inspector.name")
    gui.text("Hero")
    gui.session.execute(Remove(ids=(3,)))
    gui.frames(4)
    assert gui.session.toasts[-1].text == "The item to be named Hero no longer exists."


def test_names_are_written_on_the_canvas_when_asked_for(make_gui):
    gui = make_gui(level=a_level())
    gui.key("shift+n")
    assert gui.session.settings.names
    assert "has a name yet" in gui.session.toasts[-1].text
    gui.click("outliner.1")
    edit_text(gui, "inspector.name", "Chassis")
    gui.frames(3)
    assert gui.level.body(1).name == "Chassis"
    gui.key("escape")
    gui.key("shift+n")
    assert not gui.session.settings.names


@pytest.mark.parametrize(("typed", "value"), [("2*3", 6.0), ("1,5", 1.5), ("+=0.5", 1.5)])
def test_fields_take_sums(make_gui, typed, value):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    edit_text(gui, "inspector.density", typed)
    assert gui.level.body(1).density == pytest.approx(value)
    type_into(gui, "inspector.friction", "1/4")
    assert gui.level.body(1).friction == pytest.approx(0.25)
    edit_text(gui, "level.gravity.1", "-2*3")
    assert gui.level.gravity[1] == pytest.approx(-6.0)


def test_what_is_not_a_number_says_so_and_changes_nothing(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    edit_text(gui, "inspector.density", "heavy")
    assert gui.level == a_level()
    assert "“heavy” is not a number" in gui.session.toasts[-1].text


@pytest.mark.parametrize("typed", ["0", "1e-9"])
def test_a_value_beyond_the_limits_stops_there_and_says_so(make_gui, typed):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    edit_text(gui, "inspector.density", typed)
    assert gui.level.body(1).density == pytest.approx(1e-3)
    said = gui.session.toasts[-1].text
    assert said == f"Density is at least 0.001 kg/m²: {typed} became 0.001 kg/m²."


def test_a_change_beyond_the_limits_stops_there_too(make_gui):
    gui = make_gui(level=a_level())
    gui.session.selection = (5,)
    gui.frames(3)
    edit_text(gui, "inspector.joint.x", "+=20")
    assert joint_position(gui.level, gui.level.joints[0]) == pytest.approx((15.0, 2.0), abs=1e-5)
    said = gui.session.toasts[-1].text
    assert said.endswith("is at most 15.00 m: 22.20 m became 15.00 m.")


def test_several_things_are_changed_each_from_its_own_value(make_gui):
    level = a_level()
    first, second, *rest = level.bodies
    level = level.replace(bodies=(first, second.replace(density=3.0), *rest))
    gui = make_gui(level=level, size=(1440, 1400))
    gui.session.selection = (1, 2)
    gui.frames(2)
    edit_text(gui, "inspector.density", "*=2")
    assert [gui.level.body(i).density for i in (1, 2)] == pytest.approx([2.0, 6.0])
    x, y = gui.probe("inspector.density").centre
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    for k in range(1, 12):
        gui.move(x + 6 * k, y)
    gui.button(x + 66, y, pressed=False)
    gui.frames(2)
    added = gui.level.body(1).density - 2.0
    assert added > 0.05
    assert gui.level.body(2).density == pytest.approx(6.0 + added, abs=1e-5)
    edit_text(gui, "inspector.density", "5")
    assert [gui.level.body(i).density for i in (1, 2)] == pytest.approx([5.0, 5.0])


def begin_drag(gui, name):
    """Drag a number, and keep the button down."""
    x, y = gui.probe(name).centre
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    for k in range(1, 6):
        gui.move(x + 12 * k, y)
    return x + 60, y


@pytest.mark.parametrize(
    ("key", "panels"),
    [("escape", False), ("space", False), ("space", True), ("ctrl+n", False), ("ctrl+g", False)],
)
def test_a_drag_that_is_broken_off_leaves_nothing_behind(make_gui, key, panels):
    gui = make_gui(level=a_level(), size=(1440, 1400))
    gui.session.view.panels_in_play = panels
    gui.click("outliner.1")
    document = gui.session.document
    at = begin_drag(gui, "inspector.density")
    assert document.shown.body(1).density > 1.5
    gui.key(key)
    assert not document.previewing
    gui.button(*at, pressed=False)
    gui.frames(3)
    assert document.level == document.shown == a_level()
    assert not any("Stop playing" in line for line in gui.session.log.lines)


def test_after_a_drag_that_was_broken_off_a_click_changes_nothing(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    at = begin_drag(gui, "inspector.density")
    gui.key("escape")
    gui.button(*at, pressed=False)
    gui.click("outliner.1")
    gui.click("inspector.density")  # it is typed into
    gui.key("escape")
    gui.frames(2)
    assert gui.level == a_level()


def test_a_drag_does_not_go_on_in_another_level(make_gui):
    gui = make_gui(level=a_level())
    document = gui.session.document
    document.mark_unsaved()
    x, y = begin_drag(gui, "level.max_timesteps")
    assert document.shown.max_timesteps != 256
    gui.key("ctrl+n")
    assert gui.session.document is not document
    gui.move(x + 40, y)
    gui.button(x + 40, y, pressed=False)
    gui.frames(3)
    for each in (document, gui.session.document):
        assert each.level.max_timesteps == each.shown.max_timesteps == 256


def test_tab_goes_to_the_next_field_and_escape_keeps_the_value(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    gui.click("inspector.density")
    gui.text("4")
    gui.key("tab")
    gui.frames(2)
    assert gui.level.body(1).density == pytest.approx(4.0)
    gui.text("0.3")
    gui.key("return")
    assert gui.level.body(1).friction == pytest.approx(0.3)
    gui.click("inspector.density")
    gui.text("9")
    gui.key("escape")
    gui.frames(2)
    assert gui.level.body(1).density == pytest.approx(4.0)
    assert gui.session.selection == (1,)


def test_what_is_being_typed_goes_to_what_was_selected_then(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    gui.click("inspector.density")
    gui.text("7")
    gui.click_world(4.0, 3.0)
    assert gui.session.selection == (3,)
    assert gui.level.body(1).density == pytest.approx(7.0)
    assert gui.level.body(3).density == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("field", "typed"),
    [
        ("inspector.density", "7"),
        ("inspector.name", "Chassis"),
        ("level.max_timesteps", "99"),
        ("level.name", "Mine"),
        ("level.description", "Jump twice"),
    ],
)
def test_what_is_being_typed_stays_with_its_level_when_another_comes_in_front(
    make_gui, field, typed
):
    gui = make_gui(level=a_level(), size=(1440, 1400))
    document = gui.session.document
    gui.click("outliner.1")
    gui.click(field)
    gui.key("ctrl+a")
    gui.text(typed)
    other = Document(a_level())
    other.selection = (1,)
    gui.session.open_tab(other)  # as a finished job does
    gui.frames(3)
    gui.key("return")
    gui.click("outliner.3")
    gui.frames(3)
    assert other.level == a_level()
    assert document.level != a_level()


@pytest.mark.parametrize(
    ("radians", "label"), [(False, "Angle → 90.0°"), (True, "Angle → 1.57 rad")]
)
def test_the_history_speaks_of_angles_as_the_fields_do(make_gui, radians, label):
    gui = make_gui(level=a_level())
    gui.session.settings.radians = radians
    gui.click("outliner.1")
    edit_text(gui, "inspector.angle", "1.57" if radians else "90")
    assert gui.session.document.history.undo_label == label


def width_and_height(body):
    xs, ys = zip(*body.shape.vertices, strict=True)
    return max(xs) - min(xs), max(ys) - min(ys)


def test_width_and_height_are_typed_and_the_middle_stays(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    edit_text(gui, "inspector.width", "0.8")
    edit_text(gui, "inspector.height", "/=2")
    assert width_and_height(gui.level.body(1)) == pytest.approx((0.8, 0.2), abs=1e-5)
    assert gui.level.body(1).position == pytest.approx((2.0, 2.0))
    edit_text(gui, "inspector.width", "0")
    assert width_and_height(gui.level.body(1))[0] == pytest.approx(0.02, abs=1e-4)
    assert gui.session.toasts[-1].text.startswith("Width is at least 0.02 m")


def test_mass_and_inertia_are_shown_and_follow(make_gui):
    gui = make_gui(level=a_level())
    gui.click("outliner.1")
    assert gui.shows("inspector.mass")
    assert gui.shows("inspector.inertia")


def test_a_corner_is_typed_and_a_hollow_shape_refused(make_gui):
    gui = make_gui(level=a_level(), size=(1440, 1400))
    gui.click("outliner.1")
    gui.click("inspector.corners")
    gui.frames(3)
    edit_text(gui, "inspector.corner.0.x", "2.4")
    corners = [(x + 2.0, y + 2.0) for x, y in a_level().body(1).shape.vertices]
    from kinetix.level.geometry import world_vertices

    found = sorted(world_vertices(gui.level.body(1)))
    expected = sorted([(2.4, 2.2), *corners[1:]])
    for corner, wanted in zip(found, expected, strict=True):
        assert corner == pytest.approx(wanted, abs=1e-4)
    before = gui.level
    edit_text(gui, "inspector.corner.0.x", "1.0")
    assert gui.level == before
    assert "cannot go there" in gui.session.toasts[-1].text


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_a_corner_goes_back_and_joints_and_thrusters_stay(make_gui, angle):
    level = a_level()
    level = level.replace(bodies=(level.bodies[0].replace(angle=angle), *level.bodies[1:]))
    gui = make_gui(level=level, size=(1440, 1400))
    gui.click("outliner.1")
    gui.click("inspector.corners")
    gui.frames(3)
    assert not gui.shows("reset.corner.0")
    edit_text(gui, "inspector.corner.0.x", "2.6")
    assert gui.level.body(1).position != level.body(1).position
    gui.click("reset.corner.0")
    assert gui.level.body(1) == level.body(1)
    assert gui.level.joints[0].anchor_a == pytest.approx(level.joints[0].anchor_a, abs=1e-6)
    assert gui.level.thrusters[0].position == pytest.approx(level.thrusters[0].position, abs=1e-6)
    assert gui.session.document.history.undo_label == "Reset corners"
    assert not gui.shows("reset.corner.0")


def test_the_bodies_and_the_place_of_a_joint_can_be_changed(make_gui):
    gui = make_gui(level=a_level())
    gui.session.selection = (5,)
    gui.frames(3)
    gui.click("inspector.body_b")
    gui.click("inspector.body_b.3")
    joint = gui.level.joints[0]
    assert (joint.a, joint.b) == (1, 3)
    edit_text(gui, "inspector.joint.x", "1.9")
    assert joint_position(gui.level, gui.level.joints[0])[0] == pytest.approx(1.9, abs=1e-5)
    gui.click("inspector.body_a")
    gui.click("inspector.body_a.3")
    assert "two different bodies" in gui.session.toasts[-1].text


@pytest.mark.parametrize(
    ("path", "typed"), [("angle", "30"), ("angular_velocity", "20"), ("density", "3")]
)
def test_fields_have_an_arrow_back_to_the_default(make_gui, path, typed):
    gui = make_gui(level=a_level(), size=(1440, 1400))
    gui.click("outliner.1")
    before = gui.level.body(1)
    assert not gui.shows(f"reset.{path}")
    edit_text(gui, f"inspector.{path}", typed)
    gui.click(f"reset.{path}")
    assert gui.level.body(1) == before
    edit_text(gui, "inspector.velocity.x", "2")
    gui.click("reset.velocity")
    assert gui.level.body(1) == before


RESETS = {
    "shape.radius": (2, "shape.radius", 0.4, 0.15),
    "fixed": (2, "fixed", True, False),
    "density": (2, "density", 3.0, 1.0),
    "collision": (2, "collision", "ghost", "normal"),
    "role": (2, "role", "red", "none"),
    "angle": (1, "angle", 0.5, 0.0),
    "position": (1, "position", (1.0, 1.5), (2.0, 2.0)),
    "velocity": (1, "velocity", (1.0, 0.0), (0.0, 0.0)),
    "motor.speed": (5, "motor.speed", 3.0, 1.0),
    "motor.on": (5, "motor.on", False, True),
    "motor.auto": (5, "motor.auto", True, False),
    "motor.binding": (5, "motor.binding", 2, 0),
    "limits.on": (5, "limits.on", True, False),
    "limits.max": (5, "limits.max", 1.0, 0.0),
    "reference_angle": (5, "reference_angle", 0.25, 0.0),
    "power": (6, "power", 5.0, 1.0),
    "binding": (6, "binding", 1, 0),
}
"""Arrow: entity, field, another value, what the arrow sets it back to."""


@pytest.mark.parametrize("arrow", RESETS)
def test_every_field_can_be_set_back(make_gui, arrow):
    entity, field, other, back = RESETS[arrow]
    gui = make_gui(level=a_level(), size=(1440, 1400))
    gui.session.selection = (entity,)
    gui.frames(3)
    gui.session.queue(SetField(ids=(entity,), field=field, value=other))
    gui.frames(3)
    gui.click(f"reset.{arrow}")
    now = read_field(gui.level.entity(entity), field)
    assert now == pytest.approx(back) if isinstance(back, float | tuple) else now == back
    assert not gui.shows(f"reset.{arrow}")


def test_several_things_go_back_each_to_its_own_place(make_gui):
    gui = make_gui(level=a_level(), size=(1440, 1400))
    gui.session.selection = (1, 3)
    gui.frames(3)
    gui.session.queue(SetField(ids=(1, 3), field="position", value=(1.0, 1.0)))
    gui.frames(3)
    gui.click("reset.position")
    assert gui.level.bodies == a_level().bodies
    assert gui.session.document.history.undo_label == "Reset position"


def test_a_size_and_the_level_go_back(make_gui):
    gui = make_gui(level=a_level(), size=(1440, 1400))
    gui.session.selection = (1,)
    gui.frames(3)
    edit_text(gui, "inspector.width", "1")
    assert gui.level.thrusters[0].position[0] == pytest.approx(-0.375)
    gui.click("reset.width")
    # What hangs on the shape comes back with it, up to rounding.
    assert extent(gui.level.body(1).shape, 0) == pytest.approx(0.4)
    assert gui.level.thrusters[0].position == pytest.approx(a_level().thrusters[0].position)
    assert not gui.shows("reset.width")
    edit_text(gui, "level.gravity.1", "-3")
    gui.click("reset.level.gravity")
    edit_text(gui, "level.max_timesteps", "99")
    gui.click("reset.level.max_timesteps")
    assert (gui.level.gravity, gui.level.max_timesteps) == (a_level().gravity, 256)


def test_many_selected_things_cost_in_proportion(make_gui):
    """Four times as many things cost about four times as much, not sixteen times."""

    def frame(count):
        bodies = [
            Body(
                id=k + 1,
                shape=Circle(radius=0.05),
                position=(0.1 + 0.15 * (k % 30), 0.6 + 0.15 * (k // 30)),
            )
            for k in range(count)
        ]
        gui = make_gui(level=Level(name="Many", bodies=tuple(bodies), next_id=count + 1))
        gui.session.selection = tuple(body.id for body in bodies)
        gui.frames(6)
        took = []
        for _ in range(9):
            start = time.process_time()
            gui.frames(1)
            took.append(time.process_time() - start)
        return min(took)

    few, many = frame(120), frame(480)
    assert many < 8 * few, (few, many)


def test_the_arrow_back_is_in_sight_with_larger_text(make_gui):
    session = a_session()
    session.settings.text_scale = 1.3
    gui = make_gui(session=session, size=(1280, 800), scale=1.5)
    gui.frames(40)
    session.selection = (1,)
    gui.session.queue(SetField(ids=(1,), field="angle", value=0.3))
    gui.frames(6)
    room = imgui.internal.find_window_by_name("###panel-inspector").work_rect
    assert gui.probe("reset.angle").high[0] <= room.max.x + 0.5


@pytest.fixture
def opened(make_gui, tmp_path):
    """A level of the user's, and its file."""
    path = tmp_path / "mine.json"
    save_level(a_level(), path)
    gui = make_gui()
    gui.open(path)
    return gui, path


@pytest.fixture
def saved(opened):
    """The same, its description being typed."""
    gui, path = opened
    gui.click("level.description")
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text("Jump twice")
    return gui, path


def test_what_is_being_typed_is_saved_too(saved):
    gui, path = saved
    gui.key("ctrl+s")
    gui.frames(2)
    assert load_level(path).description == "Jump twice"
    assert not gui.session.document.dirty


def test_of_a_text_without_room_the_beginning_is_kept_and_that_is_said(saved):
    gui, path = saved
    gui.click("level.name")
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text("long " * 40)
    gui.key("ctrl+s")
    gui.frames(2)
    assert load_level(path).name == ("long " * 24).rstrip()
    assert any("120 characters are kept of 200" in line for line in gui.session.log.lines)


def test_closing_the_window_asks_about_what_is_being_typed(saved):
    gui, _ = saved
    gui.host.frames(1, QuitEvent())
    gui.frames(3)
    assert gui.session.document.level.description == "Jump twice"
    assert [prompt.title for prompt in gui.session.prompts] == ["Unsaved changes"]
    assert not gui.session.quitting


def test_a_number_that_is_being_typed_is_saved_too(opened):
    gui, path = opened
    gui.click("outliner.1")
    x, y = gui.probe("inspector.density").centre
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    gui.button(x, y, pressed=False)
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text("3")
    gui.key("ctrl+s")
    gui.frames(2)
    assert load_level(path).body(1).density == 3.0


def test_a_text_keeps_the_keys_that_edit_it(saved):
    gui, path = saved
    gui.key("ctrl+z")
    gui.key("ctrl+a")
    gui.text("s")
    assert load_level(path).description == "" and not gui.session.document.dirty
    gui.key("return")


def test_tags_are_taken_as_people_type_them_and_what_is_none_is_said(saved):
    gui, path = saved
    gui.click("level.tags")
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text("Wheels, jump a/b")
    gui.key("ctrl+s")
    gui.frames(2)
    assert load_level(path).tags == ("wheels", "jump")
    assert any("Not a tag: a/b" in line for line in gui.session.log.lines)


def test_a_new_level_is_named_by_a_click_and_typing(make_gui):
    gui = make_gui(size=(1440, 900))
    assert gui.level.name == "Untitled"
    gui.click("level.name")
    gui.frames(2)
    gui.key("return")
    assert gui.level.name == "Untitled" and gui.session.log.lines == ()
    gui.click("level.name")
    gui.frames(2)
    gui.text("Große Brücke")
    gui.key("return")
    assert gui.level.name == "Große Brücke"
    gui.click("level.name")
    gui.frames(2)
    gui.key("end")
    gui.text(" 2")
    gui.key("return")
    assert gui.level.name == "Große Brücke 2"


def test_a_level_keeps_its_name_where_none_is_typed(saved):
    gui, path = saved
    before = gui.session.document.level.name
    gui.click("level.name")
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text("   ")
    gui.key("ctrl+s")
    gui.frames(2)
    assert load_level(path).name == before
    assert any("A level needs a name." in line for line in gui.session.log.lines)


def test_a_long_message_leaves_the_window_in_sight(saved):
    gui, _ = saved
    gui.session.toast("x" * 5000)
    assert len(gui.session.toasts[-1].text) < 420
    assert any("x" * 5000 in line for line in gui.session.log.lines)


def test_a_save_ends_an_open_menu_and_saves(saved):
    gui, path = saved
    gui.click("menu.edit")
    gui.frames(2)
    gui.key("ctrl+s")
    gui.frames(3)
    assert not gui.session.document.dirty
    assert any(f"Saved {path.name}" in line for line in gui.session.log.lines)
    assert not imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)


def test_a_long_name_in_the_outliner_leaves_room_for_keys_and_signs(make_gui, monkeypatch):
    told = []
    monkeypatch.setattr(widgets, "tooltip", lambda *words, **options: told.append((words, options)))
    gui = make_gui(level=a_level())
    short, fitted = gui.probe("outliner.1"), []
    cut = widgets.fitted

    def note(words, room):
        fitted.append((words, cut(words, room), room))
        return fitted[-1][1]

    monkeypatch.setattr(widgets, "fitted", note)
    name = "A wheel of an uncommonly long name that nobody would read"
    gui.session.execute(SetField(ids=(1,), field="name", value=name))
    gui.move(*short.centre)
    gui.frames(30)
    (_, shown, room) = next(each for each in fitted if each[0] == name)
    assert shown.endswith("…") and room < short.high[0] - short.low[0]
    assert ((name,), {"own": True}) in told
