"""The tabs of documents: what was opened, made or chosen last is in front."""

import pytest

from editor.actions.files import file
from editor.base import language
from editor.documents.commands.fields import SetLevelField
from editor.documents.document import Document
from editor.toolkit.widgets import px
from editor.window.panels.tabs import _told_apart
from kinetix.level.model import Level
from kinetix.paths import levels_dir


def titles(gui):
    return [tab.document.title for tab in gui.session.tabs]


def draw(gui):
    gui.key("r")
    gui.drag((1.0, 1.0), (2.0, 2.0))
    assert gui.session.document.dirty


@pytest.mark.parametrize("size", [(1280, 800), (640, 400)])
def test_a_file_that_takes_the_place_of_an_untouched_level_is_in_front(make_gui, size):
    gui = make_gui(size=size)
    gui.frames(10)
    draw(gui)
    gui.key("ctrl+n")
    gui.frames(6)
    gui.open(levels_dir() / "l" / "rover_ridge.json")
    gui.frames(10)
    assert titles(gui) == ["Untitled", "rover_ridge.json"]
    assert gui.session.document.title == "rover_ridge.json"
    gui.key("ctrl+a")
    gui.key("delete")
    assert gui.session.document.dirty, "keys went to another level"


def test_a_level_without_a_name_is_called_so_in_the_language_of_the_app(gui):
    gui.session.settings.language = "de"
    gui.frames(4)
    assert titles(gui) == ["Ohne Namen"] and "Ohne Namen" in gui.host.ui.window_title
    assert gui.level.name == "Untitled"
    language.use("en")
    assert titles(gui) == ["Untitled"]


def test_levels_of_one_name_are_told_apart(tmp_path):
    documents = [
        Document(Level(name="Untitled")),
        Document(Level(name="Same"), path=tmp_path / "mine" / "same.json"),
        Document(Level(name="Untitled")),
        Document(Level(name="Same"), path=tmp_path / "yours" / "same.json"),
    ]
    assert _told_apart(documents) == [
        "Untitled",
        "same.json · mine",
        "Untitled 2",
        "same.json · yours",
    ]


def test_closing_a_tab_leaves_the_one_in_front_that_took_its_place(gui):
    for name in ("chimes", "cogs", "delivery"):
        gui.open(levels_dir() / "l" / f"{name}.json")
    gui.click("tabs.1")
    gui.frames(4)
    assert gui.session.document.title == "cogs.json"
    file.close_tab(gui.session, gui.session.tab)
    chosen = gui.session.document
    gui.frames(10)
    assert titles(gui) == ["chimes.json", "delivery.json"]
    assert gui.session.document is chosen


def test_a_click_still_brings_a_tab_to_the_front(gui):
    for name in ("chimes", "cogs"):
        gui.open(levels_dir() / "l" / f"{name}.json")
    for number in (0, 1, 0):
        gui.click(f"tabs.{number}")
        gui.frames(4)
        assert gui.session.tabs.index_in_front == number


def test_a_right_click_on_a_tab_closes_the_others_or_copies_its_path(gui):
    paths = [levels_dir() / "l" / f"{name}.json" for name in ("chimes", "cogs", "delivery")]
    for path in paths:
        gui.open(path)
    gui.click_at(*gui.probe("tabs.1").centre, button=3)
    gui.frames(6)
    (menu,) = gui.session.prompts
    assert [choice.label for choice in menu.choices] == [
        "Close",
        "Close the Others",
        "Copy the Path",
    ]
    gui.session.answer(menu, "path")
    assert gui.session.clipboard.get() == str(paths[1])
    gui.click_at(*gui.probe("tabs.1").centre, button=3)
    gui.frames(6)
    gui.session.answer(gui.session.prompts[-1], "others")
    gui.frames(6)
    assert titles(gui) == ["cogs.json"]


def test_signs_in_a_name_cut_no_words(make_gui):
    """Dear ImGui takes what follows `##` for an id."""
    names = ("Car", "Car ## long tail", "Car###long tail", "Car #")
    gui = make_gui()
    for name in names:
        gui.session.document.mark_unsaved()
        gui.session.open_tab(Document(Level(name=name)))
    gui.session.document.mark_unsaved()
    gui.frames(4)
    widths = [gui.probe(f"tabs.{k}").high[0] - gui.probe(f"tabs.{k}").low[0] for k in range(1, 5)]
    assert widths[1] > widths[0] + 40 and widths[2] > widths[0] + 40 and widths[3] > widths[0]


def test_a_tab_that_gets_a_long_name_stays_in_sight(make_gui):
    gui = make_gui(size=(900, 600))
    gui.frames(10)
    for _ in range(12):
        draw(gui)
        gui.key("ctrl+n")
        gui.frames(4)
    draw(gui)
    gui.frames(10)
    gui.session.document.commit(SetLevelField(field="name", value="An extraordinary " * 5))
    gui.frames(30)
    tab, new = gui.probe("tabs.12"), gui.probe("tabs.new")
    assert tab.high[0] - tab.low[0] < px(300)
    assert tab.high[0] <= new.low[0] + px(2)


def test_a_list_of_the_tabs_brings_one_to_the_front(make_gui):
    gui = make_gui(size=(900, 600))
    gui.frames(10)
    for _ in range(8):
        draw(gui)
        gui.key("ctrl+n")
        gui.frames(4)
    gui.frames(10)
    left, row = gui.probe("canvas").low[0], gui.probe("tabs.new")
    gui.click_at(left + px(8), row.centre[1])
    gui.frames(6)
    gui.click_at(left + px(25), row.high[1] + px(9))
    gui.frames(10)
    assert gui.session.tabs.index_in_front == 0
