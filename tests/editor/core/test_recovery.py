"""Copies of unsaved work: soon made, offered to the next run, kept until saved or given up."""

import contextlib
import dataclasses
import datetime
import gc
import json
import multiprocessing
import os
import re
import shutil
import threading
import time
import weakref
from pathlib import Path

import pytest

from editor import actions
from editor.__main__ import _until_closed
from editor.actions.files import file, recover
from editor.base.language import Language, languages, read_words
from editor.documents import autosaves, files, recovery, run_lock
from editor.documents.autosaves import LONGEST, PAUSE, Autosaves, autosave_dir
from editor.documents.commands.group import Move
from editor.documents.document import Document
from editor.session import Session
from editor.session.messages import TOAST_SECONDS
from editor.worker.jobs import Worker
from editor.worker.requests import ExportPicture
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Level
from tests import forks
from tests.editor.core.endless_edits import edit_for_ever
from tests.editor.core.helpers import a_level, a_session, texts

KILLED = datetime.datetime(2026, 11, 28, 23, 52, tzinfo=datetime.UTC)
MOVE = Move(ids=(3,), shift=(0.25, 0.0))
OLD = Path(__file__).resolve().parents[1] / "stored" / "0.1.0" / "state" / "kinetix-editor"


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "levels" / "mine.json"
    path.parent.mkdir()
    save_level(a_level(), path)
    return path


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def start(clock):
    """Starts runs; one that is killed leaves what it has written."""
    runs = []

    def begin(*paths, level=None, **parts):
        level = level or Level(name="Untitled")
        session = Session(autosaves=Autosaves(clock=clock), level=level, **parts)
        for each in paths:
            file.open_path(session, each)
        recover.offer(session)
        runs.append(session)
        return session

    yield begin
    for session in runs:
        session.autosaves.end()


def later(session, clock, seconds):
    """Let time pass in frames of a quarter of a second."""
    for _ in range(int(seconds * 4)):
        clock.now += 0.25
        actions.update(session, 0.25)
    session.autosaves.flush()


def kill(session):
    """End a run as SIGKILL does: the system gives its lock back and nothing more is written."""
    autosaves = session.autosaves
    with autosaves._wake:
        for watched in autosaves._watched.values():
            watched.wanted, watched.gone = None, False
    autosaves.flush()  # a thread cannot be stopped within a write, as a process can
    lock = autosaves._lock
    if lock is not None:
        lock._released.set()
        lock._file.close()
    autosaves._stored = False


def copies():
    return sorted(autosave_dir().glob("*/*[0-9].json"))


def left(start, clock, path):
    """Leave the files of a killed run that has moved a shape of a file."""
    session = start(path)
    session.execute(MOVE)
    later(session, clock, 4)
    kill(session)
    return session.document.level


def test_a_change_is_copied_soon_after_a_pause(start, clock, path):
    session = start(path)
    later(session, clock, 10)
    assert copies() == []
    session.execute(MOVE)
    later(session, clock, PAUSE - 0.5)
    assert copies() == []
    later(session, clock, 0.75)
    (file,) = copies()
    assert recovery._read(file).level == session.document.level
    assert recovery._read(file).path == path


def test_changes_without_a_pause_are_copied_as_well(start, clock, path):
    session = start(path)
    for _ in range(round(2 * LONGEST) + 1):
        assert copies() == []
        session.execute(Move(ids=(3,), shift=(0.01, 0.0)))
        later(session, clock, 0.5)
    assert len(copies()) == 1


def test_a_fault_that_ends_the_app_leaves_a_copy(start, path):
    class Broken:
        def run(self):
            raise RuntimeError("a fault outside of every frame")

    session = start(path)
    session.execute(MOVE)
    with pytest.raises(RuntimeError, match="outside"):
        _until_closed(session, Broken())
    (file,) = copies()
    assert recovery._read(file).level == session.document.level


def test_the_same_is_not_written_twice(start, clock, path):
    session = start(path)
    session.execute(MOVE)
    later(session, clock, 3)
    (file,) = copies()
    written = file.stat().st_mtime_ns
    later(session, clock, 20)
    session.autosaves.keep(session.document)
    session.autosaves.flush()
    assert file.stat().st_mtime_ns == written


