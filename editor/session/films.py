"""Films that are not in their files yet."""

from dataclasses import dataclass, field

from editor.play.film_recording import Recording
from editor.worker.requests import ExportFilm


@dataclass
class Films:
    """The film that is being recorded, and films that could not be written."""

    recording: Recording | None = None
    """The film that is being recorded, or None."""
    unwritten: list[ExportFilm] = field(default_factory=list)
    """Films that could not be written, until they are saved elsewhere or dropped."""
