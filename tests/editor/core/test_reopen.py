"""A start without files shows what was open when the app closed last; a first one the welcome."""

from pathlib import Path

import pytest

from editor.__main__ import Options, _open_files
from editor.actions import guide
from editor.actions.files import file, reopen
from editor.base.settings import Settings, SettingsKeeper
from editor.documents.autosaves import Autosaves
from editor.documents.commands.fields import SetField
from editor.session import Session
from kinetix.level.codec import save_level
from tests.editor.core.helpers import a_level

WELCOME = "rover_ridge.json"


def started(*, options=None, quits=False, **kept):
    """A session as a start without files leaves it."""
    settings = Settings.load()
    session = Session(settings=settings, keeper=SettingsKeeper(settings), **kept)
    _open_files(options or Options(), session)
    if quits:
        quit_(session)
    return session


def quit_(session):
    session.settings.layout = "as it is"
    reopen.note(session)
    session.keeper.save()


def titles(session):
    return [tab.document.title for tab in session.tabs]


@pytest.fixture
def levels(tmp_path):
    paths = [tmp_path / f"{name}.json" for name in "abc"]
    for path in paths:
        save_level(a_level(), path)
    return paths


@pytest.fixture
def closed(levels):
    """An earlier run has ended that had three levels open, the second one in front."""
    session = started()
    assert titles(session) == [WELCOME]
    session.close_tab(session.tab)
    for path in levels:
        file.open_path(session, path)
    file.new(session)
    session.show_tab(1)
    quit_(session)
    return session


def test_a_first_start_shows_the_welcome_level_and_offers_the_guide():
    session = started(quits=True)
    assert titles(session) == [WELCOME] and session.settings.recents == []
    assert session.settings.guide_step == guide.OFFERED
    session = started()
    assert titles(session) == [WELCOME] and session.settings.guide_step == guide.CLOSED


def test_the_levels_of_the_last_time_are_open_again(closed):
    session = started()
    assert titles(session) == ["a.json", "b.json", "c.json"]
    assert session.document.title == "b.json"
    assert session.settings.recents == closed.settings.recents
    assert session.toasts == [] and session.prompts == []


def test_what_is_gone_or_damaged_is_told_once(closed, levels):
    levels[1].unlink()
    levels[2].write_text("{")
    session = started()
    assert titles(session) == ["a.json"] and session.prompts == []
    (told,) = [toast.text for toast in session.toasts]
    assert told.endswith(": b.json, c.json")
    quit_(session)
    levels[0].unlink()
    session = started()
    assert titles(session) == [WELCOME]


def test_after_a_crash_none_is_opened(closed):
    started()  # and it never comes to its end
    assert titles(started()) == [WELCOME]


def test_a_level_that_ends_the_app_as_it_is_opened_is_not_opened_again(closed, monkeypatch):
    def ends(*_):
        raise SystemExit(1)

    with monkeypatch.context() as patch:
        patch.setattr("editor.actions.files.reopen.open_quietly", ends)
        with pytest.raises(SystemExit):
            started()
    assert titles(started()) == [WELCOME]


def test_a_second_window_does_not_open_them_too(closed):
    first = started()
    second = started()
    assert titles(second) == [WELCOME]
    quit_(first)
    assert titles(started()) == ["a.json", "b.json", "c.json"]


def test_what_another_window_has_open_is_left_to_it(closed, levels):
    other = Autosaves()
    other.open_files([levels[1]])
    session = started(autosaves=Autosaves())
    assert titles(session) == ["a.json", "c.json"]
    assert session.toasts == [] and session.prompts == []
    other.end()


def test_files_that_are_named_are_all_that_is_opened(closed, levels):
    session = started(options=Options(files=(str(levels[2]),)))
    assert titles(session) == ["c.json"]


def test_replays_and_recordings_begin_as_ever(closed):
    session = started(options=Options(record=Path("script.jsonl")))
    assert titles(session) == [WELCOME] and session.settings.guide_step == -1
    session = started(options=Options(replay=Path("script.jsonl")))
    assert titles(session) == ["Untitled"]


def test_unsaved_work_on_an_open_level_is_restored_in_its_tab(closed):
    session = started(autosaves=Autosaves())
    body = session.document.level.bodies[0].id
    session.execute(SetField(ids=(body,), field="name", value="Board"))
    session.save_aside()
    session.autosaves.end()
    quit_(session)  # as a signal ends it
    session = started(autosaves=Autosaves())
    (prompt,) = [each for each in session.prompts if each.title == "Restore unsaved work?"]
    session.answer(prompt, "restore")
    assert titles(session) == ["a.json", "b.json", "c.json"]
    assert session.document.title == "b.json" and session.document.dirty
    session.autosaves.end()
