"""The view of Edit after Play: as it was, or fitted anew where Play has opened a panel."""

import pytest

from editor.base.camera import ARENA
from tests.editor.core.helpers import FakeSimulator, a_level


@pytest.fixture
def gui(make_gui):
    gui = make_gui(level=a_level())
    gui.session.playback.simulator = FakeSimulator()
    gui.frames(20)
    return gui


def shown_whole(camera) -> bool:
    """Whether both corners of the arena are in the viewport."""
    (left, top), (width, height) = camera.origin, camera.size
    corners = [camera.to_screen(corner) for corner in ARENA]
    return all(left <= x <= left + width and top <= y <= top + height for x, y in corners)


def test_a_panel_that_play_has_opened_does_not_hide_the_floor(gui):
    assert shown_whole(gui.session.camera)
    gui.key("space")
    gui.frames(10)
    gui.bring("timeline")
    gui.frames(10)
    gui.key("escape")
    gui.frames(30)
    assert gui.session.editing
    assert shown_whole(gui.session.camera)


def test_without_one_the_view_is_as_it_was(gui):
    before = gui.session.camera
    gui.key("space")
    gui.frames(10)
    gui.key("escape")
    gui.frames(30)
    assert gui.session.camera == before
