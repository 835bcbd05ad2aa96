"""A film of the window as an animated GIF."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image

from kinetix.files.atomic import replacing
from kinetix.render.film import gif_picture, write_gif

_WIDTH_MAX: Final = 960
_COLOURS: Final = 256
"""Colours of a picture: a window has more than a level."""
_FRAME_RATE: Final = 60
"""Frames per second of the offscreen clock."""


class Film:
    """Collects every n-th frame, half size when large, and writes them when it ends."""

    def __init__(self, path: Path, *, every: int) -> None:
        self._path = path
        self._every = max(every, 1)
        self._count = 0
        self._pictures: list[Image.Image] = []

    def frame(self, take: Callable[[], np.ndarray]) -> None:
        """Count a frame; takes its picture when it is one of those that are kept."""
        if self._count % self._every == 0:
            picture = Image.fromarray(take())
            if picture.width > _WIDTH_MAX:
                height = round(picture.height * _WIDTH_MAX / picture.width)
                picture = picture.resize((_WIDTH_MAX, height), Image.Resampling.LANCZOS)
            self._pictures.append(gif_picture(np.asarray(picture), _COLOURS))
        self._count += 1

    def save(self) -> None:
        """Write the GIF and make its folder; write nothing where nothing was filmed."""
        if not self._pictures:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(self._path) as temporary:
            write_gif(temporary, self._pictures, per_second=_FRAME_RATE / self._every)
