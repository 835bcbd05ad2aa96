"""Many levels chosen, and in the set: a frame looks at those in sight alone, and at no file."""

import threading
import time

import pytest

from editor.actions.files import quitting
from editor.actions.gallery import level_sets
from editor.gallery import filing
from kinetix.errors import LevelError
from kinetix.level.codec import dumps
from kinetix.level.model import Level
from kinetix.level.sets import load_set
from tests.editor.core.test_gallery import playable
from tests.editor.gui.browsing import settle

COUNT = 120


@pytest.fixture
def many(make_gui, mine):
    """A gallery with many levels, all of which are chosen."""
    base = playable("Level")
    for k in range(COUNT - 3):
        level = base.replace(name=f"Level {k}", max_timesteps=k + 1)
        (mine / f"level_{k:04d}.json").write_text(dumps(level))
    gui = make_gui(level=Level(name="Open"))
    gui.key("ctrl+g")
    settle(gui)
    gui.key("ctrl+a")
    assert len(gui.session.gallery.selection) == COUNT
    return gui


def count(monkeypatch, module, name):
    """Return a list that grows with every call of a function."""
    calls, real = [], getattr(module, name)
    monkeypatch.setattr(module, name, lambda *args: calls.append(args) or real(*args))
    return calls


def test_folders_are_not_resolved_anew_in_every_frame(many, monkeypatch):
    calls = count(monkeypatch, filing, "levels_dir")
    many.frames(10)
    assert calls == []


def test_only_the_lines_in_sight_of_a_set_are_drawn(many):
    many.key("ctrl+shift+a")
    many.click("gallery.tab.set")
    shown = [name for name in many.session.probe if name.startswith("gallery.weight.")]
    assert len(many.session.gallery.tray) == COUNT and 5 < len(shown) < 60


def test_the_questions_of_the_export_look_for_files_now_and_then(many, monkeypatch):
    many.session.queue("level.export_set")
    many.frames(4)
    calls = count(monkeypatch, level_sets, "refused_in_set")
    many.frames(30)
    assert len(calls) <= 1
    many.frames(60)
    assert calls


def export(gui):
    """Answer the questions of the export, as a person would."""
    gui.session.queue("level.export_set")
    gui.frames(4)
    gui.click("export.accept")
    gui.frames(4)
    gui.click("browser.accept")


@pytest.fixture
def held(monkeypatch):
    """The export goes on once this is set."""
    going, real = threading.Event(), level_sets.export_set

    def wait(*args):
        assert going.wait(60)
        return real(*args)

    monkeypatch.setattr(level_sets, "export_set", wait)
    yield going
    going.set()


def test_many_levels_are_exported_beside_the_window(many, mine, held):
    session = many.session
    export(many)
    many.frames(4)
    assert session.gallery.exporting == mine / "levels.json" and session.gallery.plan is None
    assert session.toasts[-1].text == f"Exporting {COUNT} levels to {mine / 'levels.json'} …"
    quitting.quit_app(session)
    assert "levels.json" in session.prompts[-1].message and not session.quitting
    session.answer(session.prompts[-1], "wait")
    many.frames(4)
    assert not session.quitting
    held.set()
    finish(many)
    assert len(load_set(mine / "levels.json").levels) == COUNT
    many.frames(2)
    assert session.quitting


def test_an_export_in_the_background_that_fails_is_told_and_asked_again(many, monkeypatch):
    def full(*args):
        raise LevelError("levels.json: cannot be saved: No space left on device")

    monkeypatch.setattr(level_sets, "export_set", full)
    export(many)
    finish(many)
    many.frames(4)
    assert any("No space" in toast.text for toast in many.session.toasts)
    assert many.shows("export.accept")


def finish(gui):
    """Let the export that goes on come to its end."""
    until = time.monotonic() + 60
    while gui.session.gallery.exporting is not None:
        assert time.monotonic() < until
        gui.frames(1)
        time.sleep(0.005)


def test_a_link_to_a_level_of_the_app_is_one_of_the_apps(tmp_path, monkeypatch):
    app, mine = tmp_path / "app", tmp_path / "mine"
    app.mkdir()
    mine.mkdir()
    (app / "a.json").write_text("{}")
    (mine / "own.json").write_text("{}")
    (mine / "link.json").symlink_to(app / "a.json")
    monkeypatch.setattr(filing, "levels_dir", lambda: app)
    assert not filing.any_bundled([mine / "own.json"])
    assert filing.any_bundled([mine / "own.json", mine / "link.json"])
    assert filing.any_bundled([app / "a.json"])
