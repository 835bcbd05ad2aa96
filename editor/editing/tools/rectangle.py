"""Draws rectangles: from corner to corner, or from the centre with Alt; Shift makes a square."""

import math
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Label
from editor.documents.commands.bodies import AddBody
from editor.editing.snapping import apart_from, measured, snap_point
from editor.editing.tools.base import Feedback, Gesture, Tool, ToolContext
from kinetix.level.model import Body, Point, Polygon

SIDE_MIN: Final = 0.02
"""A side shorter than this is taken for a slip of the hand [m]."""


def rectangle(width: float, height: float) -> Polygon:
    """Return a rectangle around the origin, counter-clockwise from the upper right corner."""
    x, y = width / 2, height / 2
    return Polygon(vertices=((x, y), (-x, y), (-x, -y), (x, -y)))


def dragged_box(
    start: Point, end: Point, *, square: bool, centred: bool, typed: tuple[float, ...]
) -> tuple[Point, float, float]:
    """Return centre, width and height of the rectangle between two points."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    if square:
        side = max(abs(dx), abs(dy))
        dx, dy = (side if dx >= 0 else -side), (side if dy >= 0 else -side)
    if typed:
        width, *others = (math.copysign(max(abs(side), SIDE_MIN), side) for side in typed)
        height = others[0] if others else width if square else None
        factor = 0.5 if centred else 1.0
        dx = (width if dx >= 0 else -width) * factor
        if height is not None:
            dy = (height if dy >= 0 else -height) * factor
    if centred:
        return start, 2 * abs(dx), 2 * abs(dy)
    return (start[0] + dx / 2, start[1] + dy / 2), abs(dx), abs(dy)


class RectangleTool(Tool):
    """Press at a corner, drag to the opposite one."""

    id = "rectangle"
    label = "Rectangle"
    hint = "Drag from corner to corner. Shift: square, Alt: from the centre, or type a size."
    click_click = True
    creates = True

    def press(self, session: ToolContext, event: PointerEvent) -> Gesture:
        """Draw one rectangle."""
        rules, available = session.rules(event.modifiers), session.targets()
        start = snap_point(event.world, rules, available).point
        available = apart_from(available, start)
        snapped, command = None, None
        feedback = Feedback(cursor=Cursor.CROSS)
        while True:
            event = yield feedback
            if event.kind is Pointer.RELEASE:
                if command is None and event.typed:
                    session.complain("Type width and height, as in 1x0.5.")
                return command
            rules = session.rules(event.modifiers)
            snapped = snap_point(event.world, rules, available, snapped)
            centre, width, height = dragged_box(
                start,
                snapped.point,
                square=event.modifiers.shift,
                centred=event.modifiers.alt or session.settings.from_centre,
                typed=event.typed,
            )
            command = None
            if min(width, height) >= SIDE_MIN:
                body = Body(id=1, shape=rectangle(width, height), position=centre)
                command = AddBody(body=body)
            label = Label(at=snapped.point, text=f"{width:.2f} × {height:.2f} m")
            feedback = Feedback(
                command=command, marks=(*measured(snapped.guides), label), cursor=Cursor.CROSS
            )
