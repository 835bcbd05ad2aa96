"""Places of the role glyphs on bodies, for every drawing of a level."""

import functools
from typing import Final

from editor.base.camera import Point
from kinetix.level.geometry import circle_about_middle
from kinetix.level.model import Body, Circle
from kinetix.render.style import FLOOR_GLYPH_DEPTH

_middle: Final = functools.lru_cache(maxsize=4096)(circle_about_middle)


def glyph_place(body: Body) -> tuple[Point, float]:
    """Return where a body's glyph stands in its frame, and the distance to the nearest edge [m].

    The floor, which has the id 0, has it under its surface, where it is in sight.
    """
    if body.id or isinstance(body.shape, Circle):
        return _middle(body.shape)
    surface = max(y for _, y in body.shape.vertices)
    return (0.0, surface - FLOOR_GLYPH_DEPTH), FLOOR_GLYPH_DEPTH
