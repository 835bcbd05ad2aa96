"""The window as a whole: tools on the canvas, keys, panels, dialogs, undo, files."""

import math
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from imgui_bundle import imgui

from editor.actions import ACTIONS
from editor.base.events import KeyEvent
from editor.base.settings import Settings
from editor.documents.document import Document
from editor.play.mode import Mode
from editor.session import Session
from editor.toolkit import widgets
from editor.toolkit.keys import label
from editor.window.panels.help import rows_of
from editor.window.panels.menu import MENUS
from editor.worker.jobs import Worker
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Body, Circle, Level, Polygon
from kinetix.paths import levels_dir

BALL = Level(
    name="Ball",
    bodies=(
        Body(id=1, shape=Circle(radius=0.4), position=(2.5, 2.5)),
        Body(
            id=2,
            shape=Polygon(vertices=((-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2))),
            position=(1.0, 3.0),
        ),
    ),
)


@pytest.mark.parametrize(
    ("key", "shape", "sides"), [("c", Circle, 0), ("r", Polygon, 4)], ids=["circle", "rectangle"]
)
def test_draws_a_shape_by_dragging(gui, key, shape, sides):
    gui.key(key)
    gui.drag((2.0, 2.0), (2.5, 2.5))
    (body,) = gui.level.bodies
    assert isinstance(body.shape, shape)
    assert sides == 0 or len(body.shape.vertices) == sides
    assert gui.session.selection == (body.id,)
    assert gui.session.tool.id == "select"


def test_draws_a_triangle_by_clicking(gui):
    gui.key("t")
    for point in ((1.0, 1.0), (2.0, 1.0), (1.5, 2.0)):
        gui.click_world(*point)
    (body,) = gui.level.bodies
    assert len(body.shape.vertices) == 3


def test_typed_digits_set_the_size(gui):
    gui.key("c")
    x, y = gui.screen(2.0, 2.0)
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    gui.move(x + 40, y)
    gui.text("0.35")
    gui.button(x + 40, y, pressed=False)
    gui.frames(2)
    assert gui.level.bodies[0].shape.radius == pytest.approx(0.35)


def test_one_drag_is_one_entry_and_undo_takes_it_back(make_gui):
    gui = make_gui(level=BALL)
    before = gui.level
    gui.drag((2.5, 2.7), (3.25, 3.45))
    assert gui.level.body(1).position != before.body(1).position
    assert len(gui.session.document.history.entries) == 2
    gui.key("ctrl+z")
    assert gui.level == before
    gui.key("ctrl+shift+z")
    assert gui.level != before


def test_escape_during_a_drag_leaves_everything_as_it_was(make_gui):
    gui = make_gui(level=BALL)
    before = gui.level
    x, y = gui.screen(2.5, 2.7)
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    gui.move(x + 60, y - 30)
    assert gui.session.document.previewing
    gui.key("escape")
    gui.button(x + 60, y - 30, pressed=False)
    assert gui.level is before or gui.level == before
    assert not gui.session.document.dirty


def test_losing_the_focus_ends_a_gesture_and_releases_keys(make_gui):
    gui = make_gui(level=BALL)
    before = gui.level
    x, y = gui.screen(2.5, 2.7)
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    gui.move(x + 60, y - 30)
    gui.hold("9")
    gui.lose_focus()
    gui.frames(2)
    assert gui.level == before
    assert not gui.session.hands.held


def test_the_wheel_zooms_at_the_pointer(make_gui):
    gui = make_gui(level=BALL)
    # Dear ImGui's pointer stands on whole pixels.
    x, y = (float(round(value)) for value in gui.screen(1.2, 3.4))
    under = gui.session.camera.to_world((x, y))
    before = gui.session.camera.zoom
    gui.wheel(x, y, 3)
    assert gui.session.camera.to_world((x, y)) == pytest.approx(under, abs=1e-4)
    assert gui.session.camera.zoom == pytest.approx(before * 1.1**3)


