"""The last episode that ended, so that no end is counted twice."""

from dataclasses import dataclass

from editor.play.win import Win
from editor.worker.snapshots import Snapshot


@dataclass
class LastEnd:
    """Its episode, its last moment, and a win to be kept."""

    episode: int = -1
    """The last episode whose end was kept in the results."""
    snapshot: Snapshot | None = None
    """Its last moment: an episode has another end after it went on from an earlier moment."""
    win: Win | None = None
    """The last win by hand, until it is kept as a solution."""
