"""The work under way as the status line shows it, with what a click on it does."""

from typing import TYPE_CHECKING, Final, NamedTuple

from editor.actions.files.export import file_of, writing
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons, Rgba
from editor.worker.jobs import PREPARATIONS, Job, lane_of

if TYPE_CHECKING:
    from editor.session import Session

_CONSTANT: Final = ("Simulating", "Drawing")
"""Jobs that run all the time while something is played."""
_STOPS: Final = "Click to stop it."
SHOWS: Final = "Click to see it."


class Part(NamedTuple):
    """One of the words at the right of the line."""

    words: str
    """In the window's language."""
    colour: Rgba
    action: str = ""
    """Id of the action that a click runs; empty: none."""
    click: str = ""
    """Words of its tooltip: what a click does."""


def under_way(session: "Session") -> list[Part]:
    """Return what is being done, what the user asked for first."""
    parts = []
    if session.films.recording is not None:
        words = f"{Icons.film} {tr('Recording')}"
        parts.append(Part(words, COLOURS.bad, "file.record", "Click to end the film."))
    for job in list(writing(session))[:1]:
        parts.append(Part(_told(job.title, job), COLOURS.accent, "file.stop_export", _STOPS))
    files = session.gallery.work
    if files is not None:
        words = f"{Icons.gear} {tr(files.title)} {files.done / files.total:.0%}"
        parts.append(Part(words, COLOURS.accent, "gallery.stop", _STOPS))
    evaluation, training = session.viewer.evaluation, session.training
    if evaluation.running:
        words = _told("Evaluating", evaluation.job)
        parts.append(Part(words, COLOURS.accent, "level.evaluate", SHOWS))
    if training.running and training.run is not None:
        words = _told(f"Training {widgets.shortened(training.told)}")
        parts.append(Part(words, COLOURS.accent, "view.training", SHOWS))
    job = next((job for job in session.worker.jobs if _is_other(job)), None)
    if job is not None:
        ahead = lane_of(job.request) == PREPARATIONS
        words = job.title if ahead else job.message or job.title
        parts.append(Part(_told(words, job), COLOURS.accent))
    return parts


def _is_other(job: Job) -> bool:
    """Return whether a job has no line of its own, and is worth one."""
    return job.title not in _CONSTANT and file_of(job) is None


def _told(words: str, job: Job | None = None) -> str:
    share = f" {job.fraction:.0%}" if job is not None and job.fraction is not None else ""
    # With the share behind them they would be other words.
    return f"{Icons.gear} {tr(words)}{share}"
