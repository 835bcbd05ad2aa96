"""Layouts: those that come with the app, and those that are kept under a name."""

from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from editor.agents.attempt_paths import Ways
from editor.agents.evaluation import Plan
from editor.base.events import KeyEvent
from editor.base.settings import Settings
from editor.session import Session
from editor.worker.requests import AttemptPaths
from tests.editor.core.helpers import a_session


def apply(gui, action):
    gui.session.queue(action)
    gui.frames(8)


def height_of_canvas(gui):
    probe = gui.probe("canvas")
    return probe.high[1] - probe.low[1]


def width_of_canvas(gui):
    probe = gui.probe("canvas")
    return probe.high[0] - probe.low[0]


def test_the_apps_own_layouts_differ_and_edit_is_the_first(gui):
    first = gui.probe("canvas")
    apply(gui, "view.layout_evaluate")
    assert height_of_canvas(gui) < 0.8 * (first.high[1] - first.low[1])
    apply(gui, "view.layout_play")
    assert width_of_canvas(gui) > 1.2 * (first.high[0] - first.low[0])
    apply(gui, "view.layout_edit")
    again = gui.probe("canvas")
    assert (again.low, again.high) == (
        pytest.approx(first.low, abs=2),
        pytest.approx(first.high, abs=2),
    )


def test_a_kept_layout_comes_back_in_this_run_and_in_the_next(make_gui, tmp_path: Path):
    gui = make_gui()
    apply(gui, "view.layout_play")
    wide = width_of_canvas(gui)
    apply(gui, "view.keep_layout")
    gui.text("Mine")
    gui.click("line.accept")
    assert "Mine" in gui.session.settings.layouts
    apply(gui, "view.layout_edit")
    narrow = width_of_canvas(gui)
    assert narrow < wide
    gui.session.view.layout = "Mine"
    gui.frames(10)
    assert width_of_canvas(gui) == pytest.approx(wide, abs=2)
    gui.session.settings.save(tmp_path / "settings.json")
    later = make_gui(session=Session(settings=Settings.load(tmp_path / "settings.json")))
    assert width_of_canvas(later) == pytest.approx(narrow, abs=2)
    later.session.view.layout = "Mine"
    later.frames(10)
    assert width_of_canvas(later) == pytest.approx(wide, abs=2)


def test_names_of_the_apps_layouts_are_taken(gui):
    apply(gui, "view.keep_layout")
    gui.text("Play")
    gui.click("line.accept")
    assert gui.session.settings.layouts == {}
    assert "comes with the app" in gui.session.toasts[-1].text


def test_every_layout_has_its_panels_in_front(gui):
    gui.frames(10)
    assert gui.shows("outliner.filter")
    assert gui.shows("level.name")
    assert gui.shows("lower.fold")
    gui.session.queue("view.layout_play")
    gui.frames(20)
    assert gui.session.viewer.timeline_open
    assert gui.shows("agents.choose.a")
    gui.session.queue("view.layout_evaluate")
    gui.frames(20)
    assert gui.shows("evaluate.source")
    assert gui.shows("agents.choose.a")


def test_a_panel_that_needs_room_gets_it_and_gives_it_back(gui):
    gui.frames(30)
    gui.bring("problems")
    low = height_of_canvas(gui)
    apply(gui, "level.evaluate")
    assert height_of_canvas(gui) < low - 100
    gui.bring("problems")
    assert height_of_canvas(gui) == pytest.approx(low, abs=2)


def test_panels_that_come_back_take_no_room_and_ask_for_nothing(gui):
    gui.frames(35)
    gui.bring("problems")
    low = height_of_canvas(gui)
    assert gui.shows("problems.E101")
    for hide, back in (("ctrl+g", "escape"), ("tab", "tab")):
        gui.key(hide)
        gui.frames(35)
        gui.key(back)
        gui.frames(35)
        assert gui.shows("problems.E101")
        assert height_of_canvas(gui) == pytest.approx(low, abs=2)


def test_a_question_while_panels_come_back_does_not_change_which_is_in_front(gui):
    gui.frames(35)
    gui.bring("problems")
    gui.frames(35)
    gui.key("ctrl+g")
    gui.frames(35)
    gui.host.frames(1, KeyEvent(key="escape", pressed=True))
    gui.host.frames(1, KeyEvent(key="escape", pressed=False))
    gui.session.queue("file.open")
    gui.frames(60)
    assert gui.session.prompts
    gui.host.ui.save_layout()
    gui.key("escape")
    gui.frames(35)
    assert gui.shows("problems.E101")