@pytest.mark.parametrize("notches", [1e30, -1e30])
def test_a_wheel_that_says_nonsense_stops_at_the_bounds(make_gui, notches):
    gui = make_gui(level=BALL)
    before = gui.session.camera.zoom
    gui.wheel(600.0, 400.0, notches)
    assert not any("Traceback" in line for line in gui.session.log.lines)
    assert (gui.session.camera.zoom > before) == (notches > 0)


def test_a_right_drag_pans_and_a_right_click_lists(make_gui):
    gui = make_gui(level=BALL)
    centre = gui.session.camera.centre
    gui.drag((4.0, 4.0), (4.5, 4.0), button=3)
    assert gui.session.camera.centre[0] == pytest.approx(centre[0] - 0.5, abs=0.02)
    gui.click_world(2.5, 2.7, button=3)
    assert gui.session.prompts
    gui.click("list.0")
    assert gui.session.selection == (1,)


def test_the_inspector_drags_preview_and_commit_once(make_gui):
    gui = make_gui(level=BALL)
    gui.click("outliner.1")
    x, y = gui.probe("inspector.density").centre
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    for k in range(1, 8):
        gui.move(x + 6 * k, y)
    assert gui.session.document.previewing
    gui.button(x + 42, y, pressed=False)
    gui.frames(3)
    assert gui.level.body(1).density > 1.0
    assert len(gui.session.document.history.entries) == 2


def test_the_inspector_edits_many_at_once_and_shows_mixed_values(make_gui):
    gui = make_gui(level=BALL)
    gui.key("ctrl+a")
    gui.click("inspector.role.red")
    assert {body.role for body in gui.level.bodies} == {"red"}
    gui.click("inspector.fixed")
    assert all(body.fixed for body in gui.level.bodies)


def test_a_typed_value_commits_on_enter(make_gui):
    gui = make_gui(level=BALL)
    gui.click("outliner.1")
    x, y = gui.probe("inspector.shape.radius").centre
    # A double click turns a drag field into a text field.
    gui.move(x, y)
    for pressed in (True, False, True, False):
        gui.button(x, y, pressed=pressed)
    gui.frames(2)
    gui.key("ctrl+a")
    gui.text("0.25")
    gui.key("return")
    gui.frames(2)
    assert gui.level.body(1).shape.radius == pytest.approx(0.25)


def test_a_long_outline_costs_only_the_rows_in_sight_and_goes_to_what_is_selected(make_gui):
    bodies = [BALL.bodies[0].replace(id=k, position=(0.01 * k, 2.0)) for k in range(1, 401)]
    gui = make_gui(level=BALL.replace(bodies=tuple(bodies), next_id=401))

    def rows() -> set[int]:
        named = (name.split(".") for name in gui.session.probe if name.startswith("outliner."))
        return {int(parts[1]) for parts in named if len(parts) == 2 and parts[1].isdigit()}

    assert {1, 2, 3} <= rows()
    assert len(rows()) < 80
    gui.session.selection = (300,)
    gui.frames(4)
    assert {298, 299, 300, 301} <= rows()
    assert 1 not in rows()
    gui.click("outliner.302")
    assert gui.session.selection == (302,)


def test_selecting_never_changes_the_level(make_gui):
    gui = make_gui(level=BALL)
    for path in sorted(levels_dir().glob("[sml]/*.json"))[::4]:
        gui.open(path)
        before = gui.level
        ids = [entity.id for entity in before.entities()] + ["floor"]
        for entity in ids:
            gui.session.selection = (entity,)
            gui.frames(3)
        assert gui.level == before
        assert not gui.session.document.dirty


@pytest.mark.peer
def test_selecting_never_changes_a_published_level(make_gui, peer):
    gui = make_gui(level=BALL)
    for path in sorted((peer / "levels").glob("*/*.json"))[::4]:
        gui.open(path)
        before = gui.level
        for entity in before.entities():
            gui.session.selection = (entity.id,)
            gui.frames(1)
        assert gui.level == before


def test_a_chord_that_arrives_in_one_slow_frame_still_counts(make_gui):
    gui = make_gui(level=BALL)
    batch = [
        KeyEvent(key="left ctrl", pressed=True),
        KeyEvent(key="a", pressed=True),
        KeyEvent(key="left ctrl", pressed=False),
        KeyEvent(key="a", pressed=False),
    ]
    gui.host.frames(4, *batch)
    assert set(gui.session.selection) == {1, 2}


