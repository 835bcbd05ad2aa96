"""States of the app that a script can wait for."""

from collections.abc import Callable
from typing import Final

from editor.play.mode import Mode
from editor.session import Session
from editor.worker.requests import WarmUp


def _playing(session: Session) -> bool:
    playback = session.playback
    return session.mode is Mode.PLAYING and playback.step_count > 0 and not playback.waiting


def _compiled(session: Session) -> bool:
    """Nothing waits for the compiler any more."""
    return not session.playback.waiting and not any(
        isinstance(job.request, WarmUp) for job in session.worker.jobs
    )


PLAYED: Final = frozenset({"playing", "ended"})
"""States that only come while the app is out of Edit."""
CONDITIONS: Final[dict[str, Callable[[Session], bool]]] = {
    "playing": _playing,
    "compiled": _compiled,
    "ended": lambda session: session.mode is Mode.ENDED,
    "idle": lambda session: (
        session.worker.idle
        and session.evaluator.idle
        and not session.library.busy
        and session.gallery.work is None
    ),
}
"""Names of the states, and tests for them."""
