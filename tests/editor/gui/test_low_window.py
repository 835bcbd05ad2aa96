"""A window of 1024 × 640 at 200 %: all can be reached, nothing is cut off, in any language."""

import pytest
from imgui_bundle import imgui

from editor.toolkit import widgets
from editor.toolkit.widgets import buttons
from editor.window import play_side
from editor.window.panels.menu import MENUS
from editor.window.panels.preferences import PAGES
from tests.editor.core.helpers import a_session

SIZE, SCALE = (1024, 640), 2.0
SHOWN = [menu.lower() for menu in MENUS if menu != "Gallery"]

pytestmark = pytest.mark.parametrize("language", ["en", "de"])


@pytest.fixture
def low(make_gui, language):
    session = a_session()
    session.settings.language = language
    gui = make_gui(session=session, size=SIZE, scale=SCALE)
    gui.frames(50)
    return gui


def inside(gui, name):
    low, high = gui.probe(name).low, gui.probe(name).high
    return low[0] >= 0 and low[1] >= 0 and high[0] <= SIZE[0] and high[1] <= SIZE[1]


def arena_height(gui):
    camera = gui.session.camera
    return camera.to_screen((0.0, 0.0))[1] - camera.to_screen((0.0, 5.0))[1]


def test_every_menu_can_be_opened(low):
    seen = [menu for menu in SHOWN if low.shows(f"menu.{menu}")]
    assert all(inside(low, f"menu.{menu}") for menu in seen), seen
    if seen != SHOWN:
        low.click("menu.more")
        rest = [menu for menu in SHOWN if menu not in seen]
        assert rest and all(inside(low, f"menu.{menu}") for menu in rest)
        low.move(*low.probe("menu.help").centre)
        low.frames(20)
    else:
        low.click("menu.help")
    assert low.shows("menu.app.help") and inside(low, "menu.app.help")
    low.click("menu.app.help")
    assert low.session.view.help
    low.key("escape")
    assert not low.session.view.help


def test_escape_closes_the_menu_that_holds_the_rest(low, language):
    if language == "en":
        pytest.skip("every menu fits into the bar")
    assert low.shows("menu.more")
    low.click("menu.more")
    low.move(*low.probe("menu.help").centre)
    low.frames(20)
    low.key("escape")
    low.frames(20)
    assert not low.shows("menu.app.help")
    assert not imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)


def test_the_tab_of_a_panel_that_is_brought_to_the_front_is_in_sight(low):
    for panel in ("training", "log", "problems"):
        low.bring(panel)
        low.frames(8)
        window = imgui.internal.find_window_by_name(f"###panel-{panel}")
        strip, tab = window.dock_node.tab_bar, window.dc.dock_tab_item_rect
        assert strip.scrolling_rect_min_x <= tab.min.x
        assert tab.max.x <= strip.scrolling_rect_max_x + 1


def test_undo_is_in_the_bar(low):
    assert inside(low, "edit.undo") and inside(low, "edit.redo") and inside(low, "run.play_human")


def test_the_level_takes_what_there_is(low):
    assert arena_height(low) >= 0.45 * SIZE[1]
    low.key("f3")
    low.frames(30)
    assert low.session.view.debug_draw
    assert arena_height(low) >= 0.45 * SIZE[1]


def test_one_panel_stands_beside_the_level(low):
    low.session.selection = (1,)
    low.frames(6)
    window = imgui.internal.find_window_by_name("###panel-inspector")
    assert window.size.y >= 0.6 * SIZE[1]
    low.bring("outliner")
    assert low.shows("outliner.filter") and inside(low, "outliner.filter")
    low.bring("inspector")
    assert not low.shows("outliner.filter")


