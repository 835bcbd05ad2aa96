"""Training runs and their curricula."""

import dataclasses

from kinetix.training.curricula.pages import BufferPage


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReadRun:
    """Look at a training run's folder. Gives a `RunNews`."""

    path: str
    after: int = 0
    """Rows of metrics that are known already."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class RunNews:
    """News of a training run."""

    rows: tuple[dict[str, float], ...]
    """Metrics, one row an update."""
    total: int
    """Rows in all; fewer than were known before: the run was set back."""
    newest: int | None
    """Environment steps of the newest complete checkpoint."""


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
    """The one that was asked for; None where there is none, or nothing newer."""