def test_who_has_zoomed_keeps_the_view_when_the_window_changes(gui):
    gui.frames(4)
    gui.host.size = (1000, 700)
    gui.frames(4)
    corner = gui.session.camera.to_screen((5.0, 5.0))
    assert gui.probe("canvas").low[1] < corner[1] < gui.probe("canvas").high[1]
    gui.wheel(*gui.screen(2.5, 2.5), 3)
    zoom = gui.session.camera.zoom
    gui.host.size = (1280, 800)
    gui.frames(4)
    assert gui.session.camera.zoom == zoom
    gui.key("home")
    gui.host.size = (1000, 700)
    gui.frames(4)
    assert gui.session.camera.zoom < zoom


def arena(gui):
    """The arena's square on the screen: left, top, right, bottom."""
    camera = gui.session.camera
    return (*camera.to_screen((0.0, 5.0)), *camera.to_screen((5.0, 0.0)))


def seen_whole(gui):
    left, top, right, bottom = arena(gui)
    canvas = gui.probe("canvas")
    return (
        canvas.low[0] <= left
        and canvas.low[1] <= top
        and right <= canvas.high[0]
        and bottom <= canvas.high[1]
    )


def test_the_arena_has_the_most_of_the_window_in_edit(make_gui):
    gui = make_gui(size=(1440, 900))
    gui.frames(40)
    left, top, right, bottom = arena(gui)
    assert right - left >= 0.45 * 1440
    assert bottom - top >= 0.60 * 900
    assert seen_whole(gui)


@pytest.mark.parametrize(("size", "scale"), [((1024, 640), 1.0), ((1440, 900), 2.0)])
def test_a_narrow_window_has_one_column(make_gui, size, scale):
    gui = make_gui(size=size, scale=scale)
    gui.frames(40)
    left, _, right, _ = arena(gui)
    assert gui.probe("canvas").low[0] == pytest.approx(0, abs=2)
    assert right - left >= 0.55 * size[1]
    assert seen_whole(gui)


def test_the_left_column_folds_away_by_itself_and_comes_back(make_gui):
    gui = make_gui(size=(1440, 900))
    gui.frames(40)
    before = gui.probe("canvas")
    gui.host.size = (1024, 640)
    gui.frames(40)
    assert gui.probe("canvas").low[0] == pytest.approx(0, abs=2)
    assert seen_whole(gui)
    gui.host.size = (1440, 900)
    gui.frames(40)
    assert gui.probe("canvas").low == pytest.approx(before.low, abs=2)
    assert gui.probe("canvas").high == pytest.approx(before.high, abs=2)


@pytest.mark.parametrize("panel", ["agents", "history"])
def test_the_view_does_not_jump_when_panels_come_and_go(gui, panel):
    gui.frames(40)
    before = arena(gui)
    gui.bring(panel)
    assert arena(gui) == pytest.approx(before, abs=0.5)
    gui.bring("inspector")
    assert arena(gui) == pytest.approx(before, abs=0.5)


@pytest.mark.parametrize("panel", ["problems", "plots", "log"])
@pytest.mark.parametrize("size", [(1280, 800), (1024, 640)])
def test_a_level_shown_whole_is_so_above_a_panel_that_was_asked_for(make_gui, size, panel):
    gui = make_gui(size=size)
    gui.frames(40)
    before = arena(gui)
    gui.bring(panel)
    gui.frames(20)
    assert arena(gui)[3] < before[3] and seen_whole(gui)
    gui.click("lower.fold")
    gui.frames(20)
    assert arena(gui) == pytest.approx(before, abs=0.5)
    # Who looks at a part of the level goes on looking at it.
    gui.wheel(*gui.screen(2.5, 2.5), 3)
    zoomed = arena(gui)
    gui.bring(panel)
    gui.frames(20)
    assert arena(gui) == pytest.approx(zoomed, abs=0.5)


@pytest.mark.parametrize("panel", ["evaluate", "training", "curriculum"])
def test_a_level_shown_whole_is_so_beside_what_measures(make_gui, panel):
    gui = make_gui(size=(1440, 900))
    gui.frames(40)
    before = arena(gui)
    gui.bring(panel)
    gui.frames(20)
    assert seen_whole(gui)
    gui.bring("problems")
    gui.click("lower.fold")
    gui.frames(20)
    assert arena(gui) == pytest.approx(before, abs=0.5)
    # Who looks at a part of the level goes on looking at it.
    gui.wheel(*gui.screen(2.5, 2.5), 3)
    zoomed = arena(gui)
    gui.bring(panel)
    gui.frames(20)
    assert arena(gui) == pytest.approx(zoomed, abs=0.5)