def test_no_button_is_cut_off(low, monkeypatch):
    cut = []

    def probe(session, name, *, enabled=True):
        widgets.probe(session, name, enabled=enabled)
        clip = imgui.get_current_context().current_window.inner_clip_rect
        right = imgui.get_item_rect_max().x
        if right > clip.max.x + 1:
            cut.append((name, round(right - clip.max.x)))

    def button(label, size=(0.0, 0.0)):
        words, room = label.partition("###")[0], next(iter(size))
        if room > 0 and imgui.calc_text_size(words).x > room:
            cut.append((label, round(imgui.calc_text_size(words).x - room)))
        return press(label, size)

    press = imgui.button
    monkeypatch.setattr(imgui, "button", button)
    monkeypatch.setattr(buttons, "probe", probe)
    for panel in low.host.ui.workplace.panels:
        low.bring(panel.id)
        low.frames(4)
    for selection in ((1,), (3,), (5,), (6,), ("floor",), (1, 2), ()):
        low.session.selection = selection
        low.frames(3)
    low.session.view.preferences = True
    low.session.settings.radians = True
    low.session.settings.volume = 0.2
    low.frames(3)
    for page in (*PAGES, "Files", "Keys"):
        low.click(f"preferences.{page}")
    low.session.view.preferences = False
    low.key("ctrl+o")
    low.frames(4)
    low.key("escape")
    low.key("ctrl+g")
    low.frames(6)
    low.key("escape")
    low.key("space")
    low.frames(20)
    low.key("tab")
    low.frames(20)
    assert sorted(set(cut)) == []


@pytest.mark.parametrize("step", [0, 1, 6, 8])
def test_the_guide_stands_beside_the_level(low, step):
    low.session.queue("app.guide")
    low.frames(4)
    low.session.settings.guide_step = step
    low.frames(10)
    card = imgui.internal.find_window_by_name("###guide")
    assert card.pos.x >= low.screen(5.0, 0.0)[0]
    assert card.pos.y >= 0 and card.pos.y + card.size.y <= SIZE[1]
    assert inside(low, "guide.next") and inside(low, "guide.close")


def test_what_is_said_of_the_episode_stands_beside_the_level(low, monkeypatch):
    columns = []
    column = play_side._Column

    def made(**parts):
        columns.append(column(**parts))
        return columns[-1]

    monkeypatch.setattr(play_side, "_Column", made)
    low.key("space")
    low.frames(20)
    assert not columns[-1].plates
    assert columns[-1].x + columns[-1].width <= low.screen(0.0, 5.0)[0]


def test_the_arrow_that_sets_back_stands_beside_its_field(low):
    low.session.settings.grid_step = 0.25
    low.session.view.preferences = True
    low.frames(3)
    low.click("preferences.Editing")
    field, arrow = low.probe("preferences.grid_step"), low.probe("preferences.grid_step.reset")
    assert arrow.low[1] < field.high[1] and arrow.low[0] > field.high[0]


def test_a_hint_that_has_no_room_ends_in_an_ellipsis(low, monkeypatch):
    shown = []
    field = imgui.input_text_with_hint

    def hinted(label, hint, *rest):
        room = imgui.calc_item_width() - 2 * imgui.get_style().frame_padding.x
        shown.append((hint, imgui.calc_text_size(hint).x <= room))
        return field(label, hint, *rest)

    monkeypatch.setattr(imgui, "input_text_with_hint", hinted)
    low.session.selection = (1,)
    low.bring("inspector")
    low.bring("outliner")
    low.key("ctrl+o")
    low.key("escape")
    low.key("ctrl+g")
    low.frames(4)
    assert len(shown) > 4
    assert all(fits for _, fits in shown), shown


def test_at_300_percent_the_gallery_is_left_by_its_cross_and_keys_have_names(make_gui, language):
    session = a_session()
    session.settings.language = language
    gui = make_gui(session=session, size=(1024, 700), scale=3.0)
    gui.session.queue("level.gallery")
    gui.frames(8)
    assert gui.probe("gallery.order").high[0] <= 1024
    gui.click("gallery.close")
    assert not session.gallery.open
    gui.session.queue("app.keys")
    gui.frames(8)
    assert gui.probe("keys.file.new").low[0] > 300, "its name stands before it"


def test_heads_of_dialogs_break_where_the_window_is_narrow(make_gui, language):
    session = a_session()
    session.settings.language = language
    gui = make_gui(session=session, size=(800, 600), scale=2.0)
    gui.session.queue("app.keys")
    gui.frames(8)
    edge = gui.probe("keys.close").high[0] + 10
    gui.text("undo")
    gui.frames(4)
    assert gui.probe("keys.reset_all").high[0] <= edge
    gui.key("escape")
    gui.session.queue("file.save_as")
    gui.frames(8)
    assert gui.shows("browser.place.3")
    assert all(gui.probe(f"browser.place.{k}").high[0] <= edge for k in range(4))
