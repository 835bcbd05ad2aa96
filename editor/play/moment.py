"""A paused episode's level, to be changed: played on, kept as the level's start, or dropped."""

import dataclasses

from editor.documents.commands.level import TakePoses
from editor.documents.document import Document
from editor.worker.requests import Casting
from editor.worker.snapshots import Snapshot
from kinetix.level.model import Level


@dataclasses.dataclass(kw_only=True)
class Moment:
    """The level where an episode stands; its document is edited like any other."""

    document: Document
    snapshot: Snapshot
    """Snapshot of the moment; the episode continues from its step and return."""
    casting: Casting | None = None
    """The agent that plays on; None: a person."""
    player: str = ""

    @property
    def changed(self) -> bool:
        """True if anything is different from what was simulated."""
        return self.document.dirty

    @property
    def begin(self) -> str:
        """Return when it is: `step 57`."""
        return f"step {self.snapshot.step}"


def moment_of(
    level: Level, snapshot: Snapshot, casting: Casting | None = None, *, player: str = ""
) -> Moment:
    """Return the moment of an episode.

    Args:
        level: The level that is played.
        snapshot: Where it stands.
        casting: The agent that plays, if one does.
        player: What the agent is called.
    """
    taken = TakePoses(poses=snapshot).apply(level.replace(solution=None))
    document = Document(taken)
    document.passing = True
    return Moment(document=document, snapshot=snapshot, casting=casting, player=player)
