"""Draws triangles by three clicks; the turning sense does not matter."""

import math
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Dot, Label, Line, Mark, Outline, Style
from editor.documents.commands.bodies import AddBody
from editor.documents.commands.group import polygon_body
from editor.editing.snapping import APART, NO_SNAPPING, snap_point
from editor.editing.tools.base import DRAG_PIXELS, Feedback, Gesture, Tool, ToolContext
from kinetix.errors import CommandError
from kinetix.level.geometry import polygon_fault, signed_area
from kinetix.level.model import Point

AREA_MIN: Final = 1e-3
"""A triangle smaller than this is refused [m²]."""


class TriangleTool(Tool):
    """Click three corners."""

    id = "triangle"
    label = "Triangle"
    hint = "Click the three corners."
    creates = True

    def press(self, session: ToolContext, event: PointerEvent) -> Gesture:
        """Draw one triangle; each press sets a corner, and so does a drag's release."""
        available = session.targets()
        snapped = snap_point(event.world, session.rules(event.modifiers), available)
        corners: list[Point] = [snapped.point]
        pressed = event.world
        reach = session.metres * DRAG_PIXELS
        while len(corners) < 3:
            event = yield Feedback(marks=_marks(corners, snapped.point), cursor=Cursor.CROSS)
            snapped = snap_point(event.world, session.rules(event.modifiers), available, snapped)
            if any(math.dist(snapped.point, corner) < APART for corner in corners):
                # A corner that snapped onto another one would leave no triangle.
                snapped = snap_point(event.world, NO_SNAPPING, available)
            dragged = max(abs(event.world[k] - pressed[k]) for k in (0, 1)) > reach
            if event.kind is Pointer.PRESS or (event.kind is Pointer.RELEASE and dragged):
                corners.append(snapped.point)
                pressed = event.world
        area = abs(signed_area(corners))
        if area < AREA_MIN:
            raise CommandError(f"This triangle is too flat: {area:.4f} m², at least {AREA_MIN} m².")
        body = polygon_body(tuple(corners), session.document.level)
        assert polygon_fault(body.shape.vertices) is None  # pyright: ignore[reportAttributeAccessIssue]
        return AddBody(body=body)


def _marks(corners: list[Point], pointer: Point) -> tuple[Mark, ...]:
    dots = tuple(Dot(at=corner, style=Style.PREVIEW) for corner in corners)
    if len(corners) == 1:
        return (*dots, Line(a=corners[0], b=pointer, style=Style.PREVIEW))
    area = abs(signed_area((*corners, pointer)))
    style = Style.PREVIEW if area >= AREA_MIN else Style.REFUSED
    return (
        *dots,
        Outline(points=(*corners, pointer), style=style),
        Label(at=pointer, text=f"{area:.3f} m²"),
    )