def test_saving_removes_the_copy(start, clock, path):
    session = start(path)
    session.execute(MOVE)
    later(session, clock, 3)
    actions.run(session, "file.save")
    later(session, clock, 0.5)
    assert copies() == []


def test_undoing_to_what_is_saved_removes_it_and_redoing_brings_it_back(start, clock, path):
    session = start(path)
    session.execute(MOVE)
    later(session, clock, 3)
    actions.run(session, "edit.undo")
    later(session, clock, 1)
    assert copies() == []
    actions.run(session, "edit.redo")
    later(session, clock, 3)
    assert len(copies()) == 1


def test_a_document_without_its_file_is_copied(start, clock, path):
    session = start(path)
    path.unlink()
    later(session, clock, 6)
    assert session.document.dirty
    assert len(copies()) == 1


@pytest.mark.parametrize("copied", [False, True], ids=["before its copy", "after its copy"])
def test_restoring_keeps_the_copy_until_the_level_is_saved(start, clock, path, copied):
    level = left(start, clock, path)
    (first,) = copies()
    session = start()
    session.answer(session.prompts[-1], "restore")
    assert session.document.level == level
    assert session.document.dirty and session.document.path == path
    assert first.exists()
    if copied:
        session.autosaves.flush()
    kill(session)  # right after restoring: nothing is lost
    session = start()
    session.answer(session.prompts[-1], "restore")
    later(session, clock, 4)
    actions.run(session, "file.save")
    later(session, clock, 1)
    assert load_level(path) == level
    assert copies() == []
    session.autosaves.end()
    assert list(autosave_dir().iterdir()) == []
    assert not start().prompts


def test_what_one_window_has_restored_another_does_not_offer(start, clock, path):
    left(start, clock, path)
    first = start()
    first.answer(first.prompts[-1], "restore")
    first.autosaves.flush()
    assert not start().prompts
    kill(first)
    assert start().prompts


def test_a_chain_of_killed_runs_offers_the_last_state_once(start, clock, path):
    left(start, clock, path)
    for _ in range(3):
        session = start()
        session.answer(session.prompts[-1], "restore")
        session.execute(MOVE)
        later(session, clock, 4)
        kill(session)
    found = recovery.find()
    assert [each.level for each in found.recoveries] == [session.document.level]
    assert len(copies()) == 4
    session = start()
    assert "mine.json" in session.prompts[-1].message
    session.answer(session.prompts[-1], "discard")
    assert copies() == []


def test_what_was_discarded_can_be_brought_back(start, clock, path):
    for level in (None, a_level()):
        session = start(*([path] if level is None else []), level=level)
        if session.prompts:
            session.answer(session.prompts[-1], "later")
        session.execute(MOVE)
        later(session, clock, 4)
        kill(session)
    before = {file.name: file.read_bytes() for file in copies()}
    session = start()
    assert not actions.run(session, "file.undiscard")
    session.answer(session.prompts[-1], "discard")
    assert copies() == [] and recovery.find().recoveries == ()
    assert session.toasts[-1].action == "file.undiscard"
    assert "2 copies" in session.toasts[-1].text
    assert actions.run(session, "file.undiscard")
    assert {file.name: file.read_bytes() for file in copies()} == before
    session.answer(session.prompts[-1], "restore")
    assert [tab.document.dirty for tab in session.tabs].count(True) == 2


def chain_of_runs(count, start, clock, path):
    """Kill runs that each go on with what the one before left; returns the last."""
    for _ in range(count):
        session = start(path)
        for prompt in tuple(session.prompts):
            session.answer(prompt, "restore")
        session.execute(MOVE)
        later(session, clock, PAUSE + 1)
        kill(session)
    return session


def test_of_a_chain_of_copies_the_oldest_goes_first(start, clock, path, monkeypatch):
    """So that a kill in between leaves the newest."""
    chain_of_runs(3, start, clock, path)
    (chain,) = recovery.find().recoveries
    assert len(chain.origin) == 2
    removed = []
    monkeypatch.setattr(autosaves, "discard", removed.append)
    recovery.discard(chain)
    assert removed == [*reversed(chain.origin), chain.file]
    times = [json.loads(file.read_text())["time"] for file in removed]
    assert times == sorted(times)


