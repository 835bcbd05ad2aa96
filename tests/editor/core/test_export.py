"""Exports of a level in another program's format."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from editor import actions
from editor.actions.files import export, folders, recording
from editor.documents import files
from editor.documents.commands.group import Move, Remove
from editor.play.mode import Mode
from editor.play.trace_files import write_trace
from editor.worker.jobs import Job, JobState
from editor.worker.requests import ExportFilm
from editor.worker.snapshots import Snapshot, Trace
from kinetix.errors import LevelError
from kinetix.level.codec import load_document, save_level
from tests.editor.core.helpers import a_level, a_session, texts


@pytest.fixture
def session(tmp_path):
    session = a_session(a_level())
    save_level(a_level(), tmp_path / "mine.json")
    session.open_tab(files.open_document(tmp_path / "mine.json"))
    return session


def export_level(session, path):
    """File, Export…, Level for kinetix-env, and a name."""
    actions.run(session, "file.export")
    session.answer(session.prompts[-1], "json")
    session.answer(session.prompts[-1], path)


def test_where_exports_begin(session, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "editor.actions.files.folders.user_levels_dir", lambda: tmp_path / "Kinetix"
    )
    monkeypatch.setattr("editor.actions.files.export.user_levels_dir", lambda: tmp_path / "Kinetix")

    def asked():
        actions.run(session, "file.export")
        session.answer(session.prompts[-1], "json")
        return session.prompts[-1].folder

    assert asked() == tmp_path  # beside the level
    session.prompts.clear()
    actions.run(session, "file.new")
    assert asked() == Path.cwd()  # a script's
    session.prompts.clear()
    session.attended = True
    assert asked() == tmp_path / "Kinetix"
    (tmp_path / "other").mkdir()
    session.answer(session.prompts[-1], tmp_path / "other" / "theirs.json")
    assert asked() == tmp_path / "other"
    session.prompts.clear()
    session.settings.export_folder = str(tmp_path / "gone")
    actions.run(session, "file.screenshot")
    assert session.screenshot == tmp_path / "Kinetix" / "Untitled-001.png"
    assert (tmp_path / "Kinetix").is_dir()


def test_the_folder_of_a_level_that_is_gone_is_not_made_anew(session, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "editor.actions.files.folders.user_levels_dir", lambda: tmp_path / "Kinetix"
    )
    session.attended = True
    session.document.path = tmp_path / "stick" / "car.json"
    session.settings.export_folder = session.settings.save_folder = ""
    assert folders.to_export(session) == folders.to_save(session) == tmp_path / "Kinetix"


def test_a_level_is_exported_for_kinetix_env_as_it_stands(session, tmp_path):
    session.document.commit(Move(ids=(3,), shift=(0.25, 0.0)))
    export_level(session, tmp_path / "theirs.json")
    loaded = load_document(tmp_path / "theirs.json")
    assert loaded.format == "kinetix-env"
    assert loaded.level.bodies[2].position == pytest.approx((4.25, 3.0), abs=1e-3)
    assert session.document.dirty and session.document.path == tmp_path / "mine.json"
    assert "Wrote" in texts(session)[-1]


def test_what_kinetix_env_cannot_hold_is_told(session, tmp_path):
    export_level(session, tmp_path / "theirs.json")
    assert "kinetix-env has no place for: " in texts(session)[-1]


def test_a_level_that_is_open_is_not_replaced(session, tmp_path):
    before = (tmp_path / "mine.json").read_bytes()
    export_level(session, tmp_path / "mine.json")
    assert (tmp_path / "mine.json").read_bytes() == before
    assert "choose another name" in texts(session)[-1]


def test_a_file_that_was_there_stays_beside_the_export(session, tmp_path):
    (tmp_path / "theirs.json").write_text("something")
    export_level(session, tmp_path / "theirs.json")
    assert (tmp_path / "theirs.json.bak").read_text() == "something"


class Waiting:
    """A worker that never gets round to anything."""

    def __init__(self):
        self.jobs, self.done = (), {}

    def submit(self, request, title, done=None, **_):
        job = Job(request, title)
        self.done[job] = done
        self.jobs = (*self.jobs, job)
        return job

    def stop(self, seconds):
        del seconds

    def poll(self):
        pass

    def fail(self, reason):
        """Let the last job fail."""
        *jobs, job = self.jobs
        self.jobs, job.state, job.error = tuple(jobs), JobState.FAILED, reason
        self.done[job](job)


@pytest.fixture
def films(session):
    """The films that were asked for."""
    worker = session.worker = Waiting()
    session.playback.simulator.ends_at = 1000
    return lambda: [job.request for job in worker.jobs if isinstance(job.request, ExportFilm)]


def play(session, seconds):
    for _ in range(round(seconds * 60)):
        actions.update(session, 1 / 60)


def test_a_film_has_what_was_played_before_it_was_left_or_begun_again(session, films):
    actions.run(session, "file.record")
    actions.run(session, "run.play_human")
    play(session, 1.0)
    actions.run(session, "run.reset")
    play(session, 0.5)
    actions.run(session, "run.stop")
    play(session, 0.1)
    actions.run(session, "file.record")
    (film,) = films()
    steps = [snapshot.step for snapshot in film.trace.snapshots]
    again = steps.index(0, 1)
    assert steps[:again] == list(range(again)) and 25 <= again <= 32
    assert steps[again:] == list(range(len(steps) - again)) and 12 <= len(steps) - again <= 17


def test_a_film_begins_where_it_was_begun(session, films):
    actions.run(session, "run.play_human")
    play(session, 1.0)
    begun = session.playback.step_count
    actions.run(session, "file.record")
    play(session, 0.5)
    actions.run(session, "file.record")
    assert films()[0].trace.snapshots[0].step == begun


def test_two_films_in_a_row_have_names_of_their_own(session, films):
    actions.run(session, "run.play_human")
    for _ in range(2):
        actions.run(session, "file.record")
        play(session, 0.5)
        actions.run(session, "file.record")
    assert len({film.path for film in films()}) == 2


def test_nothing_played_is_no_film(session, films):
    actions.run(session, "file.record")
    play(session, 0.2)
    actions.run(session, "file.record")
    assert films() == []
    assert "Nothing was played" in texts(session)[-1]


def test_what_was_changed_while_a_film_was_awaited_is_asked_about(session, films):
    actions.run(session, "file.record")
    actions.run(session, "run.play_human")
    play(session, 0.5)
    actions.run(session, "file.quit")
    session.answer(session.prompts[-1], "wait")
    actions.run(session, "run.stop")
    session.document.commit(Move(ids=(3,), shift=(0.25, 0.0)))
    session.worker.jobs = ()
    play(session, 0.1)
    assert not session.quitting
    assert "Unsaved changes" in session.prompts[-1].title


@pytest.mark.parametrize(("choice", "left"), [("wait", True), ("quit", True), ("cancel", False)])
def test_closing_asks_about_a_film_that_is_not_written_yet(session, films, choice, left):
    actions.run(session, "file.record")
    actions.run(session, "run.play_human")
    play(session, 0.5)
    actions.run(session, "file.quit")
    assert len(films()) == 1 and not session.quitting
    session.answer(session.prompts[-1], choice)
    play(session, 0.1)
    assert session.quitting == (choice == "quit")
    session.worker.jobs = ()
    play(session, 0.1)
    assert session.quitting == left


def test_a_page_of_a_loop_shows_both_players_at_the_same_time(session, tmp_path, monkeypatch):
    def trace(first, last, skip):
        moments = tuple(moment(step, skip) for step in range(first, last + 1))
        return Trace(physics="fast", perturbed=False, snapshots=moments, actions=())

    shown = []
    monkeypatch.setattr(export, "_rival", lambda session, trace: rival)
    monkeypatch.setattr(export, "page_of", lambda films: shown.extend(films) or "")
    level, rival = session.document.level, trace(0, 100, 4)
    export.write_page(session, level, trace(20, 40, 2), tmp_path / "a.html")
    first, second = shown
    assert second.seconds[-1] == pytest.approx(first.seconds[-1])
    assert second.position[0, 0, 0] == 10 and second.position[-1, 0, 0] == 20
    shown.clear()
    rival = trace(0, 5, 4)  # over long before
    export.write_page(session, level, trace(20, 40, 2), tmp_path / "b.html")
    assert shown[1].position[:, 0, 0].tolist() == [5]


def test_a_page_of_a_comparison_goes_on_to_the_second_players_end(session, tmp_path, monkeypatch):
    first, rival = [moment(k, 2) for k in range(4)], [moment(k, 2) for k in range(9)]
    first[-1] = dataclasses.replace(first[-1], outcome="won")
    rival[-1] = dataclasses.replace(rival[-1], outcome="lost")
    one, two = (
        Trace(physics="fast", perturbed=False, snapshots=tuple(each), actions=())
        for each in (first, rival)
    )
    shown = []
    monkeypatch.setattr(export, "_rival", lambda session, trace: two)
    monkeypatch.setattr(export, "page_of", lambda films: shown.extend(films) or "")
    export.write_page(session, session.document.level, one, tmp_path / "a.html")
    assert [(film.outcome, len(film.seconds)) for film in shown] == [("won", 4), ("lost", 9)]


def moment(step, skip):
    nothing = np.zeros(4)
    return Snapshot(
        step=step,
        position=np.full((4, 2), step),
        angle=nothing,
        velocity=np.zeros((4, 2)),
        angular_velocity=nothing,
        motor=np.zeros(1),
        thruster=np.zeros(1),
        frame_skip=skip,
    )


def test_an_export_rests_what_is_played_so_that_nothing_is_missing(session, films):
    actions.run(session, "run.play_human")
    play(session, 0.5)
    actions.run(session, "file.export")
    seen = session.playback.step_count
    play(session, 0.5)
    session.answer(session.prompts[-1], "gif")
    play(session, 0.2)
    session.answer(session.prompts[-1], session.document.path.with_suffix(".gif"))
    (film,) = films()
    assert session.mode is Mode.PAUSED
    assert film.trace.snapshots[-1].step == seen == session.playback.step_count


def test_a_picture_of_a_paused_episode_that_is_changed_shows_the_changes(session, films, tmp_path):
    actions.run(session, "run.play_human")
    play(session, 0.5)
    actions.run(session, "run.pause")
    play(session, 0.1)
    played = session.playback.level
    actions.run(session, "run.change")
    session.execute(Remove(ids=(3,)))
    for choice in ("png1", "gif"):
        actions.run(session, "file.export")
        session.answer(session.prompts[-1], choice)
        session.answer(session.prompts[-1], tmp_path / f"shown.{choice[:3]}")
    picture, film = (job.request for job in session.worker.jobs)
    assert (picture.level, picture.state) == (session.document.level, None)
    assert film.level == played  # the episode so far, which can still be filmed


def test_an_export_can_be_stopped_and_says_so(session, films):
    assert not actions.run(session, "file.stop_export")
    actions.run(session, "run.play_human")
    play(session, 0.5)
    actions.run(session, "file.record")
    play(session, 0.3)
    actions.run(session, "file.record")
    (job,) = export.writing(session)
    actions.run(session, "file.stop_export")
    assert "mine-001.gif" in session.prompts[-1].message
    session.answer(session.prompts[-1], "stop")
    assert job.cancelled and not export.writing(session)
    job.state = JobState.CANCELLED
    export.told(session)(job)
    assert texts(session)[-1] == "mine-001.gif was not written."


@pytest.fixture
def unwritable(session, films, monkeypatch):
    """A session whose film cannot be written."""

    def refuse(path):
        raise LevelError(f"{path}: Permission denied")

    actions.run(session, "file.record")
    actions.run(session, "run.play_human")
    play(session, 0.3)
    monkeypatch.setattr(recording, "check_target", refuse)
    return session


@pytest.mark.parametrize("choice", ["drop", "go_on"])
def test_a_recording_that_cannot_be_written_goes_on_or_is_dropped(unwritable, films, choice):
    actions.run(unwritable, "file.record")
    assert unwritable.films.recording is not None and not films()
    assert "Permission denied" in unwritable.prompts[-1].message
    unwritable.answer(unwritable.prompts[-1], choice)
    assert (unwritable.films.recording is None) == (choice == "drop")


@pytest.mark.parametrize("choice", ["quit", "cancel"])
def test_the_app_can_be_closed_without_a_film_that_cannot_be_written(unwritable, films, choice):
    for _ in range(2):  # one question, however often the window is closed
        actions.run(unwritable, "file.quit")
    (question,) = unwritable.prompts
    assert "Permission denied" in question.message and not unwritable.quitting
    unwritable.answer(question, choice)
    assert not unwritable.prompts and not films()
    assert unwritable.quitting == (choice == "quit")
    assert (unwritable.films.recording is None) == (choice == "quit")


def test_a_recording_of_nothing_ends_also_where_nothing_can_be_written(unwritable):
    unwritable.films.recording.parts.clear()
    actions.run(unwritable, "run.stop")
    actions.run(unwritable, "file.record")
    assert unwritable.films.recording is None and not unwritable.prompts
    assert "Nothing was played" in texts(unwritable)[-1]


def test_a_film_leaves_out_what_had_ended_before(session, films):
    session.playback.simulator.ends_at, session.playback.simulator.ends = 5, "won"
    actions.run(session, "run.play_human")
    play(session, 1.0)
    assert session.mode is Mode.ENDED
    actions.run(session, "file.record")
    play(session, 0.1)
    actions.run(session, "run.reset")
    play(session, 1.0)
    actions.run(session, "file.record")
    assert [snapshot.step for snapshot in films()[0].trace.snapshots] == list(range(6))


def test_an_episode_is_shown_in_the_tab_of_its_level(session, tmp_path):
    session.playback.simulator.ends_at, session.playback.simulator.ends = 5, "won"
    actions.run(session, "run.play_human")
    play(session, 1.0)
    write_trace(session.playback.trace, session.playback.level, tmp_path / "mine.npz")
    actions.run(session, "run.stop")
    actions.run(session, "file.new")
    count = len(session.tabs)
    assert session.document.path is None
    assert export.open_trace(session, tmp_path / "mine.npz")
    assert len(session.tabs) == count and session.document.path == tmp_path / "mine.json"


@pytest.fixture
def failed(session, films):
    """A session whose film has met a full disk."""
    actions.run(session, "file.record")
    actions.run(session, "run.play_human")
    play(session, 0.3)
    actions.run(session, "file.record")
    session.worker.fail("mine-001.gif: cannot be saved: No space left on device")
    return session


def test_a_film_that_was_not_written_can_be_tried_again_and_saved_elsewhere(
    failed, films, tmp_path
):
    (film,) = failed.films.unwritten
    assert "No space left" in failed.prompts[-1].message and not films()
    failed.answer(failed.prompts[-1], "again")
    assert films() == [film] and not failed.films.unwritten
    failed.worker.fail("No space left on device")
    failed.answer(failed.prompts[-1], "elsewhere")
    failed.answer(failed.prompts[-1], None)  # no file was chosen: the film is still there
    failed.answer(failed.prompts[-1], "elsewhere")
    failed.answer(failed.prompts[-1], tmp_path / "other" / "mine.mp4")
    elsewhere = tmp_path / "other" / "mine.mp4"
    assert films() == [dataclasses.replace(film, path=elsewhere, numbered=False)]
    assert not failed.films.unwritten and not failed.prompts


def test_closing_asks_about_a_film_that_was_not_written(failed, films):
    actions.run(failed, "file.quit")
    assert "mine-001.gif" in failed.prompts[-1].message
    failed.answer(failed.prompts[-1], "wait")
    play(failed, 0.1)
    assert not failed.quitting
    failed.answer(failed.prompts[-1], "drop")
    assert not failed.films.unwritten and not films()
    play(failed, 0.1)
    assert failed.quitting