def test_arrows_and_letters_do_not_start_play(gui):
    for key in ("left", "right", "up", "down", "w", "a", "s", "d"):
        gui.key(key)
        assert gui.session.mode is Mode.EDIT


def test_help_names_exactly_the_keys_that_work(gui):
    shown = {keys for menu in MENUS for keys, _ in rows_of(gui.session, menu)}
    for action in ACTIONS:
        if action.keys:
            assert any(label(action.keys[0]) in keys.split("  ") for keys in shown), action.id


def test_every_action_stands_in_a_menu(gui):
    del gui
    for action in ACTIONS:
        assert action.menu in MENUS, action.id


def test_the_palette_runs_what_is_typed(make_gui):
    gui = make_gui(level=BALL)
    gui.key("ctrl+shift+p")
    gui.frames(3)
    gui.text("select all")
    gui.key("return")
    gui.frames(2)
    assert set(gui.session.selection) == {1, 2}
    assert not gui.session.view.palette


def test_f1_opens_help_and_escape_closes_it(gui):
    gui.key("f1")
    assert gui.session.view.help
    assert gui.shows("help.close")
    gui.key("escape")
    assert not gui.session.view.help


def test_closing_with_changes_asks_and_escape_keeps(gui):
    gui.key("c")
    gui.drag((2.0, 2.0), (2.5, 2.5))
    gui.key("ctrl+w")
    gui.frames(3)
    assert gui.shows("question.save") and gui.shows("question.discard")
    gui.key("escape")
    assert not gui.session.prompts
    assert len(gui.level.bodies) == 1
    gui.key("ctrl+w")
    gui.frames(3)
    gui.click("question.discard")
    gui.frames(2)
    assert not gui.level.bodies


def test_save_as_through_the_browser_and_open_again(gui, tmp_path: Path):
    gui.key("c")
    gui.drag((2.0, 2.0), (2.5, 2.5))
    gui.key("ctrl+s")
    gui.frames(4)
    gui.click("browser.name")
    gui.key("ctrl+a")
    gui.text(str(tmp_path / "mine.json"))
    gui.key("return")
    gui.frames(4)
    assert load_level(tmp_path / "mine.json").bodies == gui.level.bodies
    assert not gui.session.document.dirty
    gui.session.queue("file.open")
    gui.frames(4)
    gui.click("browser.mine.json")
    assert gui.session.prompts
    gui.click("browser.cancel")
    assert not gui.session.prompts


def test_problems_select_what_they_mean_and_mend_it(make_gui):
    gui = make_gui(level=BALL)
    gui.bring("problems")
    assert gui.shows("problems.E101")
    gui.click("outliner.1")
    gui.click("problems.E101.fix")
    gui.frames(2)
    assert gui.level.body(1).role == "green"
    gui.key("ctrl+z")
    assert gui.shows("problems.E101")


def test_history_jumps(make_gui):
    gui = make_gui(level=BALL)
    before = gui.level
    gui.click("outliner.1")
    gui.click("inspector.role.blue")
    gui.click("inspector.role.green")
    gui.session.document.jump(0)
    gui.frames(2)
    assert gui.level == before


def test_tabs_switch_documents(make_gui):
    gui = make_gui(level=BALL)
    gui.key("ctrl+n")
    assert gui.session.tabs.index_in_front == 1
    gui.click("tabs.0")
    gui.frames(2)
    assert gui.level.bodies == BALL.bodies


def test_a_failing_panel_does_not_end_the_app(make_gui, monkeypatch):
    gui = make_gui(level=BALL)
    inspector = next(panel for panel in gui.host.ui.workplace.panels if panel.id == "inspector")

    def explode(session: object) -> None:
        raise ZeroDivisionError("on purpose")

    monkeypatch.setattr(inspector, "draw", explode)
    before = gui.level
    gui.frames(3)
    assert any("on purpose" in toast.text for toast in gui.session.toasts)
    assert gui.level == before


