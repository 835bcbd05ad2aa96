"""A small map in the canvas's corner: where the view is, and a way to move it.

It shows the arena, and in Edit what lies outside too, as far as a few metres.
"""

import dataclasses
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import ARENA, Camera, Point
from editor.base.memoise import remembers
from editor.drawing.vectors import Painter, Placement, paint_level
from editor.toolkit.appearance import COLOURS, alpha, u32
from editor.toolkit.widgets import px
from kinetix.level.geometry import bounds_of
from kinetix.level.model import Level

if TYPE_CHECKING:
    from editor.session import Session


_SIDE: Final = 132.0
_GAP: Final = 14.0
_OUTSIDE: Final = 4.0
"""So far outside of the arena it reaches at most: further off, shapes would be dots [m]."""


class Minimap:
    """Lower right; a press or drag on it brings that place to the middle."""

    def __init__(self) -> None:
        self._low: Point = (0.0, 0.0)
        self._side = 0.0
        self._camera = Camera()
        """The view of the map itself."""
        self._dragging = False

    def takes(self, session: "Session", mouse: Point, *, hovered: bool) -> bool:
        """Move the view while the mouse is pressed on the map.

        Args:
            session: Whose camera moves.
            mouse: Where the pointer is [px].
            hovered: Whether the pointer is over the canvas.

        Returns:
            Whether the mouse is the map's.
        """
        if not session.settings.minimap or self._side <= 0:
            return False
        x, y = mouse[0] - self._low[0], mouse[1] - self._low[1]
        inside = hovered and 0 <= x <= self._side and 0 <= y <= self._side
        if inside and imgui.is_mouse_clicked(0):
            self._dragging = True
        if self._dragging and imgui.is_mouse_down(0):
            session.camera = dataclasses.replace(
                session.camera, centre=self._camera.to_world(mouse)
            )
        else:
            self._dragging = False
        return inside or self._dragging

    def paint(
        self, session: "Session", draw: imgui.ImDrawList, where: Placement, corner: Point
    ) -> None:
        """Draw the map.

        Args:
            session: Whose camera it shows.
            draw: Where to draw.
            where: The level and its poses.
            corner: Lower right corner of the canvas [px].
        """
        if not session.settings.minimap:
            self._side = 0.0
            return
        side = self._side = px(_SIDE)
        low = self._low = (corner[0] - side - px(_GAP), corner[1] - side - px(_GAP))
        high = (low[0] + side, low[1] + side)
        draw.push_clip_rect(low, high, True)
        box = _all(where.level) if session.editing else ARENA
        self._camera = Camera(origin=low, size=(side, side)).fitted(*box, margin=0.0)
        draw.add_rect_filled(low, high, u32(COLOURS.backdrop))
        painter = Painter(draw=draw, camera=self._camera)
        painter.paper(grid=None)
        paint_level(painter, where)
        camera, shown = session.camera, painter.camera
        x, y = camera.origin
        width, height = camera.size
        view = (
            shown.to_screen(camera.to_world((x, y))),
            shown.to_screen(camera.to_world((x + width, y + height))),
        )
        draw.add_rect_filled(*view, u32(alpha(COLOURS.accent, 0.10)))
        draw.add_rect(*view, u32(COLOURS.accent), 0.0, px(1.5))
        draw.pop_clip_rect()
        draw.add_rect(low, high, u32(COLOURS.line), px(3), px(1.5))


@remembers(1)
def _all(level: Level) -> tuple[Point, Point]:
    """Return lower left and upper right corner of a box around the arena and all shapes [m]."""
    if not level.bodies:
        return ARENA
    (left, bottom), (right, top) = ARENA
    box = bounds_of(level.bodies)
    return (
        (max(min(left, box[0]), left - _OUTSIDE), max(min(bottom, box[1]), bottom - _OUTSIDE)),
        (min(max(right, box[2]), right + _OUTSIDE), min(max(top, box[3]), top + _OUTSIDE)),
    )
