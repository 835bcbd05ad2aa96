"""What the app asks of the background worker: plain frozen values, and what comes back."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Protocol, TypeAlias

import numpy as np
from jaxtyping import UInt8

from editor.recording import Snapshot, Trace
from kinetix.level.model import Level

MUTATIONS: Final = (
    ("add_shape", "Add a shape"),
    ("add_connected_shape", "Add a jointed shape"),
    ("add_thruster", "Add a thruster"),
    ("remove_shape", "Remove a shape"),
    ("remove_joint", "Remove a joint"),
    ("remove_thruster", "Remove a thruster"),
    ("swap_role", "Swap two roles"),
    ("toggle_fixture", "Fix or free a shape"),
    ("change_gravity", "Change gravity"),
    ("change_size", "Change a size"),
    ("change_location", "Move a shape"),
    ("change_rotation", "Turn a shape"),
)
"""Names and labels of the mutations that the simulation offers."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pull:
    """The mouse pulls at a body with a spring."""

    body: int
    """Id of the body."""
    anchor: tuple[float, float]
    """Where it was grabbed, in the body's frame [m]."""
    target: tuple[float, float]
    """Where the mouse is [m]."""
    teleport: bool = False
    """Put the body there instead of pulling (while paused)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class WarmUp:
    """Import JAX and compile the step for the named sizes, so that Play starts at once."""

    sizes: tuple[str, ...] = ("s", "m", "l")
    physics: str = "balanced"


@dataclasses.dataclass(frozen=True, kw_only=True)
class StartEpisode:
    """Compile a level, if its size is new, and go to its first state. Gives a `Snapshot`."""

    run: int
    """Number of the episode; answers to older numbers are dropped."""
    level: Level
    physics: str
    keep_contacts: bool = False
    """Whether snapshots carry contact points (debug drawing)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Advance:
    """Play environment steps, one for each action. Gives a tuple of `Snapshot`."""

    run: int
    actions: tuple[tuple[int, ...], ...]
    pull: Pull | None = None
    keep_contacts: bool = False


@dataclasses.dataclass(frozen=True, kw_only=True)
class Restore:
    """Go on from an earlier snapshot of the same episode. Gives nothing."""

    run: int
    snapshot: Snapshot


@dataclasses.dataclass(frozen=True, kw_only=True)
class RenderState:
    """Draw a state as agents and films see it. Gives an `Image`.

    The picture covers `size` pixels around `centre` at `scale` pixels a metre. `state` is a
    snapshot's `state`, or None for the first state of `level`.
    """

    level: Level
    state: Any
    size: tuple[int, int]
    centre: tuple[float, float]
    scale: float
    physics: str = "balanced"
    palette: str = "kinetix"
    glyphs: bool = True
    patterns: bool = False


@dataclasses.dataclass(frozen=True, kw_only=True)
class RandomLevel:
    """Draw a random level. Gives a `Level`."""

    seed: int
    size: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mutate:
    """Change a level at random; None takes a random mutation. Gives a `Level`."""

    level: Level
    mutation: str | None
    seed: int


@dataclasses.dataclass(frozen=True, kw_only=True)
class CheckDynamics:
    """What the no-op and random play do with a level (I301, I302). Gives a `DynamicsReport`."""

    level: Level
    physics: str = "balanced"
    attempts: int = 64


@dataclasses.dataclass(frozen=True, kw_only=True)
class ExportPicture:
    """Write a PNG of the arena. Gives the path."""

    level: Level
    state: Any
    """A snapshot's `state`, or None for the first state."""
    path: Path
    factor: int = 1
    """1 … 8 times 500 pixels."""
    transparent: bool = False
    palette: str = "kinetix"


@dataclasses.dataclass(frozen=True, kw_only=True)
class ExportFilm:
    """Write a GIF or MP4 (by the path's suffix) of a played episode. Gives the path."""

    level: Level
    trace: Trace
    path: Path
    pixels: int = 500
    stride: int = 1
    """Every how many environment steps a picture is taken."""
    palette: str = "kinetix"


Request: TypeAlias = (
    WarmUp
    | StartEpisode
    | Advance
    | Restore
    | RenderState
    | RandomLevel
    | Mutate
    | CheckDynamics
    | ExportPicture
    | ExportFilm
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Image:
    """A picture, rows from the top."""

    pixels: UInt8[np.ndarray, "h w 3"]
    centre: tuple[float, float]
    """Level point in the middle [m]."""
    scale: float
    """Pixels a metre."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class DynamicsReport:
    """How a level plays without a plan."""

    noop_outcome: str
    """`won`, `lost` or `timeout`."""
    noop_steps: int
    random_solved: float
    """Share of the attempts."""
    attempts: int


class Cancelled(Exception):
    """The job was cancelled."""


class Progress(Protocol):
    """How a running job tells what it does and learns that nobody waits for it any more."""

    def report(self, fraction: float | None, message: str) -> None:
        """Say how far it is (0 … 1, or None when unknown) and what it does.

        Raises:
            Cancelled: The user cancelled the job.
        """
        ...


Perform: TypeAlias = Callable[[Request, Progress], Any]
"""Does a request on the worker's thread."""
