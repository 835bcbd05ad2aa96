"""Draws circles: from the centre outwards, or from rim to rim with Alt."""

import math
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Label, Line, Style
from editor.documents.commands.bodies import AddBody
from editor.editing.snapping import apart_from, measured, snap_point, straightened
from editor.editing.tools.base import Feedback, Gesture, Tool, ToolContext
from kinetix.level.model import Body, Circle, Point

RADIUS_MIN: Final = 0.02
RADIUS_MAX: Final = 5.0
"""The format's limits [m]."""
RADIUS_STEP: Final = 0.05
"""Step of the radius with Shift [m]."""


class CircleTool(Tool):
    """Press at the centre, drag to the rim."""

    id = "circle"
    label = "Circle"
    hint = "Drag from the centre outwards. Shift: round radius, Alt: rim to rim, or type a radius."
    click_click = True
    creates = True

    def press(self, session: ToolContext, event: PointerEvent) -> Gesture:
        """Draw one circle."""
        available = session.targets()
        start = snap_point(event.world, session.rules(event.modifiers), available).point
        available = apart_from(available, start)
        snapped, command = None, None
        feedback = Feedback(cursor=Cursor.CROSS)
        while True:
            event = yield feedback
            if event.kind is Pointer.RELEASE:
                return command
            rules = session.rules(event.modifiers)
            snapped = snap_point(event.world, rules, available, snapped)
            end, centre = straightened(snapped.point, start, rules), start
            radius = math.dist(start, end)
            if event.modifiers.alt:
                centre, radius = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), radius / 2
            elif rules.grid is not None and not snapped.guides:
                radius = _on_grid(math.dist(start, event.world), rules.grid, rules.catch)
            if event.modifiers.shift:
                radius = max(round(radius / RADIUS_STEP), 1) * RADIUS_STEP
            if event.typed:
                radius = min(max(event.typed[0], RADIUS_MIN), RADIUS_MAX)
            command = None
            if RADIUS_MIN <= radius <= RADIUS_MAX:
                body = Body(id=1, shape=Circle(radius=radius), position=centre)
                command = AddBody(body=body)
            marks = (
                *measured(snapped.guides),
                Line(a=centre, b=_rim(centre, end, radius), style=Style.PREVIEW),
                Label(at=end, text=f"radius {radius:.2f} m"),
            )
            feedback = Feedback(command=command, marks=marks, cursor=Cursor.CROSS)


def _on_grid(radius: float, grid: float, catch: float) -> float:
    """The grid takes the radius, not the point of the rim: wheels drawn alike are equal."""
    nearest = max(round(radius / grid), 1) * grid
    return nearest if abs(nearest - radius) <= catch else radius


def _rim(centre: Point, towards: Point, radius: float) -> Point:
    far = math.dist(centre, towards)
    share = radius / far if far else 0.0
    x, y = (centre[k] + share * (towards[k] - centre[k]) for k in (0, 1))
    return x, y
