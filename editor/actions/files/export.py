"""Exports: pictures, films and traces of what is on show."""

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from editor.actions.files import file, films, folders
from editor.base.prompts import Choice, FileQuestion, MenuQuestion, Question
from editor.documents.commands.bodies import posed
from editor.documents.document import Document
from editor.documents.files import lost_on_save
from editor.play.mode import Mode
from editor.play.trace_files import SUFFIX, read_trace, write_trace
from editor.session import Session
from editor.worker.jobs import Job, JobState
from editor.worker.requests import ExportFilm, ExportPicture
from editor.worker.snapshots import Trace, channels_of
from editor.worker.trace_pages import SUFFIX as PAGE
from editor.worker.trace_pages import film_of_trace
from kinetix.errors import CommandError, KinetixError
from kinetix.files.atomic import check_target, write_atomically, write_with_backup
from kinetix.level.codec import dumps
from kinetix.level.model import Level
from kinetix.pages.page import page_of
from kinetix.paths import user_levels_dir

PICTURES: Final = tuple(
    Choice(id=f"png{n}", label=f"Picture, {500 * n} × {500 * n}", detail="PNG")
    for n in (1, 2, 4, 8)
)
FOR_KINETIX_ENV: Final = Choice(id="json", label="Level for kinetix-env", detail="JSON")
CLEAR_PICTURE: Final = Choice(id="clear2", label="Picture without background", detail="PNG")
EPISODES: Final = (
    Choice(id="gif", label="Film of this episode", detail="GIF"),
    Choice(id="mp4", label="Film of this episode", detail="MP4"),
    Choice(id="html", label="Page of this episode", detail="HTML, plays in any browser"),
    Choice(id="npz", label="Trace of this episode", detail="NumPy .npz"),
)


def ask_export(session: Session) -> None:
    """Choose what to export, then where to."""
    _rest(session)
    trace = session.playback.trace
    episodes = EPISODES if trace is not None else ()

    def answer(choice: str | None) -> None:
        if choice is not None:
            _ask_path(session, choice, trace)

    choices = (*PICTURES, CLEAR_PICTURE, *episodes, FOR_KINETIX_ENV)
    session.ask(MenuQuestion(title="Export", choices=choices, at=None, answer=answer))


def _ask_path(session: Session, choice: str, trace: Trace | None) -> None:
    suffix = f".{choice}" if choice in ("gif", "mp4", "html", "npz", "json") else ".png"
    document, shown = session.document, _on_show(session)
    # An episode that is set aside while its level is changed can still be filmed.
    played = session.playback.level or document.level

    def write(path: Path) -> None:
        if suffix == ".png":
            request = ExportPicture(
                level=shown[0],
                state=shown[1],
                path=path,
                factor=int(choice[-1]),
                transparent=choice.startswith("clear"),
                palette=session.settings.palette,
            )
            session.worker.submit(request, title=f"Writing {path.name}", done=told(session))
        elif suffix == ".json":
            write_for_kinetix_env(session, document, path)
        elif trace is not None and suffix == ".npz":
            write_trace(trace, played, path)
            session.toast(f"Wrote {path}", "success")
        elif trace is not None and suffix == PAGE:
            write_page(session, played, trace, path)
        elif trace is not None:
            film(session, played, trace, path)

    session.ask(
        FileQuestion(
            purpose="save",
            title="Export as",
            folder=folders.to_export(session),
            name=f"{Path(document.title).stem}{suffix}",
            suffixes=(suffix,),
            answer=_remembered(session, write),
        )
    )


def _remembered(session: Session, write: Callable[[Path], None]) -> Callable[[Path | None], None]:
    """Return an answer that writes a file and keeps its folder for the next export."""

    def answer(path: Path | None) -> None:
        if path is not None:
            session.settings.export_folder = str(path.parent.absolute())
            write(path)

    return answer


def _on_show(session: Session) -> tuple[Level, Any]:
    """Return the level for a picture and the simulator's state of it; None: as the level says."""
    playback = session.playback
    level, snapshot = playback.level, playback.snapshot
    if not playback.active or level is None:
        return session.document.level, None
    if snapshot is None:
        return level, None
    return (posed(level, snapshot), None) if snapshot.state is None else (level, snapshot.state)