def test_a_chain_that_was_saved_goes_whatever_its_folders_are_called(start, clock, path):
    """The newest copy may be read before those that it began with."""
    session = chain_of_runs(4, start, clock, path)
    save_level(session.document.level, path)
    found = recovery.find()
    assert found == recovery.Found(recoveries=(), unreadable=())
    assert copies() == []


def test_restored_work_can_be_undone_to_the_file(start, clock, path):
    left(start, clock, path)
    session = start()
    session.answer(session.prompts[-1], "restore")
    actions.run(session, "edit.undo")
    assert session.document.level.bodies == a_level().bodies
    later(session, clock, 4)
    assert len(copies()) == 1  # neither saved nor given up


def test_closing_without_saving_gives_it_up(start, clock, path):
    left(start, clock, path)
    session = start()
    session.answer(session.prompts[-1], "restore")
    actions.run(session, "file.close_tab")
    session.answer(session.prompts[-1], "discard")
    later(session, clock, 1)
    assert copies() == []


def test_what_is_restored_stands_in_the_order_of_its_tabs(start, clock, path):
    session = start(path)
    for name in ("b", "c"):
        save_level(a_level(), path.with_name(f"{name}.json"))
        file.open_path(session, path.with_name(f"{name}.json"))
    names = [tab.document.path.name for tab in session.tabs]
    for number in (2, 0, 1):
        session.show_tab(number)
        session.execute(MOVE)
        later(session, clock, 4)
    kill(session)
    session = start()
    session.answer(session.prompts[-1], "restore")
    assert [tab.document.path.name for tab in session.tabs if tab.document.path] == names
    assert session.document.path.name == names[1]  # it was worked on last


def test_asking_again_next_time_keeps_it(start, clock, path):
    left(start, clock, path)
    for _ in range(2):
        session = start()
        session.answer(session.prompts[-1], "later")
        session.autosaves.end()
    assert len(copies()) == 1


def test_it_is_offered_when_a_file_is_named_too(start, clock, path):
    level = left(start, clock, path)
    session = start(path)
    assert session.prompts[-1].title == "Restore unsaved work?"
    session.answer(session.prompts[-1], "restore")
    assert [tab.document.path for tab in session.tabs] == [path]
    assert session.document.level == level


def test_the_command_line_offers_it_however_it_starts(start, clock, path):
    from editor.__main__ import Options, _open_files

    left(start, clock, path)
    for options in (Options(), Options(files=(path,))):
        session = Session(autosaves=Autosaves(stored=False))
        _open_files(options, session)
        assert session.prompts[-1].title == "Restore unsaved work?"


def test_work_without_a_file_is_restored_in_a_tab(start, clock):
    session = start(level=a_level())
    session.execute(MOVE)
    later(session, clock, 4)
    kill(session)
    other = start()
    other.answer(other.prompts[-1], "restore")
    assert other.document.level.bodies == session.document.level.bodies
    assert other.document.path is None and other.document.dirty


def test_work_whose_file_is_gone_is_restored(start, clock, path):
    level = left(start, clock, path)
    path.unlink()
    session = start()
    assert "gone" in session.prompts[-1].message
    session.answer(session.prompts[-1], "restore")
    assert (session.document.level, session.document.path) == (level, path)
    actions.run(session, "file.save")
    assert load_level(path) == level


def test_what_was_saved_before_the_kill_is_not_offered(start, clock, path):
    level = left(start, clock, path)
    save_level(level, path)
    assert not start().prompts
    assert copies() == []


def test_saving_restored_work_asks_when_the_file_has_changed_since(start, clock, path):
    left(start, clock, path)
    save_level(a_level().replace(description="by another program"), path)
    session = start()
    session.answer(session.prompts[-1], "restore")
    actions.run(session, "file.save")
    assert "changed by another program" in session.prompts[-1].title


def test_a_run_that_goes_on_is_left_alone(start, clock, path):
    session = start(path)
    session.execute(MOVE)
    later(session, clock, 4)
    assert not start().prompts
    assert len(copies()) == 1


def test_equal_process_ids_do_not_matter(start, clock, path, monkeypatch):
    monkeypatch.setattr(os, "getpid", lambda: 7)
    level = left(start, clock, path)
    session = start()
    session.execute(MOVE) if session.document.level.bodies else None
    assert session.prompts
    session.answer(session.prompts[-1], "restore")
    assert session.document.level == level


