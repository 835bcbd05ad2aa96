"""The second start shows what the first one showed, also after an earlier version's."""

from pathlib import Path

import pytest
from imgui_bundle import imgui

from editor.base.settings import Settings
from editor.session import Session
from editor.window import layouts
from tests.editor import days

pytestmark = pytest.mark.parametrize("day", [days.FIRST], indirect=True)

STORED = Path(__file__).resolve().parents[1] / "stored" / "layouts"


def places(gui):
    """Per panel where it is docked (0: nowhere) and its place on the screen."""
    found = {}
    for panel in gui.host.ui.workplace.panels:
        window = imgui.internal.find_window_by_name(panel.window_name)
        at, size = window.pos, window.size
        found[panel.id] = (window.dock_id, round(at.x), round(at.y), round(size.x), round(size.y))
    return found


def started(make_gui, layout="", **options):
    gui = make_gui(session=Session(settings=Settings(layout=layout)), **options)
    gui.frames(50)
    return gui


def quit_(gui):
    """Quit the app and return what it keeps."""
    gui.host.ui.save_layout()
    return gui.session.settings.layout


@pytest.mark.parametrize(
    ("size", "scale"), [((1280, 800), 1.0), ((1280, 800), 1.5), ((1024, 640), 2.0)]
)
def test_later_starts_look_like_the_first(make_gui, size, scale):
    gui = started(make_gui, size=size, scale=scale)
    first, front, canvas = places(gui), set(gui.host.ui.workplace._seen), gui.probe("canvas")
    assert all(dock for dock, *_ in first.values())
    layout = quit_(gui)
    for _ in range(3):
        gui = started(make_gui, layout, size=size, scale=scale)
        assert places(gui) == first
        assert gui.host.ui.workplace._seen == front
        assert gui.probe("canvas").low == pytest.approx(canvas.low, abs=1)
        assert gui.probe("canvas").high == pytest.approx(canvas.high, abs=1)
        assert quit_(gui) == layout
        layout = quit_(gui)


@pytest.mark.parametrize("name", ["first", "second"])
def test_a_layout_of_version_0_1_0_is_whole_again(make_gui, name):
    fresh = started(make_gui, size=(1440, 900))
    expected, front = places(fresh), set(fresh.host.ui.workplace._seen)
    stored = (STORED / f"layout_{name}_start_0.1.0.ini").read_text(encoding="utf-8")
    gui = started(make_gui, stored, size=(1440, 900))
    assert {k: v[1:] for k, v in places(gui).items()} == {k: v[1:] for k, v in expected.items()}
    assert all(dock for dock, *_ in places(gui).values())
    assert gui.host.ui.workplace._seen == front


def test_the_keyboard_is_on_the_canvas_again(make_gui):
    layout = quit_(started(make_gui))
    gui = started(make_gui, layout)
    gui.key("c")
    assert gui.session.tool.id == "circle"
    assert not gui.host.ui.workplace._panel_focused


def test_a_panel_that_the_user_took_out_stays_out(make_gui):
    gui = started(make_gui)
    (history,) = (panel for panel in gui.host.ui.workplace.panels if panel.id == "history")
    imgui.internal.dock_context_process_undock_window(
        imgui.get_current_context(), imgui.internal.find_window_by_name(history.window_name)
    )
    gui.frames(4)
    out = places(gui)
    assert not out["history"][0]
    gui = started(make_gui, quit_(gui))
    assert places(gui) == out


def test_quitting_in_the_gallery_keeps_the_layout(make_gui):
    layout = quit_(started(make_gui))
    gui = make_gui(session=Session(settings=Settings(layout=layout)))
    gui.session.queue("level.gallery")
    gui.frames(10)
    assert gui.session.gallery.open
    again = started(make_gui, quit_(gui))
    assert all(dock for dock, *_ in places(again).values())


def test_quitting_before_the_panels_stood_keeps_what_was_stored(make_gui):
    session = Session(settings=Settings(layout="what a later version wrote"))
    session.gallery.open = True
    gui = make_gui(session=session)
    assert quit_(gui) == "what a later version wrote"


@pytest.mark.parametrize(("before", "after"), [(1.0, 1.5), (1.5, 1.0)])
def test_another_display_with_another_scale_has_columns_as_wide_in_its_scale(
    make_gui, before, after
):
    size = (2400, 1400)
    expected = places(started(make_gui, size=size, scale=after))
    layout = quit_(started(make_gui, size=size, scale=before))
    later = places(started(make_gui, layout, size=size, scale=after))
    for panel, place in later.items():
        assert place[1:] == pytest.approx(expected[panel][1:], abs=6), panel


