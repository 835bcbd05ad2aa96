"""The view of the canvas: pan, zoom and the way between level metres and window pixels."""

import dataclasses
import math
from typing import Final, TypeAlias

from kinetix.level.geometry import ARENA_WIDTH

Point: TypeAlias = tuple[float, float]

PIXELS_PER_UNIT: Final = 100.0
"""Screen pixels a metre at 100 %, the scale of the published pictures."""
ZOOM_MIN: Final = 0.1
ZOOM_MAX: Final = 32.0
ZOOM_NOTCH: Final = 1.1
"""Factor of one notch of the wheel."""
ARENA: Final = ((0.0, 0.0), (ARENA_WIDTH, ARENA_WIDTH))
"""The playable square [m]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Camera:
    """A view of the level; every change makes a new one."""

    centre: Point = (2.5, 2.5)
    """The level point in the middle of the viewport [m]."""
    zoom: float = 1.0
    """1 shows 100 pixels a metre."""
    origin: Point = (0.0, 0.0)
    """Upper left corner of the viewport in the window [px]."""
    size: Point = (800.0, 800.0)
    """Width and height of the viewport [px]."""

    @property
    def scale(self) -> float:
        """Pixels a metre."""
        return PIXELS_PER_UNIT * self.zoom

    def to_screen(self, world: Point) -> Point:
        """Return the window pixels of a level point."""
        return (
            self.origin[0] + self.size[0] / 2 + (world[0] - self.centre[0]) * self.scale,
            self.origin[1] + self.size[1] / 2 - (world[1] - self.centre[1]) * self.scale,
        )

    def to_world(self, screen: Point) -> Point:
        """Return the level point under a window pixel."""
        return (
            self.centre[0] + (screen[0] - self.origin[0] - self.size[0] / 2) / self.scale,
            self.centre[1] - (screen[1] - self.origin[1] - self.size[1] / 2) / self.scale,
        )

    def length(self, pixels: float) -> float:
        """Return metres that so many pixels cover."""
        return pixels / self.scale

    def with_viewport(self, origin: Point, size: Point) -> "Camera":
        """Return the same look in a viewport that moved or was resized."""
        if origin == self.origin and size == self.size:
            return self
        return dataclasses.replace(self, origin=origin, size=(max(size[0], 1.0), max(size[1], 1.0)))

    def moved_viewport(self, origin: Point, size: Point) -> "Camera":
        """Return the view through another viewport: every point stays where it is in the window."""
        moved = self.with_viewport(origin, size)
        if moved is self:
            return self
        middle = (moved.origin[0] + moved.size[0] / 2, moved.origin[1] + moved.size[1] / 2)
        return dataclasses.replace(moved, centre=self.to_world(middle))

    def zoomed(self, factor: float, at: Point) -> "Camera":
        """Zoom by a factor; the level point under the window pixel `at` stays there."""
        before = self.to_world(at)
        closer = dataclasses.replace(self, zoom=min(max(self.zoom * factor, ZOOM_MIN), ZOOM_MAX))
        after = closer.to_world(at)
        centre = (closer.centre[0] + before[0] - after[0], closer.centre[1] + before[1] - after[1])
        return dataclasses.replace(closer, centre=centre)

    def panned(self, delta: Point) -> "Camera":
        """Move the picture by so many pixels (x right, y down)."""
        centre = (self.centre[0] - delta[0] / self.scale, self.centre[1] + delta[1] / self.scale)
        return dataclasses.replace(self, centre=centre)

    def fitted(self, low: Point, high: Point, *, margin: float = 24.0) -> "Camera":
        """Show a box of the level whole, with `margin` pixels around it."""
        width, height = max(high[0] - low[0], 1e-3), max(high[1] - low[1], 1e-3)
        free = (max(self.size[0] - 2 * margin, 1.0), max(self.size[1] - 2 * margin, 1.0))
        zoom = min(free[0] / width, free[1] / height) / PIXELS_PER_UNIT
        centre = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
        return dataclasses.replace(self, centre=centre, zoom=min(max(zoom, ZOOM_MIN), ZOOM_MAX))

    def on_pixels(self, width: float) -> "Camera":
        """Return nearly the same view with a square of that width [m] on whole pixels.

        Its edges and all that stands against them are then sharp.
        """
        scale = max(math.floor(width * self.scale), 1.0) / width
        sharp = dataclasses.replace(self, zoom=scale / PIXELS_PER_UNIT)
        x, y = sharp.to_screen((0.0, width))
        return sharp.panned((round(x) - x, round(y) - y))