@pytest.mark.parametrize("silent", [False, True])
def test_a_run_on_another_machine_is_known_by_its_heartbeat(start, clock, path, silent):
    left(start, clock, path)
    lock = copies()[0].parent / "lock"
    lock.write_text("another boot")
    if silent:
        long_ago = time.time() - 2 * run_lock.SILENCE
        os.utime(lock, (long_ago, long_ago))
    assert bool(start().prompts) == silent


def test_what_version_0_1_0_left_is_offered(start, tmp_path):
    shutil.copytree(OLD / "autosave", autosave_dir())
    session = start()
    assert "first_flight.json" in session.prompts[-1].message
    session.answer(session.prompts[-1], "restore")
    assert len(session.tabs) == 2
    assert {tab.document.dirty for tab in session.tabs} == {True}
    for tab in list(session.tabs):
        session.autosaves.forget(tab.document)
    assert list(autosave_dir().glob("*.json")) == []


@pytest.mark.parametrize(
    "content", ["", "{", "{}", '{"path": 3}', "[]", "\0", '{"path":null,"format":"x"}', "[" * 9999]
)
def test_a_damaged_copy_is_told_and_stays(start, clock, path, content):
    left(start, clock, path)
    (good,) = copies()
    bad = good.with_name("2.json")
    bad.write_text(content)
    session = start()
    assert any(str(bad) in text for text in texts(session))
    session.answer(session.prompts[-1], "restore")
    assert session.document.level.bodies != a_level().bodies
    assert bad.exists()


def test_a_full_disk_is_told_and_tried_again(start, clock, path, monkeypatch):
    session = start(path)
    session.execute(MOVE)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("kinetix.files.atomic.os.fsync", full)
    for _ in range(4):
        clock.now += 1
        actions.update(session, 0.25)
        with pytest.MonkeyPatch.context():
            try:
                session.autosaves.flush()
            except KinetixError as error:
                session.toast(str(error))
        assert session.autosaves.kept_at(session.document) is None
    assert any("No space left" in text for text in texts(session))
    monkeypatch.undo()
    monkeypatch.setattr("editor.documents.autosaves.state_dir", lambda: path.parents[1] / "state")
    later(session, clock, 4)
    assert len(copies()) == 1
    assert session.autosaves.kept_at(session.document) is not None


@pytest.mark.parametrize("gone", ["the folder", "the lock"])
def test_copies_are_made_again_where_their_folder_is_gone(start, clock, path, gone):
    session = start(path)
    session.execute(MOVE)
    session.open_tab(Document(a_level()))
    session.execute(MOVE)
    later(session, clock, 4)
    assert len(copies()) == 2
    if gone == "the folder":
        shutil.rmtree(autosave_dir())
    else:
        (session.autosaves.folder / "lock").unlink()
    session.execute(MOVE)
    later(session, clock, 4)
    later(session, clock, 4)  # the others, once it is known that they are gone
    levels = [recovery._read(copy).level for copy in copies()]
    assert len(levels) == 2 and session.document.level in levels
    assert not texts(session)
    assert autosaves.goes_on(session.autosaves.folder)
    assert not start().prompts
    assert Autosaves().open_elsewhere(path)


@pytest.mark.parametrize("choice", ["save", "discard"])
def test_what_was_closed_is_let_go(start, clock, path, choice):
    session = start(path)
    session.open_tab(Document(a_level()))
    session.show_tab(0)
    session.execute(MOVE)
    later(session, clock, 4)
    closed = weakref.ref(session.document)
    actions.run(session, "file.close_tab")
    session.answer(session.prompts[-1], choice)
    later(session, clock, 1)
    later(session, clock, TOAST_SECONDS)  # a message may be about it
    gc.collect()
    assert closed() is None


def test_an_ended_run_leaves_no_folder(start, clock, path):
    session = start(path)
    session.execute(MOVE)
    later(session, clock, 4)
    actions.run(session, "file.save")
    later(session, clock, 1)
    session.autosaves.end()
    assert list(autosave_dir().iterdir()) == []


# -- two windows ---------------------------------------------------------------------------------


def test_a_second_window_warns_before_it_opens_the_file(start, clock, path):
    first = start(path)
    later(first, clock, 0.5)
    second = start(path)
    (prompt,) = second.prompts
    assert prompt.title == "mine.json is open in another window"
    assert all(tab.document.path is None for tab in second.tabs)
    second.answer(prompt, "copy")
    assert second.document.path is None
    assert second.document.level.bodies == a_level().bodies
    file.open_path(second, path)
    second.answer(second.prompts[-1], "open")
    assert second.document.path == path


