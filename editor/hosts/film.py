"""A film of the window as an animated GIF."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image

from kinetix.level.atomic import replacing

_WIDTH_MAX: Final = 960


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
            self._pictures.append(
                picture.quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
            )
        self._count += 1

    def save(self) -> None:
        """Write the GIF; its folder is made if need be. Nothing filmed, nothing written."""
        if not self._pictures:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        first, *rest = self._pictures
        with replacing(self._path) as temporary:
            first.save(
                temporary,
                format="GIF",
                save_all=True,
                append_images=rest,
                duration=round(1000 * self._every / 60),
                loop=0,
                optimize=True,
            )