def write_for_kinetix_env(session: Session, document: Document, path: Path) -> None:
    """Write the level in kinetix-env's format, and say what that cannot hold.

    Args:
        session: The app.
        document: The level as it stands in the editor; it stays with its own file.
        path: The file; not one of a level that is open.

    Raises:
        CommandError: The file is open in another window.
        LevelError: The file cannot be written, or the format cannot hold the level.
    """
    if any(_same(tab.document.path, path) for tab in session.tabs):
        raise CommandError(f"{path.name} is open here: choose another name for the export.")
    data = dumps(document.level, format="kinetix-env", source=document.source)
    write_with_backup(path, data.encode())
    lost = lost_on_save(document.level, path, "kinetix-env")
    if lost and document.source is None:
        session.toast(f"Wrote {path}; kinetix-env has no place for: {', '.join(lost)}", "warning")
    else:
        session.toast(f"Wrote {path}", "success")


def _same(one: Path | None, other: Path) -> bool:
    return one is not None and one.resolve() == other.resolve()


def open_trace(session: Session, path: Path) -> bool:
    """Show an episode from a file on its level; whether it is shown, else a window shows why."""
    try:
        found = read_trace(path)
    except KinetixError as error:
        file.tell(session, "This cannot be opened", str(error))
        return False
    with session.guard():
        session.leave_play()
        session.gallery.open = False
        file.bring(session, found.level)
        session.playback.replay(found.trace, found.level)
        session.view.front = "timeline"
        return True
    return False


def ask_trace(session: Session) -> None:
    """Choose an episode's file and show it."""

    def answer(path: Path | None) -> None:
        if path is not None:
            open_trace(session, path)

    session.ask(
        FileQuestion(
            purpose="open",
            title="Open an episode",
            folder=folders.to_export(session),
            suffixes=(SUFFIX,),
            answer=answer,
        )
    )


def film(
    session: Session, level: Level, trace: Trace, path: Path, *, numbered: bool = False
) -> None:
    """Ask the worker for a film of a trace; where it is numbered, the number may rise.

    Raises:
        LevelError: Nothing can be written there.
    """
    check_target(path)
    request = ExportFilm(
        level=level,
        trace=trace,
        path=path,
        palette=session.settings.palette,
        overlay=bool(trace.player) and "numbers" in session.settings.agent_overlay,
        rival=_rival(session, trace),
        numbered=numbered,
    )
    films.write(session, request, told(session))


_DRAWS: Final = ("seed", "attempt", "deterministic", "digest")
"""The fields of a trace that name its agent and the draws."""


def _rival(session: Session, trace: Trace) -> Trace | None:
    """Return the second player's episode, where one is shown with the trace that is on show."""
    rival, shown = session.viewer.rival, session.playback.trace
    last = trace.snapshots[-1]
    if not rival.snapshots or shown is None or not any(s is last for s in shown.snapshots):
        return None
    snapshots = tuple(rival.snapshots)
    casting = rival.casting
    draws: dict[str, Any] = {}
    if casting is not None:
        draws = {name: getattr(casting, name) for name in _DRAWS}
    return Trace(
        physics=session.viewer.other_physics or shown.physics,
        perturbed=False,
        snapshots=snapshots,
        actions=tuple(channels_of(snapshot.action) for snapshot in snapshots[1:]),
        player=shown.player if session.viewer.other_physics else rival.player,
        **draws,
    )


def has_clip(session: Session) -> bool:
    """Return whether there is an episode to film."""
    return session.playback.active and len(session.playback.moments) > 1


def ask_clip(session: Session) -> None:
    """Film the looped part of the episode, or all of it; asks where to."""
    _ask_part(
        session,
        film,
        title="Export the clip as .gif or .mp4",
        refusal="Play first: there is nothing to film.",
        suffixes=films.SUFFIXES,
    )


def ask_page(session: Session) -> None:
    """Ask where the episode shall go as a page that any browser plays."""
    _ask_part(
        session,
        write_page,
        title="Share the episode as a page",
        refusal="Play first: there is nothing to share.",
        suffixes=(PAGE,),
    )


