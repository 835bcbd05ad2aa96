"""Two windows, or another program, and one file: nobody's work is lost without a question."""

import os

import pytest

from editor import actions
from editor.actions.files import file
from editor.documents.autosaves import Autosaves
from editor.documents.commands.group import Move
from editor.session import Session
from kinetix.errors import LevelError
from kinetix.level.codec import level_hash, load_level, save_level
from tests.editor.core.helpers import a_level, a_session, texts

MOVE = Move(ids=(3,), shift=(0.25, 0.0))


def change_outside(path, name="theirs"):
    stamp = path.stat().st_mtime_ns
    save_level(a_level().replace(name=name), path)
    os.utime(path, ns=(stamp + 10**9, stamp + 10**9))


def opened(*paths):
    session = a_session()
    for path in paths:
        assert file.open_path(session, path)
    return session


@pytest.mark.parametrize("answer", ["save mine", "keep mine"])
def test_what_another_window_saved_outlives_the_next_saves(path, answer):
    session = opened(path)
    session.execute(MOVE)
    change_outside(path)
    if answer == "keep mine":
        actions.update(session, 2.1)
        assert actions.run(session, "file.keep_mine")
    actions.run(session, "file.save")
    if answer == "save mine":
        told = {choice.id: choice.detail for choice in session.prompts[-1].choices}
        assert told["mine"] == "The other one is kept as mine.json.bak2."
        session.answer(session.prompts[-1], "mine")
    for _ in range(2):
        session.execute(MOVE)
        actions.run(session, "file.save")
    assert not session.prompts and not session.document.dirty
    assert load_level(path.with_name("mine.json.bak2")).name == "theirs"
    assert len(list(path.parent.glob("mine*"))) == 3  # of one's own work one backup, as ever


def test_a_level_that_another_window_replaced_is_asked_about(path):
    session = opened(path)
    session.execute(MOVE)
    actions.run(session, "file.save")
    mine = session.document.hash
    change_outside(path)
    actions.run(session, "file.quit")
    assert not session.quitting
    assert any("in no file" in text for text in texts(session))
    session.answer(session.prompts[-1], "save")
    session.answer(session.prompts[-1], "mine")
    assert session.quitting and level_hash(load_level(path)) == mine


def test_a_level_whose_file_was_damaged_is_asked_about(path):
    session = opened(path)
    mine = session.document.hash
    path.write_text("{")
    actions.run(session, "file.quit")
    assert not session.quitting
    session.answer(session.prompts[-1], "save")
    session.answer(session.prompts[-1], "mine")
    assert session.quitting and level_hash(load_level(path)) == mine


def test_a_tab_whose_file_was_replaced_is_asked_about(path, tmp_path):
    save_level(a_level(), tmp_path / "other.json")
    session = opened(tmp_path / "other.json", path)
    session.execute(MOVE)
    actions.run(session, "file.save")
    change_outside(path)
    tab = session.tabs[session.tabs.locate(path)]
    file.close_tab(session, tab)
    assert session.prompts[-1].title == "Unsaved changes" and tab in session.tabs
    session.answer(session.prompts[-1], "discard")
    assert tab not in session.tabs


def test_a_newer_version_of_a_level_that_was_only_looked_at_is_not_asked_about(path):
    session = opened(path)
    change_outside(path)
    actions.run(session, "file.quit")
    assert session.quitting


def test_a_file_that_says_the_same_is_not_asked_about(path):
    session = opened(path)
    session.execute(MOVE)
    actions.run(session, "file.save")
    save_level(session.document.level, path)
    stamp = path.stat().st_mtime_ns
    os.utime(path, ns=(stamp + 10**9, stamp + 10**9))
    actions.run(session, "file.quit")
    assert session.quitting


def test_a_file_that_goes_behind_another_tab_leaves_its_level_unsaved(path, tmp_path):
    save_level(a_level(), tmp_path / "other.json")
    session = opened(path, tmp_path / "other.json")
    path.unlink()
    actions.update(session, 2.1)
    assert [tab.document.dirty for tab in session.tabs] == [False, True, False]
    assert sum("was removed" in text for text in texts(session)) == 1


def test_a_file_that_goes_during_play_leaves_its_level_unsaved(path):
    session = opened(path)
    actions.run(session, "run.play_human")
    assert not session.editing
    path.unlink()
    actions.update(session, 2.1)
    assert session.tab.document.dirty


def test_a_file_that_went_just_now_is_asked_about_at_the_end(path):
    session = opened(path)
    path.unlink()
    actions.run(session, "file.quit")
    assert not session.quitting and session.prompts


def test_which_files_are_open_is_told_once_the_disk_has_room(path, monkeypatch):
    now, told = [0.0], []
    session = Session(autosaves=Autosaves(clock=lambda: now[0]))
    assert file.open_path(session, path)

    def full(path, data):
        raise LevelError(f"{path}: cannot be saved: No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("editor.documents.autosaves.write_atomically", full)
        for _ in range(20):
            now[0] += 1.0
            actions.update(session, 0.1)
            told += texts(session)
            session.toasts.clear()
    assert sum("No space" in text for text in told) == 1
    now[0] += 6.0
    actions.update(session, 0.1)
    other = Session(autosaves=Autosaves())
    assert other.autosaves.open_elsewhere(path)
    session.autosaves.end()
