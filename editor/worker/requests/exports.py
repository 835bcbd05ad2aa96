"""Pictures, films, data sets."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from editor.worker.snapshots import Trace
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.level.model import Level


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
    physics: str = DEFAULT_PHYSICS
    palette: str = "kinetix"
    glyphs: bool = True
    patterns: bool = False


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
    overlay: bool = False
    """Write step, controls, value and outcome on the pictures."""
    rival: Trace | None = None
    """The second player of a comparison, filmed beside the first one."""
    numbered: bool = False
    """True if the path ends in a number, which rises where another window has that file by then."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AddEpisode:
    """Add an episode to a data set. Gives a sentence: what the data set holds then."""

    level: Level
    trace: Trace
    folder: Path
    """The data set; made where there is none."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Image:
    """A picture, rows from the top."""

    pixels: UInt8[np.ndarray, "h w 3"]
    centre: tuple[float, float]
    """Level point in the middle [m]."""
    scale: float
    """Pixels a metre."""
