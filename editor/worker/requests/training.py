"""Training runs and their curricula."""

import dataclasses

from kinetix.training.curricula.pages import BufferPage


@dataclasses.dataclass(frozen=True, kw_only=True)
class Place:
    """A place in a run's metrics up to which they are known."""

    rows: int
    """Rows before it."""
    offset: int
    """Bytes before it; the end of a line."""
    last_line: bytes
    """The line before it, by which a rewritten file is recognised."""
    update: float
    """The last update before it."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReadRun:
    """Look at a training run's folder. Gives a `RunNews`."""

    path: str
    after: Place | None = None
    """The place up to which its metrics are known already."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class RunNews:
    """News of a training run."""

    rows: tuple[dict[str, float], ...]
    """Metrics, one row an update: those that are new, or all where the file was read again."""
    total: int
    """Rows in all; as many as `rows`: they take the place of those that were known."""
    newest: int | None
    """Environment steps of the newest complete checkpoint."""
    place: Place | None = None
    """The place up to which the metrics were read; None: the next reading starts over."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReadCurriculum:
    """Look at the history of a run's level buffer. Gives a `CurriculumNews`."""

    path: str
    update: int | None = None
    """The page to read; None: the newest, where it is another than `known`."""
    known: int | None = None
    """The page that is there already."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class CurriculumNews:
    """News of a level buffer's history."""

    updates: tuple[int, ...]
    """Updates of which there are pages."""
    page: BufferPage | None
    """The page that was asked for; None if there is none, or nothing newer."""
