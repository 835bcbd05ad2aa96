"""Recorded play as data: the episode on show goes into a data set."""

import os
from pathlib import Path

from editor.base.prompts import FileQuestion
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import AddEpisode
from editor.worker.snapshots import Trace
from kinetix.datasets.folder import MANIFEST, read_manifest
from kinetix.errors import CommandError, KinetixError
from kinetix.level.model import Level
from kinetix.paths import working_dir
from kinetix.wording import plural


def can_add(session: Session) -> bool:
    """Return whether an episode that came to its end is on show."""
    moments = session.playback.moments
    return session.playback.active and bool(moments) and moments[-1].outcome is not None


def ask_dataset(session: Session) -> None:
    """Ask which data set the episode shall go to."""
    playback = session.playback
    trace, level = playback.trace, playback.level
    if trace is None or level is None or not can_add(session):
        raise CommandError("Play an episode to its end first.")

    def answer(path: Path | None) -> None:
        if path is not None:
            add_episode(session, level, trace, path)

    last = Path(session.settings.dataset) if session.settings.dataset else working_dir()
    session.ask(
        FileQuestion(
            purpose="folder",
            title="Add the episode to a data set",
            folder=last if os.path.isdir(last) else working_dir(),
            suffixes=(),
            describe=about_dataset,
            wanted="a data set of episodes or an empty folder",
            fresh=True,
            answer=answer,
        )
    )


def add_episode(session: Session, level: Level, trace: Trace, folder: Path) -> None:
    """Add an episode to a data set; a toast shows its new content, or the reason."""

    def done(job: Job) -> None:
        if job.state is JobState.DONE:
            session.settings.dataset = str(folder.resolve())
            session.toast(job.result, "success")
        elif job.state is JobState.FAILED:
            session.toast(job.error, "error")

    request = AddEpisode(level=level, trace=trace, folder=folder)
    session.worker.submit(request, title="Adding the episode", done=done)


def about_dataset(folder: Path) -> str:
    """Return what a folder is as a place for episodes; empty where they cannot go there."""
    try:
        if os.path.isfile(folder / MANIFEST):
            manifest = read_manifest(folder)
            many = plural(manifest.episodes, "episode")
            return f"A data set of {many}, {plural(manifest.steps, 'step')}."
        empty = not any(not entry.name.startswith(".") for entry in folder.iterdir())
    except (KinetixError, OSError):
        return ""
    return "An empty folder: a data set begins here." if empty else ""
