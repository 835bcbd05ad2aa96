"""The strip over a paused episode that is being changed."""

import pytest

from editor.play.mode import Mode
from tests.editor.core.helpers import FakeSimulator, a_level


@pytest.fixture
def paused(make_gui):
    gui = make_gui(level=a_level())
    gui.session.playback.simulator = FakeSimulator()
    gui.key("space")
    gui.frames(30)
    gui.key("space")
    assert gui.session.mode is Mode.PAUSED
    return gui


def test_a_key_and_a_button_lead_into_it_and_the_strip_out_again(paused):
    level = paused.session.tab.document.level
    paused.key("e")
    paused.frames(4)
    assert paused.session.mode is Mode.EDIT
    assert paused.shows("moment.run.keep_moment")
    paused.click("outliner.1")
    paused.key("shift+left")
    assert paused.session.tab.moment.changed
    paused.click("moment.run.drop_moment")
    assert paused.session.mode is Mode.PAUSED
    paused.click("run.change")
    paused.frames(4)
    paused.click("outliner.1")
    paused.key("shift+left")
    paused.click("moment.run.keep_moment")
    paused.frames(4)
    assert not paused.shows("moment.run.keep_moment")
    assert paused.session.document.level != level
    paused.session.queue("edit.undo")
    paused.frames(2)
    assert paused.session.document.level == level


def test_play_on_goes_on(paused):
    step = paused.session.playback.step_count
    paused.key("e")
    paused.frames(4)
    paused.click("outliner.1")
    paused.key("shift+left")
    paused.click("moment.run.play_human")
    paused.frames(4)
    assert paused.session.mode is Mode.PLAYING
    assert paused.session.playback.step_count >= step
