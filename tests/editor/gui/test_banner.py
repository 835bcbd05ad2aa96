"""The strip over the level that tells of changes by somebody else."""

import os

import pytest

from kinetix.level.codec import save_level
from tests.editor.core.helpers import a_level


@pytest.fixture
def opened(make_gui, tmp_path):
    """A window with a level that has a file, and that file."""
    path = tmp_path / "cart.json"
    save_level(a_level(), path)
    gui = make_gui()
    gui.open(path)
    gui.frames(20)
    return gui, path


def test_a_change_from_outside_is_told_over_the_level_and_taken(opened):
    gui, path = opened
    high = gui.probe("canvas").low[1]
    theirs = a_level().replace(thrusters=())
    save_level(theirs, path)
    os.utime(path, ns=(10**18, 10**18))
    gui.frames(130)
    assert gui.probe("canvas").low[1] > high + 20
    gui.click("outside.file.reload")
    gui.frames(4)
    assert gui.level.thrusters == ()
    assert not gui.shows("outside.file.reload")
    assert gui.probe("canvas").low[1] == high


def test_what_cannot_be_read_is_not_offered_to_be_taken(opened):
    gui, path = opened
    path.write_text("garbage{")
    os.utime(path, ns=(10**18, 10**18))
    gui.frames(130)
    for name in ("reload", "differences"):
        gui.click(f"outside.file.{name}")
    assert not gui.session.toasts and not gui.session.prompts
    gui.click("outside.file.keep_mine")
    assert not gui.shows("outside.file.reload")
