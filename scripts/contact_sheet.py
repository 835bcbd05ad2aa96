"""Draw the bundled levels, one thumbnail each, sheets of them and of random machines."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import jax
import numpy as np
from PIL import Image, ImageDraw

from kinetix.environment.generators.machines import random_machines
from kinetix.environment.params import static_env_params_of
from kinetix.environment.reset import level_state
from kinetix.level.codec import load_level
from kinetix.level.model import Level
from kinetix.level.sets import level_files
from kinetix.level.sizes import SIZES
from kinetix.paths import levels_dir
from kinetix.render.camera import fit_arena
from kinetix.render.scene import draw

PICTURES: Final = Path(__file__).resolve().parents[1] / "docs" / "pictures"
THUMBNAIL: Final = 180
"""Side of a thumbnail [px]."""
GAP: Final = 10
LINE: Final = 18
"""Height of a caption [px]."""
SMALL: Final = 96
"""Side of a thumbnail on the sheet of all levels, which has no captions [px]."""


class Thumbnails:
    """Draws levels; all in the largest size, so that one compilation serves them."""

    def __init__(self) -> None:
        """Prepare the drawing."""
        self._static = static_env_params_of(SIZES["l"])
        self._draw = jax.jit(draw, static_argnames=("width", "height"))

    def picture(self, level: Level, side: int = THUMBNAIL) -> Image.Image:
        """Return the level's start, drawn at twice the size and scaled down."""
        state = level_state(level.replace(size="l"), self._static)
        labels = state.labels
        pixels = self._draw(
            state.world,
            state.physics,
            labels.role,
            labels.motor_binding,
            labels.thruster_binding,
            fit_arena(2 * side, 2 * side),
            width=2 * side,
            height=2 * side,
        )
        return Image.fromarray(np.asarray(pixels)).resize((side, side), Image.Resampling.LANCZOS)


def sheet(pictures: Sequence[Image.Image], captions: Sequence[str], columns: int) -> Image.Image:
    """Pictures of one size in rows, each with a line of text below."""
    side, line = pictures[0].width, LINE if any(captions) else 0
    rows = -(-len(pictures) // columns)
    width = columns * (side + GAP) + GAP
    made = Image.new("RGB", (width, rows * (side + line + GAP) + GAP), "white")
    pen = ImageDraw.Draw(made)
    for index, (picture, caption) in enumerate(zip(pictures, captions, strict=True)):
        x = GAP + (index % columns) * (side + GAP)
        y = GAP + (index // columns) * (side + line + GAP)
        made.paste(picture, (x, y))
        pen.rectangle((x - 1, y - 1, x + side, y + side), outline=(190, 190, 190))
        pen.text(
            (x + side / 2, y + side + 3), caption, fill=(50, 50, 50), font_size=13, anchor="ma"
        )
    return made


def save(picture: Image.Image, path: Path) -> None:
    """Write a picture with few colours, which these have."""
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.quantize(128).save(path, optimize=True)
    sys.stdout.write(f"{path}\n")


def main() -> None:
    """Draw everything again."""
    thumbnails = Thumbnails()
    every: list[Image.Image] = []
    for size in ("s", "m", "l"):
        paths = list(level_files(levels_dir() / size))
        levels = [load_level(path) for path in paths]
        pictures = [thumbnails.picture(level) for level in levels]
        for path, picture in zip(paths, pictures, strict=True):
            save(picture, PICTURES / "levels" / size / f"{path.stem}.png")
        save(sheet(pictures, [level.name for level in levels], 6), PICTURES / f"levels_{size}.png")
        every += [each.resize((SMALL, SMALL), Image.Resampling.LANCZOS) for each in pictures]
    save(sheet(every, [""] * len(every), 12), PICTURES / "levels.png")
    machines = [thumbnails.picture(level, SMALL + 14) for level in random_machines(2, "l", 24)]
    save(sheet(machines, [""] * len(machines), 8), PICTURES / "machines.png")


if __name__ == "__main__":
    main()
