"""A window with the gallery open on three levels of the user's own."""

import time

import pytest

from kinetix.level.codec import save_level
from kinetix.level.model import Level
from tests.editor.core.test_gallery import playable


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """The user's own folder with three levels; nothing came with the app."""
    folder = tmp_path / "documents" / "Kinetix"
    folder.mkdir(parents=True)
    for k, name in enumerate(("Hill cart", "Moon cart", "Rocket")):
        save_level(playable(name, 1.0 + 0.3 * k), folder / f"{name.lower().replace(' ', '_')}.json")
    monkeypatch.setattr("editor.actions.gallery.gallery.levels_dir", lambda: tmp_path / "none")
    return folder


def settle(gui):
    """Let the gallery find everything and show its pictures."""
    for _ in range(400):
        gui.frames(2)
        if not gui.host.ui.animating:
            return
        time.sleep(0.005)
    raise AssertionError("the gallery does not come to rest")


@pytest.fixture
def gallery(make_gui, mine):
    gui = make_gui(level=Level(name="Open"))
    gui.key("ctrl+g")
    settle(gui)
    return gui


def cards(gui):
    return {name for name in gui.session.probe if name.startswith("gallery.card.")}