def test_a_window_that_has_closed_the_file_or_was_killed_is_no_reason_to_warn(start, clock, path):
    first = start(path)
    later(first, clock, 0.5)
    actions.run(first, "file.close_tab")
    later(first, clock, 0.5)
    second = start(path)
    assert not second.prompts
    later(second, clock, 0.5)
    kill(second)
    assert not start(path).prompts


# -- a save that would lose another program's change ----------------------------------------------


@pytest.fixture
def contested(start, path):
    """A session with a change, whose file another program has changed at the same instant."""
    session = start(path)
    session.execute(MOVE)
    before = path.stat()
    theirs = a_level().replace(description="theirs")
    save_level(theirs, path)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    actions.run(session, "file.save")
    assert load_level(path) == theirs
    return session, theirs


def test_both_are_shown_and_nothing_is_written_before_the_answer(contested, path):
    session, theirs = contested
    prompt = session.prompts[-1]
    assert [level for _, level in prompt.pictures] == [session.document.level, theirs]
    session.answer(prompt, "cancel")
    assert load_level(path) == theirs and session.document.dirty


def test_keep_both(contested, path):
    session, theirs = contested
    session.answer(session.prompts[-1], "both")
    assert load_level(path) == theirs
    assert session.document.path == path.with_name("mine_2.json")
    assert load_level(session.document.path) == session.document.level
    assert not session.document.dirty


def test_save_mine(contested, path):
    session, theirs = contested
    session.answer(session.prompts[-1], "mine")
    assert load_level(path) == session.document.level
    assert load_level(path.with_name("mine.json.bak2")) == theirs
    actions.run(session, "file.save")
    assert not session.prompts


def test_take_theirs(contested, path):
    session, theirs = contested
    mine = session.document.level
    session.answer(session.prompts[-1], "theirs")
    assert session.document.level == theirs and not session.document.dirty
    actions.run(session, "edit.undo")
    assert session.document.level == mine


def test_a_file_that_is_damaged_meanwhile_can_be_replaced(start, path):
    session = start(path)
    session.execute(MOVE)
    path.write_text("{")
    actions.run(session, "file.save")
    prompt = session.prompts[-1]
    assert [choice.id for choice in prompt.choices] == ["both", "mine", "cancel"]
    session.answer(prompt, "mine")
    assert load_level(path) == session.document.level
    assert path.with_name("mine.json.bak2").read_text() == "{"


def test_saving_again_and_again_never_asks(start, path):
    session = start(path)
    for _ in range(5):
        session.execute(MOVE)
        actions.run(session, "file.save")
        assert not session.prompts
    assert not files.changed_outside(session.document)


# -- quitting ------------------------------------------------------------------------------------


@pytest.fixture
def three(start, tmp_path, path):
    """Two files with changes and one without."""
    other = tmp_path / "other.json"
    save_level(a_level(), other)
    clean = tmp_path / "clean.json"
    save_level(a_level(), clean)
    session = start(path, other, clean)
    for tab in session.tabs[:2]:
        tab.document.commit(MOVE)
    actions.run(session, "file.quit")
    return session


def test_quitting_asks_once_and_saves_all(three):
    (prompt,) = three.prompts
    assert "mine.json" in prompt.message and "other.json" in prompt.message
    assert "clean.json" not in prompt.message
    actions.run(three, "file.quit")  # the close button again
    assert len(three.prompts) == 1
    three.answer(prompt, "save")
    assert three.quitting
    for tab in three.tabs[:2]:
        assert load_level(tab.document.path) == tab.document.level


def test_quitting_can_discard_all(three, clock):
    later(three, clock, 4)
    assert len(copies()) == 2
    three.answer(three.prompts[-1], "discard")
    assert three.quitting
    three.autosaves.flush()
    assert copies() == []
    assert all(load_level(tab.document.path) == a_level() for tab in three.tabs)


