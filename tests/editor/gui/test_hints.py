"""The line about the keys that matter now."""

import pytest

from editor import actions
from editor.base.language import use
from editor.play.mode import Mode
from editor.window.hints import hint, pressed
from tests.editor.core.helpers import a_session


@pytest.fixture(autouse=True)
def english():
    yield
    use("en")


def playing():
    session = a_session()
    actions.run(session, "run.play_human")
    actions.update(session, 0.1)
    assert session.mode is Mode.PLAYING
    return session


def test_keys_are_named_as_they_are_now():
    session = playing()
    assert hint(session) == "Space pauses   , . step   - = speed   Backspace restarts   Esc edits"
    session.settings.keys["run.reset"] = ["f10"]
    session.settings.keys["run.slower"] = []
    assert hint(session) == "Space pauses   , . step   = speed   F10 restarts   Esc edits"
    assert pressed(session, "run.reset", "to restart") == "Press F10 to restart"
    assert pressed(session, "run.slower", "to slow down") == ""


def test_in_another_language():
    session = playing()
    use("de")
    assert hint(session).startswith(
        "Leertaste hält an   , . Schritt   - = Tempo   Rücktaste beginnt neu"
    )


def test_in_the_gallery():
    session = a_session()
    session.gallery.open = True
    assert hint(session).startswith(
        "← → ↑ ↓ move   Enter opens   Ctrl+F searches   Ctrl+Shift+A adds to the set"
    )
