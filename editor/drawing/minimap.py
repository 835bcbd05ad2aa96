"""A small map of the arena in the canvas's corner: where the view is, and a way to move it."""

import dataclasses
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import PIXELS_PER_UNIT, Camera, Point
from editor.drawing.vectors import Painter, Placement, paint_level
from editor.toolkit.appearance import COLOURS, alpha, u32
from editor.toolkit.widgets import px
from kinetix.level.geometry import ARENA_WIDTH

if TYPE_CHECKING:
    from editor.session import Session


_SIDE: Final = 132.0
_GAP: Final = 14.0


class Minimap:
    """Lower right; a press or drag on it brings that place to the middle."""

    def __init__(self) -> None:
        self._low: Point = (0.0, 0.0)
        self._side = 0.0
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
            metres = ARENA_WIDTH / self._side
            at = (x * metres, ARENA_WIDTH - y * metres)
            session.camera = dataclasses.replace(session.camera, centre=at)
        else:
            self._dragging = False
        return inside or self._dragging

    def paint(
        self, session: "Session", draw: imgui.ImDrawList, where: Placement, corner: Point
    ) -> None:
        """Draw it.

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
        zoom = side / (PIXELS_PER_UNIT * ARENA_WIDTH)
        painter = Painter(draw=draw, camera=Camera(origin=low, size=(side, side), zoom=zoom))
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