def test_tab_hides_the_interface(gui):
    gui.key("tab")
    assert not gui.session.view.interface
    gui.frames(2)
    assert not gui.shows("menu.file")
    gui.key("tab")
    gui.frames(2)
    assert gui.shows("menu.file")


@pytest.mark.parametrize("scale", [0.75, 1.0, 1.5, 2.0])
def test_picking_works_at_any_scale(make_gui, scale):
    gui = make_gui(level=BALL, scale=scale, size=(round(1280 * scale), round(800 * scale)))
    gui.click_world(2.5, 2.7)
    assert gui.session.selection == (1,)
    gui.click_world(1.0, 3.0)
    assert gui.session.selection == (2,)


def test_edits_and_saves_without_jax(tmp_path: Path):
    script = f"""
        import sys
        sys.modules["jax"] = None
        from editor.hosts.headless import HeadlessHost
        from editor.hosts.replay import Replayer
        from editor.session import Session
        from pathlib import Path
        events = Path({str(tmp_path / "events.jsonl")!r})
        events.write_text('''
            {{"do":"tool","id":"circle"}}
            {{"do":"drag","from":[2,2],"to":[2.4,2]}}
            {{"do":"save","file":{str(tmp_path / "out.json")!r}}}
        '''.replace("{str(tmp_path / "out.json")!r}", '"{tmp_path / "out.json"}"'))
        host = HeadlessHost(Session())
        Replayer(host, events).run()
        host.close()
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(script)], check=True, timeout=60)
    assert len(load_level(tmp_path / "out.json").bodies) == 1


def test_a_level_opened_before_the_first_frame_is_shown_whole(make_gui):
    gui = make_gui(level=BALL)
    gui.frames(10)
    (x, y), (width, height) = gui.host.ui.workplace.canvas.area
    for corner in ((0.0, 0.0), (5.0, 5.0)):
        at = gui.screen(*corner)
        assert x < at[0] < x + width and y < at[1] < y + height


def test_the_file_menu_ends_with_quit_and_has_some_rows_only_while_they_work(gui, tmp_path):
    path = tmp_path / "mine.json"
    save_level(BALL, path)
    gui.open(path)
    gui.click("menu.file")
    shown = [name for name in gui.session.probe if name.startswith("menu.file.")]
    assert max(shown, key=lambda name: gui.probe(name).low[1]) == "menu.file.quit"
    assert gui.probe("menu.file.open").low[1] < gui.probe("menu.recent").low[1]
    assert gui.probe("menu.recent").low[1] < gui.probe("menu.file.save").low[1]
    assert not gui.shows("menu.file.reload")
    gui.session.document.outside = "changed"
    gui.frames(2)
    assert gui.shows("menu.file.reload")


def test_recent_files_are_told_by_name_and_folder_in_a_narrow_list(make_gui, tmp_path):
    gui = make_gui(size=(800, 600))
    deep = tmp_path / "/".join(["a folder with a long name"] * 4)
    deep.mkdir(parents=True)
    save_level(BALL, deep / "mine.json")
    gui.session.settings.recents = [str(deep / "mine.json")]
    gui.click("menu.file")
    gui.click("menu.recent")
    gui.frames(20)
    row = gui.probe("menu.recent.0")
    assert row.low[0] > gui.probe("menu.recent").low[0] and row.high[0] - row.low[0] < 400
    gui.click("menu.recent.0")
    gui.frames(4)
    assert gui.session.document.path == deep / "mine.json"


def test_the_suites_scenes_are_examples(gui):
    for name in ("menu.file", "menu.examples", "menu.scenes.joints", "menu.scene.D10"):
        gui.click(name)
        gui.frames(20)
    document = gui.session.document
    assert document.title == "Car" and document.path is None and not document.dirty
    assert len(gui.level.joints) == 2
    (low, high) = gui.host.ui.workplace.canvas.area
    for body in gui.level.bodies[1:]:
        x, y = gui.screen(*body.position)
        assert low[0] < x < low[0] + high[0] and low[1] < y < low[1] + high[1]


def test_a_key_is_changed_with_the_mouse_and_the_keyboard(gui):
    gui.session.queue("app.keys")
    gui.frames(4)
    gui.click("keys.search")
    gui.text("circle")
    gui.click("keys.tool.circle")
    gui.key("r")
    assert gui.session.tool.id == "select", "the key must not do what it did"
    gui.click("keys.take")
    gui.key("escape")
    assert not gui.shows("keys.close")
    gui.key("r")
    assert gui.session.tool.id == "circle"
    gui.session.queue("app.keys")
    gui.frames(3)
    gui.click("keys.reset_all")
    gui.key("escape")
    assert gui.session.settings.keys, "it asks first"
    gui.click("keys.reset_all")
    gui.click("question.reset")
    gui.key("escape")
    gui.key("r")
    assert gui.session.tool.id == "rectangle"


def test_a_field_stops_waiting_for_a_key_once_the_search_is_used(gui):
    gui.session.queue("app.keys")
    gui.frames(4)
    gui.click("keys.file.open")
    gui.click("keys.search")
    assert gui.session.hands.capture is None
    gui.key("k")
    assert gui.session.settings.keys == {}
    gui.text("ope")
    gui.click("keys.search.clear")
    gui.click("keys.file.open")
    gui.key("q")
    assert gui.shows("keys.take")
    gui.click("keys.search")
    assert not gui.shows("keys.take"), "the question is about a row that may go"


def test_driving_keys_lose_their_key_and_get_it_back(gui):
    gui.session.queue("app.keys")
    gui.frames(4)
    gui.click("keys.search")
    gui.text("group 1, for")
    gui.click("keys.drive.0.1")
    gui.key("ctrl+k")
    assert gui.session.settings.controls == {}
    assert "Ctrl+K cannot drive" in gui.session.toasts[-1].text
    gui.click("keys.clear.drive.0.1")
    assert "left" not in gui.session.control_keys
    gui.click("keys.reset.drive.0.1")
    assert gui.session.settings.controls == {}


def test_the_reset_of_a_key_names_the_key_that_is_taken(gui):
    gui.session.settings.keys |= {"edit.redo": ["f9"], "tool.circle": ["ctrl+y"]}
    gui.session.queue("app.keys")
    gui.frames(4)
    gui.click("keys.search")
    gui.text("redo")
    gui.click("keys.reset.edit.redo")
    gui.frames(2)
    assert gui.session.toasts[-1].text == "Ctrl+Y is Circle now."
    assert gui.session.settings.keys["edit.redo"] == ["f9"]


def test_ctrl_tab_changes_the_level_and_no_panel(gui):
    for name in ("One", "Other"):
        gui.session.open_tab(Document(BALL.replace(name=name)))
    gui.frames(20)
    first = gui.session.tabs.index_in_front
    gui.hold("left ctrl")
    gui.hold("tab")
    gui.frames(3)
    assert imgui.get_current_context().nav_windowing_target is None
    gui.hold("tab", pressed=False)
    gui.hold("left ctrl", pressed=False)
    assert gui.session.tabs.index_in_front != first


def test_the_map_moves_the_view_and_draws_nothing_in_the_level(make_gui):
    gui = make_gui(level=BALL)
    gui.session.queue("view.minimap")
    gui.session.queue("tool.circle")
    gui.frames(3)
    gui.session.camera = gui.session.camera.zoomed(3.0, gui.screen(2.5, 2.5))
    gui.frames(2)
    low, size = gui.host.ui.workplace.canvas.area
    side = gui.host.ui.workplace.canvas._minimap._side
    corner = (low[0] + size[0] - side - 14, low[1] + size[1] - side - 14)
    gui.click_at(corner[0] + side * 0.25, corner[1] + side * 0.25)
    assert gui.session.camera.centre == pytest.approx((1.25, 3.75), abs=0.05)
    assert gui.level == BALL.replace(next_id=gui.level.next_id)


def test_the_first_frames_ask_nothing_of_the_simulation(make_gui):
    asked = []
    worker = Worker(perform=lambda request, progress: asked.append(request))
    gui = make_gui(session=Session(settings=Settings(), worker=worker, level=BALL))
    gui.frames(15)
    assert worker.idle and asked == []


@pytest.mark.parametrize("name", ["9" * 400, "a/" * 300, "\ud800", "\x1b"])
def test_a_name_that_no_file_can_have_breaks_no_dialog(gui, name):
    gui.session.queue("file.save_as")
    gui.frames(4)
    gui.click("browser.name")
    gui.text(name)
    gui.frames(4)
    assert not [line for line in gui.session.log.lines if "Traceback" in line]
    gui.click("browser.cancel")
    gui.frames(4)
    assert not gui.session.prompts


def test_a_window_that_is_resized_moves_nothing_under_a_pointer_that_drags(make_gui):
    gui = make_gui(level=BALL)
    x, y = gui.screen(2.5, 2.7)
    gui.move(x, y)
    gui.button(x, y, pressed=True)
    gui.move(x + 60, y - 30)
    there = gui.session.document.shown.bodies[0].position
    width, height = gui.host.size
    gui.host.size = (width - 200, height - 150)
    gui.frames(10)
    gui.move(x + 61, y - 30)
    gui.button(x + 61, y - 30, pressed=False)
    moved = gui.level.bodies[0].position
    assert math.dist(moved, there) < 0.05
    gui.frames(10)
    # Then the arena is shown whole again.
    assert gui.session.camera.size[0] < width - 200
    left, right = gui.screen(0.0, 2.0)[0], gui.screen(5.0, 2.0)[0]
    assert left >= gui.session.camera.origin[0] - 1
    assert right <= gui.session.camera.origin[0] + gui.session.camera.size[0] + 1


def test_a_filter_that_finds_nothing_says_so_and_is_cleared_by_a_click(make_gui, monkeypatch):
    gui = make_gui(level=BALL)
    said = []
    monkeypatch.setattr(widgets, "empty_state", lambda _, *words: said.append(words[-1]))
    gui.click("outliner.filter")
    gui.text("ball")
    gui.text("zzz")
    assert "Nothing here is called ballzzz." in said
    gui.click("outliner.filter.clear")
    said.clear()
    gui.frames(2)
    assert not any("is called" in words for words in said) and gui.shows("outliner.1")


def test_the_words_of_the_gallerys_search_are_cleared_by_a_click(gui):
    gui.key("ctrl+g")
    gui.frames(6)
    gui.click("gallery.search")
    gui.text("zzz")
    assert gui.session.gallery.wish.words == "zzz"
    gui.click("gallery.search.clear")
    assert gui.session.gallery.wish.words == ""


def test_no_two_panels_have_one_sign(gui):
    signs = [panel.icon for panel in gui.host.ui.workplace.panels]
    assert len(set(signs)) == len(signs)


def test_the_map_shows_what_lies_outside_of_the_arena_in_edit(make_gui):
    far = BALL.bodies[0].replace(id=7, position=(-2.0, 6.5))
    gui = make_gui(level=BALL.replace(bodies=(*BALL.bodies, far), next_id=8))
    gui.session.queue("view.minimap")
    gui.frames(4)
    minimap = gui.host.ui.workplace.canvas._minimap
    low, side, camera = minimap._low, minimap._side, minimap._camera
    for world in ((-2.0, 6.5), (0.0, 0.0), (5.0, 0.0)):
        x, y = camera.to_screen(world)
        assert low[0] <= x <= low[0] + side and low[1] <= y <= low[1] + side
    gui.click_at(*camera.to_screen((-2.0, 6.5)))
    assert math.dist(gui.session.camera.centre, (-2.0, 6.5)) < 0.1


def test_a_name_of_two_lines_is_shown_in_one(make_gui):
    gui = make_gui(level=Level(name="a\nb"))
    low, high = gui.probe("level.name").low, gui.probe("level.name").high
    assert high[1] - low[1] <= 1.1 * imgui.get_frame_height()
    gui.click("level.name")
    gui.key("end")
    gui.text("c")
    gui.key("return")
    assert gui.level.name == "a bc"