def _ask_part(
    session: Session,
    write: Callable[[Session, Level, Trace, Path], object],
    *,
    title: str,
    refusal: str,
    suffixes: tuple[str, ...],
) -> None:
    """Ask where the looped part of the episode shall go, or all of it.

    Raises:
        CommandError: The refusal, where nothing was played.
    """
    _rest(session)
    playback = session.playback
    trace, level = playback.trace, playback.level
    if trace is None or level is None:
        raise CommandError(refusal)
    clip = trace if playback.loop is None else trace.part(*playback.loop)

    def answer(path: Path) -> None:
        write(session, level, clip, path)

    session.ask(
        FileQuestion(
            purpose="save",
            title=title,
            folder=folders.to_export(session),
            name=f"{Path(session.document.title).stem}{suffixes[0]}",
            suffixes=suffixes,
            answer=_remembered(session, answer),
        )
    )


def write_page(session: Session, level: Level, trace: Trace, path: Path) -> None:
    """Write an episode as a page, with the second player beside it where there is one."""
    rival = _rival(session, trace)
    shown = (trace,) if rival is None else (trace, _during(trace, rival))
    films = [film_of_trace(one, level) for one in shown]
    write_atomically(path, page_of(films).encode())
    session.toast(f"Wrote {path}", "success")


def _during(trace: Trace, rival: Trace) -> Trace:
    """The second player's moments while the first one's were played; at least its last one.

    Where the first one has ended by then, those to the second one's end too.
    """
    first, last = (trace.snapshots[k].step * trace.snapshots[k].frame_skip for k in (0, -1))
    steps = [snapshot.step * snapshot.frame_skip for snapshot in rival.snapshots]
    if trace.snapshots[-1].outcome is not None:
        last = max(last, steps[-1])
    inside = [k for k, step in enumerate(steps) if first <= step <= last] or [len(steps) - 1]
    return rival.part(inside[0], inside[-1])


def told(session: Session) -> Callable[[Job], None]:
    """Return a callback that says what became of an export."""

    def done(job: Job) -> None:
        if job.state is JobState.DONE:
            session.toast(f"Wrote {job.result}", "success")
        elif job.state is JobState.FAILED:
            session.toast(job.error, "error")
        elif job.state is JobState.CANCELLED and (path := file_of(job)) is not None:
            session.toast(f"{path.name} was not written.")

    return done


def file_of(job: Job) -> Path | None:
    """Return the picture or film that a job writes; None where it writes neither."""
    return job.request.path if isinstance(job.request, ExportFilm | ExportPicture) else None


def writing(session: Session) -> dict[Job, Path]:
    """Return the pictures and films that are being written or wait for it, in this order."""
    files = {job: file_of(job) for job in session.worker.jobs if not job.cancelled}
    return {job: path for job, path in files.items() if path is not None}


def stop(session: Session) -> None:
    """Leave out what is being written, after asking."""
    jobs = writing(session)

    def answer(choice: str) -> None:
        if choice == "stop":
            for job in jobs:
                job.cancel()

    names = "\n".join(path.name for path in jobs.values())
    session.ask(
        Question(
            title="Stop the export?",
            message=f"These are not complete yet:\n{names}",
            choices=(Choice(id="stop", label="Stop"), Choice(id="go_on", label="Go On")),
            default="go_on",
            cancel="go_on",
            answer=answer,
        )
    )


def _rest(session: Session) -> None:
    """Pause what is played, so that all of it is exported that was seen."""
    if session.mode is Mode.PLAYING:
        session.playback.pause()


def screenshot(session: Session) -> None:
    """Ask the host for a picture of the window."""
    session.screenshot = free_name(session, ".png")


def free_name(session: Session, suffix: str) -> Path:
    """Return a file name in the folder of exports that nothing has yet: `title-001.png`."""
    folder, stem, number = folders.to_export(session), Path(session.document.title).stem, 1
    if folder == user_levels_dir():
        with contextlib.suppress(OSError):  # the write says so
            folder.mkdir(parents=True, exist_ok=True)
    awaited = {*writing(session).values(), *(film.path for film in session.films.unwritten)}
    while os.path.exists(path := folder / f"{stem}-{number:03}{suffix}") or path in awaited:
        number += 1
    return path