@pytest.mark.parametrize("size", [(1440, 900), (1024, 640)])
def test_a_level_shown_whole_is_so_in_every_layout_of_the_app(make_gui, size):
    gui = make_gui(size=size)
    gui.frames(40)
    for name in ("evaluate", "play", "edit", "evaluate", "edit"):
        apply(gui, f"view.layout_{name}")
        gui.frames(20)
        assert seen_whole(gui), name


@pytest.mark.parametrize("size", [(1440, 900), (1024, 640)])
def test_what_is_drawn_over_the_level_on_demand_is_in_sight(make_gui, size):
    """Debug drawings and the ways of attempts open the row below, which would hide the floor."""
    gui = make_gui(size=size)
    gui.frames(40)
    gui.key("f3")
    gui.frames(30)
    assert gui.session.view.debug_draw and seen_whole(gui)
    gui.key("f3")
    gui.session.view.layout = "edit"
    gui.frames(30)
    gui.bring("evaluate")
    viewer = gui.session.viewer
    viewer.evaluation.plan = Plan(agents=(), levels=(), hashes=())
    paths = AttemptPaths(
        level_hash="",
        step=np.arange(2),
        position=np.zeros((1, 2, 2), np.float32),
        outcomes=("won",),
        parting=None,
    )
    viewer.ways = Ways(plan=viewer.evaluation.plan, level=0, agent=0, paths=paths)
    gui.frames(30)
    assert seen_whole(gui)


def test_the_place_under_the_canvas_folds_by_its_arrow_and_by_its_tab(gui):
    gui.frames(40)
    folded = height_of_canvas(gui)
    gui.click("lower.fold")
    gui.frames(6)
    assert height_of_canvas(gui) < folded - 80
    assert gui.shows("problems.E101")
    gui.click("lower.fold")
    gui.frames(6)
    assert height_of_canvas(gui) == pytest.approx(folded, abs=2)
    assert not gui.shows("problems.E101")
    fold = gui.probe("lower.fold")
    gui.click_at(gui.probe("canvas").low[0] + 40, fold.centre[1])
    gui.frames(6)
    assert gui.shows("problems.E101")
    gui.click_at(gui.probe("canvas").low[0] + 40, gui.probe("lower.fold").centre[1])
    gui.frames(6)
    assert height_of_canvas(gui) == pytest.approx(folded, abs=2)


@pytest.mark.parametrize("size", [(1440, 900), (800, 600)])
def test_a_level_shown_whole_is_so_whether_the_row_is_folded_or_open(make_gui, size):
    gui = make_gui(session=a_session(), size=size)
    gui.frames(40)
    folded = arena(gui)
    gui.click("lower.fold")
    gui.frames(20)
    assert seen_whole(gui)
    gui.click("lower.fold")
    gui.frames(20)
    assert arena(gui) == pytest.approx(folded, abs=0.5)
    tab = imgui.internal.find_window_by_name("###panel-log").dc.dock_tab_item_rect
    gui.click_at((tab.min.x + tab.max.x) / 2, (tab.min.y + tab.max.y) / 2)
    gui.frames(20)
    assert seen_whole(gui)


@pytest.mark.parametrize("frames", [10, 60])
@pytest.mark.parametrize("panel", ["plots", "log", "evaluate"])
def test_one_click_on_another_tab_opens_the_folded_row(make_gui, panel, frames):
    gui = make_gui(session=a_session(), size=(1440, 900))
    gui.frames(60)
    # Panels that come back are brought to the front one by one for a while.
    for key in ("space", "escape"):
        gui.key(key)
        gui.frames(12)
    gui.frames(frames)
    folded = height_of_canvas(gui)
    tab = imgui.internal.find_window_by_name(f"###panel-{panel}").dc.dock_tab_item_rect
    gui.click_at((tab.min.x + tab.max.x) / 2, (tab.min.y + tab.max.y) / 2)
    gui.frames(6)
    assert height_of_canvas(gui) < folded - 80


def test_in_play_the_arena_has_all_that_is_free_and_one_key_brings_the_panels_back(make_gui):
    gui = make_gui(session=a_session(), size=(1440, 900))
    gui.frames(40)
    edit = arena(gui)
    gui.key("space")
    gui.frames(12)
    left, top, right, bottom = arena(gui)
    canvas = gui.probe("canvas")
    assert canvas.high[0] - canvas.low[0] == pytest.approx(1440, abs=2)
    assert bottom - top > 0.95 * (canvas.high[1] - canvas.low[1])
    assert right - left > edit[2] - edit[0]
    assert not gui.shows("outliner.filter")
    gui.key("tab")
    gui.frames(40)
    assert gui.shows("outliner.filter")
    assert seen_whole(gui)
    for panel in ("timeline", "log"):
        gui.bring(panel)
        gui.frames(20)
        assert seen_whole(gui), "the lower row grew over the arena"
    gui.key("tab")
    gui.frames(20)
    assert not gui.shows("outliner.filter")
    gui.key("escape")
    gui.frames(40)
    assert gui.shows("outliner.filter")
    assert seen_whole(gui), "what Play has opened hides the floor in Edit"