def test_another_scale_keeps_the_panels_docked_and_grows_them(make_gui):
    gui = started(make_gui, size=(1600, 1000))
    before = places(gui)
    gui.session.settings.ui_scale = 1.25
    gui.frames(50)
    after = places(gui)
    assert [dock for dock, *_ in after.values()] == [dock for dock, *_ in before.values()]
    assert after["inspector"][3] == pytest.approx(1.25 * before["inspector"][3], abs=3)
    assert gui.session.log.lines == ()


@pytest.mark.parametrize("size", [(1440, 900), (1024, 640)])
@pytest.mark.parametrize(("before", "after"), [(1.0, 2.0), (2.0, 1.0)])
def test_a_scale_with_room_for_other_columns_has_the_layout_for_it(make_gui, size, before, after):
    expected = places(started(make_gui, size=size, scale=after))
    gui = started(make_gui, size=size, scale=before)
    first = places(gui)
    for scale, wanted in ((after, expected), (before, first), (after, expected)):
        gui.session.settings.ui_scale = scale
        gui.frames(60)
        for panel, place in places(gui).items():
            assert place[1:] == pytest.approx(wanted[panel][1:], abs=4), (scale, panel)


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text[: len(text) // 2],
        lambda text: text.replace("DockNode", "DockMode"),
        lambda text: text.replace("panel-log", "panel-lag"),
        lambda text: "\0" * 40 + text,
        lambda text: "[Docking][Data]\n" * 2000,
    ],
)
def test_a_damaged_layout_is_the_first_one(make_gui, damage):
    gui = started(make_gui)
    first = {k: v[1:] for k, v in places(gui).items()}
    gui = started(make_gui, damage(quit_(gui)))
    assert {k: v[1:] for k, v in places(gui).items()} == first


def test_a_kept_layout_brings_its_own_panels_to_the_front(make_gui):
    gui = started(make_gui)
    gui.session.view.layout = "play"
    gui.frames(40)
    shown = places(gui)
    gui.session.view.layout_name = "Mine"
    gui.frames(2)
    front = set(gui.host.ui.workplace._seen)
    gui.session.view.layout = "edit"
    gui.frames(40)
    gui.session.view.layout = "Mine"
    gui.frames(40)
    assert gui.host.ui.workplace._seen == front
    assert {k: v[1:] for k, v in places(gui).items()} == {k: v[1:] for k, v in shown.items()}


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ((1440, 800), (1000, 800)),
        ((1000, 800), (1440, 800)),
        ((1000, 400), (1440, 800)),
        ((1000, 800), (1000, 400)),
    ],
)
def test_a_window_with_other_room_has_the_layout_for_it(make_gui, before, after):
    expected = started(make_gui, size=after).probe("canvas")
    layout = quit_(started(make_gui, size=before))
    canvas = started(make_gui, layout, size=after).probe("canvas")
    assert canvas.low == pytest.approx(expected.low, abs=2)
    assert canvas.high == pytest.approx(expected.high, abs=2)


def test_the_window_after_version_0_1_0_is_that_of_a_first_start(make_gui, tmp_path):
    first = make_gui()
    first.frames(50)
    expected = {name: place[1:] for name, place in places(first).items()}
    days.put_old(tmp_path)
    gui = make_gui()
    gui.frames(50)
    assert gui.session.settings.grid_step == 0.25
    assert {name: place[1:] for name, place in places(gui).items()} == expected
    gui.key("c")
    assert gui.session.tool.id == "circle"


def test_sizes_grow_and_nothing_else_does(monkeypatch, day):
    del day
    monkeypatch.setattr(layouts, "px", lambda value: 1.5 * value)
    text = "Size=100,40\nDockId=0x00000010\n  DockNode SizeRef=20,30 Pos=5,5"
    grown = "Size=150,60\nDockId=0x00000010\n  DockNode SizeRef=30,45 Pos=5,5"
    head = "; kinetix-editor layout 2, scale {}, in front: level\n"
    assert layouts.for_this_scale(head.format("1.0000") + text) == head.format("1.0000") + grown
    # From a version that kept no scale, and from a damaged file: as it is.
    for first in ("; kinetix-editor layout 2, in front: level\n", head.format("0.0"), ""):
        assert layouts.for_this_scale(first + text) == first + text
