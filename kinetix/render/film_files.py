"""Films from a user's own pictures, checked while they come."""

import math
import numbers
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
from jaxtyping import UInt8

from kinetix.errors import KinetixError
from kinetix.files.atomic import check_target, replacing
from kinetix.render.film import FILM_SUFFIXES, ffmpeg, write_film

_AXES: Final = 3
"""Of a picture: height, width, colour."""


def save_film(path: str | Path, frames: Iterable[Any], per_second: float = 30.0) -> None:
    """Write pictures as a film, atomically.

    Args:
        path: A file whose name ends in `.gif`, or in `.mp4`, which needs the extra `video`.
        frames: Pictures of one size, (height, width, 3), 0 … 255 as `uint8`, the first row on top,
            as `env.render(state)` returns them; at least one.
        per_second: Pictures per second. A GIF shows at most 50 and leaves out others.

    Raises:
        KinetixError: The name ends otherwise, the extra is missing, the rate is no number above 0,
            or a frame is no such picture.
        LevelError: The file cannot be written.
    """
    if not isinstance(path, str | os.PathLike):
        raise KinetixError(
            f"path: expected the name of a file, got {type(path).__name__}; "
            "the order is save_film(path, frames)"
        )
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in FILM_SUFFIXES:
        raise KinetixError(f"{path}: expected a name that ends in .gif or .mp4")
    if not isinstance(per_second, numbers.Real) or not 0 < per_second < math.inf:
        raise KinetixError(f"per_second {per_second!r:.60}: expected a number above 0")
    if not isinstance(frames, Iterable):
        raise KinetixError(f"frames: expected pictures, got {type(frames).__name__}")
    if kind == ".mp4":
        ffmpeg()  # what is missing is reported before the work
    check_target(path)
    with replacing(path) as file:
        write_film(file, _pictures(frames), kind=kind, per_second=float(per_second))


def _pictures(frames: Iterable[Any]) -> Iterator[UInt8[np.ndarray, "h w 3"]]:
    size: tuple[int, ...] = ()
    for index, frame in enumerate(frames):
        picture = np.asarray(frame)
        size = size or picture.shape
        right = len(size) == _AXES and size[-1] == _AXES and 0 not in size
        if not right or picture.shape != size or picture.dtype != np.uint8:
            wanted = f"the shape {size} of the first one" if right else "(height, width, 3)"
            raise KinetixError(
                f"frames[{index}]: expected {wanted} in uint8, as env.render(state) returns it, "
                f"got {picture.shape} in {picture.dtype}"
            )
        yield picture
