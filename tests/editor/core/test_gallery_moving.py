"""Levels of the gallery go to another folder: moved or copied, and brought back."""

import pytest

from editor import actions
from editor.actions.gallery import gallery_files
from editor.base.prompts import FileQuestion
from tests.editor.core.helpers import texts
from tests.editor.core.test_gallery import (  # noqa: F401
    choose,
    folder,
    names_of,
    playable,
    session,
)

# The fixtures `folder` and `session` are those of the gallery's tests.
# ruff: noqa: F811


def put(session, folder, *, copies=False):
    """As letting cards go over a folder does."""
    session.queue(lambda: gallery_files.put_into(session, folder, copies=copies))
    actions.update(session, 0.01)


def test_levels_are_moved_and_the_message_brings_them_back(session, folder):
    choose(session, "Rocket", "Hill cart")
    put(session, folder)
    assert "Moved rocket" not in texts(session)[-1] and "hill_cart" in texts(session)[-1]
    assert (folder / "hill_cart.json").exists() and (folder / "rocket.json").exists()
    assert session.toasts[-1].action == "gallery.restore"
    actions.run(session, "gallery.restore")
    assert (folder / "carts" / "hill_cart.json").exists()
    assert {"Hill cart", "Rocket"} <= names_of(session)


def test_the_open_tab_and_the_set_follow_there_and_back(session, folder):
    choose(session, "Rocket")
    actions.run(session, "gallery.open")
    actions.run(session, "level.gallery")
    choose(session, "Rocket")
    session.gallery.tray = {str(folder / "rocket.json"): 3.0}
    put(session, folder / "carts")
    there = folder / "carts" / "rocket.json"
    assert session.document.path == there and not session.document.dirty
    assert session.gallery.tray == {str(there): 3.0} and str(there) in session.settings.recents
    actions.update(session, 2.0)
    assert session.document.outside == ""
    actions.run(session, "gallery.restore")
    assert session.document.path == folder / "rocket.json"
    assert session.gallery.tray == {str(folder / "rocket.json"): 3.0}


def test_a_file_of_the_same_name_stays(session, folder):
    (folder / "carts" / "rocket.json").write_text("{}")
    choose(session, "Rocket")
    put(session, folder / "carts")
    assert (folder / "carts" / "rocket.json").read_text() == "{}"
    assert (folder / "carts" / "rocket_2.json").exists() and not (folder / "rocket.json").exists()


@pytest.mark.parametrize("bundled", [False, True], ids=["with Ctrl", "the app's own"])
def test_copies_leave_the_levels_where_they_are(session, folder, tmp_path, monkeypatch, bundled):
    own = tmp_path / "own"
    if bundled:
        monkeypatch.setattr("editor.gallery.filing.levels_dir", lambda: folder)
    choose(session, "Rocket")
    put(session, own, copies=not bundled)
    assert (own / "rocket.json").read_bytes() == (folder / "rocket.json").read_bytes()
    assert session.toasts[-1].action is None
    assert str(own) in session.settings.gallery_folders


def test_a_folder_is_asked_for_and_may_be_a_new_one(session, folder):
    choose(session, "Rocket")
    actions.run(session, "gallery.move_to")
    (prompt,) = session.prompts
    assert isinstance(prompt, FileQuestion) and prompt.folder == folder and prompt.fresh
    session.answer(prompt, folder / "new")
    assert (folder / "new" / "rocket.json").exists()
    assert "Rocket" in names_of(session)


def test_what_cannot_be_moved_says_why(session, folder, monkeypatch):
    choose(session, "Rocket")
    put(session, folder)
    assert "is the folder of these levels" in texts(session)[-1]
    (folder / "file").write_text("")
    put(session, folder / "file")
    assert "cannot be moved to" in texts(session)[-1] and (folder / "rocket.json").exists()
    actions.run(session, "gallery.open")
    session.document.mark_unsaved()
    actions.run(session, "level.gallery")
    choose(session, "Rocket")
    put(session, folder / "carts")
    assert "unsaved changes" in texts(session)[-1]
    monkeypatch.setattr("editor.gallery.filing.levels_dir", lambda: folder)
    put(session, folder / "carts")
    assert "came with the app" in texts(session)[-1]