@pytest.fixture
def held_up(start, path):
    """A file with changes, a picture that is being written, and what lets it be written."""
    gate = threading.Event()

    def perform(request, progress):
        assert gate.wait(30)
        return request.path

    session = start(path, worker=Worker(perform))
    session.execute(MOVE)
    picture = ExportPicture(level=a_level(), state=None, path=path.with_name("a.png"))
    session.worker.submit(picture, title="A picture")
    actions.run(session, "file.quit")
    yield session, gate
    gate.set()
    session.worker.stop()


def let_close(session, gate, clock):
    """Let the picture be written and frames pass until the app closes or asks."""
    gate.set()
    while not (session.quitting or session.prompts):
        later(session, clock, 0.25)
    session.autosaves.flush()


@pytest.mark.parametrize("choice", ["wait", "quit"])
def test_what_is_not_to_be_saved_is_not_kept_by_a_wait_at_the_end(held_up, clock, choice):
    session, gate = held_up
    session.answer(session.prompts[-1], "discard")
    later(session, clock, 4)  # the question stands
    session.answer(session.prompts[-1], choice)
    if choice == "wait":
        later(session, clock, 4)
        assert not session.quitting
    let_close(session, gate, clock)
    assert session.quitting and copies() == []


def test_what_is_changed_or_kept_after_all_is_copied_during_a_wait(held_up, clock):
    session, gate = held_up
    session.answer(session.prompts[-1], "discard")
    session.answer(session.prompts[-1], "wait")
    session.execute(MOVE)
    later(session, clock, 4)
    assert len(copies()) == 1
    let_close(session, gate, clock)
    assert not session.quitting and session.prompts[-1].title == "Unsaved changes"
    session.answer(session.prompts[-1], "cancel")
    later(session, clock, 4)
    assert len(copies()) == 1


def test_a_save_that_is_given_up_keeps_the_app_open(three):
    three.tabs[1].document.path = None
    three.answer(three.prompts[-1], "save")
    (name,) = three.prompts
    three.answer(name, None)
    assert not three.quitting


# -- kills ---------------------------------------------------------------------------------------


@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
@pytest.mark.parametrize("kills", [12, pytest.param(100, marks=pytest.mark.slow)])
def test_no_kill_loses_what_was_copied(tmp_path, path, kills):
    base = tmp_path / "state" / "autosave"
    known = 0
    for k in range(kills):
        heard, told = multiprocessing.Pipe(duplex=False)
        process = forks.start(edit_for_ever, base, path, told)
        told.close()
        began, recovered = heard.recv()
        assert began >= known, (k, began, recovered, known)
        assert recovered <= 1
        for _ in range(1 + k % 3):
            known = max(known, heard.recv())
        time.sleep(0.003 * (k * 7 % 23))
        process.kill()
        process.join()
        with heard, contextlib.suppress(EOFError, OSError):  # what it was telling when it died
            while True:
                known = max(known, heard.recv())
    assert known > kills


def test_a_document_of_its_own_number_is_never_another_ones_copy():
    one, other = Document(a_level()), Document(a_level())
    run = Autosaves()
    assert run._watch(one).file != run._watch(other).file
    assert run.folder != Autosaves().folder
    assert len(run.folder.name) == 16 and json.dumps(run.folder.name)


def test_tests_and_scripts_leave_nothing(path):
    session = a_session()
    session.autosaves = Autosaves(stored=False)
    session.execute(MOVE)
    for _ in range(60):
        actions.update(session, 1.0)
    session.autosaves.end()
    assert not autosaves.autosave_dir().exists()


@pytest.mark.parametrize("code", [code for code, _ in languages() if code != "en"])
@pytest.mark.parametrize("own", ["never", "equal", "other", "gone"])
def test_the_question_is_in_every_language(code, own, path):
    level = load_level(path)
    if own == "other":
        save_level(level.replace(joints=()), path)
    elif own == "gone":
        path.unlink()
    found = recovery.Recovery(
        file=path.with_name("1.json"),
        path=None if own == "never" else path,
        format="kinetix-level",
        time=KILLED,
        level=level,
    )
    spoken = Language(read_words(code))
    for parts in ({}, {"joints": ()}, {"thrusters": ()}, {"joints": (), "thrusters": ()}):
        each = dataclasses.replace(found, level=level.replace(**parts))
        said = spoken.translate(f"The app ended without saving\n{each.summary()}\n… and 2 more")
        assert not re.search("shape|joint|thruster|file|edited|saved", said), said
    assert sorted(spoken.missing) == []
