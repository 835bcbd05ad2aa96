"""Short messages: whole on the screen, beside the card of the guided first level."""

import pytest
from imgui_bundle import imgui

from editor.actions import guide
from tests.editor.core.helpers import FakeSimulator, a_session
from tests.editor.gui.windows import apart, rect

LONG = "Won in 150 steps. A win can be kept in the level, as a solution that anybody can watch."


def bounds():
    viewport = imgui.get_main_viewport()
    low, size = viewport.work_pos, viewport.work_size
    return low.x, low.y, low.x + size.x, low.y + size.y


def inside(one, other):
    return one[0] >= other[0] and one[1] >= other[1] and one[2] <= other[2] and one[3] <= other[3]


@pytest.fixture
def won():
    """A session whose play is won after five steps."""
    session = a_session()
    simulator = FakeSimulator()
    simulator.ends_at, simulator.ends = 5, "won"
    session.playback.simulator = simulator
    return session


@pytest.mark.parametrize(
    ("size", "scale"), [((1440, 900), 1.0), ((1024, 640), 1.5), ((800, 600), 1.0)]
)
@pytest.mark.parametrize("words", ["Saved a.json", LONG])
@pytest.mark.parametrize("action", [None, "edit.undo", "level.keep_solution"])
def test_the_button_and_the_cross_of_a_message_are_whole(make_gui, size, scale, words, action):
    gui = make_gui(session=a_session(), size=size, scale=scale)
    gui.frames(40)
    gui.session.toast(words, "success", action=action)
    gui.frames(4)
    window = rect("##toast-0")
    assert inside(window, bounds())
    names = ["toast.0.close", *([f"toast.{action}"] if action else [])]
    probes = [(*gui.probe(name).low, *gui.probe(name).high) for name in names]
    assert all(inside(probe, window) for probe in probes)
    assert len(probes) == 1 or apart(*probes)


@pytest.mark.parametrize(
    ("size", "scale"), [((1440, 900), 1.0), ((1280, 800), 1.0), ((1024, 640), 1.5)]
)
def test_no_message_lies_on_the_guide_and_the_guide_on_no_bar(make_gui, size, scale):
    gui = make_gui(session=a_session(), size=size, scale=scale)
    gui.frames(40)
    for number in range(len(guide.STEPS) + 1):
        gui.session.settings.guide_step = number
        gui.session.toast(f"{LONG} {number}", "success", action="level.keep_solution")
        gui.session.toast(f"Saved {number}.json", "success")
        gui.frames(4)
        card = rect("###guide")
        assert inside(card, bounds())
        for toast in range(2):
            assert apart(rect(f"##toast-{toast}"), card), (number, toast)
    assert rect("###guide")[3] == pytest.approx(bounds()[3], abs=25)


def test_a_message_stands_in_the_corner_where_the_guide_was_dragged_away(make_gui):
    gui = make_gui(session=a_session())
    gui.session.settings.guide_step = 2
    gui.frames(40)
    left, top, _, _ = rect("###guide")
    gui.move(left + 60, top + 10)
    gui.button(left + 60, top + 10, pressed=True)
    gui.move(left + 70, top - 100)
    gui.move(left + 360, top - 200)
    gui.button(left + 360, top - 200, pressed=False)
    gui.frames(4)
    moved = rect("###guide")
    assert moved[:2] == pytest.approx((left + 300, top - 210), abs=2)
    gui.session.toast(LONG)
    gui.frames(4)
    assert rect("##toast-0")[3] == pytest.approx(bounds()[3], abs=25)
    assert apart(rect("##toast-0"), moved)


def test_a_win_of_the_guided_level_is_kept_by_a_click(make_gui, won):
    gui = make_gui(session=won)
    won.settings.guide_step = 8
    gui.frames(40)
    gui.key("space")
    gui.frames(60)
    assert won.playback.outcome == "won" and won.settings.guide_step == 9
    gui.click("toast.level.keep_solution")
    assert won.document.level.solution is not None


def test_a_long_message_stays_longer_and_an_error_longer_still(make_gui):
    gui = make_gui(session=a_session())
    for words, kind in (("Saved", "success"), (40 * "long ", "info"), ("It is lost.", "error")):
        gui.session.toast(words, kind)
    short, long, error = (toast.until - gui.session.time for toast in gui.session.toasts)
    assert short == 5.0 and 11.0 < long < 13.0 and error == 15.0


def test_a_message_stays_while_the_pointer_is_on_it(make_gui):
    gui = make_gui(session=a_session())
    gui.session.toast("Saved a.json", "success")
    gui.frames(4)
    left, top, right, bottom = rect("##toast-0")
    gui.move((left + right) / 2, (top + bottom) / 2)
    for _ in range(8):
        gui.session.time += 1.0
        gui.frames(2)
    assert [toast.text for toast in gui.session.toasts] == ["Saved a.json"]
    gui.click("toast.0.close")
    assert gui.session.toasts == []
    gui.session.toast("Saved b.json", "success")
    gui.frames(4)
    gui.move((left + right) / 2, (top + bottom) / 2)
    gui.frames(2)
    gui.move(5.0, 300.0)
    for _ in range(8):
        gui.session.time += 1.0
        gui.frames(2)
    assert gui.session.toasts == []
