"""Progress of a request."""

from typing import Any, Protocol


class Cancelled(Exception):
    """The job was cancelled."""


class Progress(Protocol):
    """Channel in which a running job reports, and learns that it was cancelled."""

    def report(self, fraction: float | None, message: str) -> None:
        """Report the progress (0 … 1, or None if unknown) and the present task.

        Raises:
            Cancelled: The user cancelled the job.
        """
        ...

    def share(self, partial: Any) -> None:
        """Hand on what is known so far; the window may read it at any time."""
        ...