def test_a_zoomed_view_stays_when_play_begins_and_ends(make_gui):
    gui = make_gui(session=a_session(), size=(1440, 900))
    gui.frames(40)
    gui.wheel(*gui.screen(2.0, 2.0), 5)
    before = gui.session.camera
    gui.key("space")
    gui.frames(12)
    assert gui.session.camera.zoom == before.zoom
    gui.key("escape")
    gui.frames(20)
    assert gui.session.camera == before


@pytest.mark.parametrize(("size", "scale"), [((1440, 900), 1.0), ((1024, 640), 1.5)])
def test_messages_stand_beside_the_arena_and_under_menus(make_gui, size, scale):
    gui = make_gui(session=a_session(), size=size, scale=scale)
    gui.frames(40)
    for key in ("", "space"):
        if key:
            gui.key(key)
            gui.frames(12)
        gui.session.toast("Saved a file with quite a long name, rover_ridge_second_try.json")
        gui.frames(4)
        _, top, right, bottom = arena(gui)
        toast = gui.probe("toast.0.close")
        assert toast.low[0] > right or toast.low[1] > bottom
        assert top < bottom


def test_the_counts_in_the_status_line_open_the_problems(gui):
    gui.frames(40)
    assert not gui.shows("problems.E101")
    gui.click("status.view.problems")
    gui.frames(8)
    assert gui.shows("problems.E101")


@pytest.mark.parametrize("panel", ["evaluate", "problems", "inspector"])
def test_a_window_without_room_for_its_panels_goes_on(make_gui, panel):
    """A tiny window with a large interface leaves some places no size at all."""
    gui = make_gui(size=(1440, 900))
    gui.frames(20)
    gui.host.size = (320, 240)
    gui.session.settings.ui_scale = 3.0
    gui.frames(10)
    gui.bring(panel)
    for size in ((1440, 240), (320, 900), (320, 240), (1440, 900)):
        gui.host.size = size
        gui.frames(4)
        gui.bring("log")
        gui.bring(panel)
    for size in ((1440, 60), (1440, 900), (320, 100)):
        gui.host.size = size
        gui.frames(4)
        apply(gui, "view.layout_evaluate")
    gui.session.settings.ui_scale = 1.0
    gui.host.size = (1440, 900)
    gui.frames(20)
    assert gui.shows("canvas")


@pytest.mark.parametrize(
    ("size", "scale"),
    [
        ((1440, 900), 1.5),
        ((2560, 1440), 2.0),
        ((800, 600), 1.0),
        ((1024, 640), 1.0),
        ((1024, 640), 1.5),
        ((1024, 640), 2.0),
    ],
)
def test_the_words_on_tabs_are_never_cut(make_gui, size, scale):
    gui = make_gui(session=a_session(), size=size, scale=scale)
    gui.frames(60)
    rows = {}
    for panel in gui.host.ui.workplace.panels:
        node = imgui.internal.find_window_by_name(panel.window_name).dock_node
        rows[node.id_] = node.tab_bar
    assert len(rows) >= 2
    for bar in rows.values():
        cut = [tab.content_width - tab.width for tab in bar.tabs]
        assert max(cut) <= 1


def test_the_tab_in_front_gives_up_its_sign_before_its_word(make_gui):
    gui = make_gui(session=a_session(), size=(800, 600))
    gui.frames(60)
    words = {
        panel.id: gui.host.ui.workplace._tab_words.name(panel).partition("###")[0]
        for panel in gui.host.ui.workplace.panels
    }
    assert words["problems"] == "Problems" and words["inspector"].endswith("  Inspector")


def test_tabs_have_words_where_there_is_room(make_gui):
    gui = make_gui(session=a_session(), size=(1440, 900))
    gui.frames(60)
    assert all(
        gui.host.ui.workplace._tab_words.has_words(panel) for panel in gui.host.ui.workplace.panels
    )


def test_keys_of_panels_bring_them_to_the_front_whatever_lies_there(make_gui):
    gui = make_gui()
    gui.frames(40)
    for key, panel in (("f4", "plots"), ("f8", "timeline"), ("f4", "plots"), ("f7", "agents")):
        gui.key(key)
        gui.frames(10)
        assert panel in {each.id for each in gui.host.ui.workplace._drawn}
