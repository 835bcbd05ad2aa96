"""Episodes: started, stepped, opened, played again."""

import dataclasses

from editor.worker.requests.agents import Casting, EvaluatedLevel
from editor.worker.snapshots import Snapshot, Trace
from kinetix.level.model import Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pull:
    """The mouse pulls at a body with a spring."""

    body: int
    """Id of the body."""
    anchor: tuple[float, float]
    """Grabbed point, in the body's frame [m]."""
    target: tuple[float, float]
    """Mouse position [m]."""
    teleport: bool = False
    """Put the body there instead of pulling (while paused)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class OpenEpisode:
    """Play one attempt of an evaluation again, the same to the bit. Gives an `Opened`."""

    level: EvaluatedLevel
    casting: Casting
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Opened:
    """An episode to look at."""

    level: Level
    trace: Trace


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlaySolution:
    """Play the recorded solution of a level. Gives an `Opened`."""

    level: Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class StartEpisode:
    """Compile a level, if its size is new, and go to its first state. Gives a `Snapshot`."""

    run: int
    """Number of the episode; answers to older numbers are dropped."""
    level: Level
    physics: str
    keep_contacts: bool = False
    """True if snapshots carry contact points (debug drawing)."""
    casting: Casting | None = None
    """The player; None: hands alone, through `Advance`."""
    slot: str = "a"
    """Episodes of different slots run beside each other."""
    quick: bool = False
    """True if a step that was compiled quickly will do where no better one is ready."""
    since: Snapshot | None = None
    """Snapshot at which the level of the episode was changed; None: it begins."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Advance:
    """Play environment steps, one for each action. Gives a tuple of `Snapshot`."""

    run: int
    actions: tuple[tuple[int, ...] | None, ...]
    """None leaves the choice to the agent that was cast."""
    pull: Pull | None = None
    keep_contacts: bool = False
    slot: str = "a"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Restore:
    """Go on from an earlier snapshot of the same episode. Gives nothing."""

    run: int
    snapshot: Snapshot
    slot: str = "a"
