"""Puts thrusters on bodies: press where it sits, drag where it pushes."""

import math
from typing import Final

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Label, Line, Style
from editor.documents.commands.thrusters import AddThruster
from editor.editing.picking import bodies_at
from editor.editing.snapping import snap_angle, snap_point
from editor.editing.tools.base import Feedback, Gesture, Tool, ToolContext
from kinetix.level.model import Body, Point

NO_BODY = "A thruster needs a shape to push"
CENTRE_REACH: Final = math.radians(7.0)
"""Directions this near to the line through the body's centre go through it."""
AIM_PIXELS: Final = 6.0
"""A shorter drag [px at 100 %] does not aim: the thruster pushes towards the centre, or upwards."""


def aimed(body: Body, point: Point, pointer: Point, *, step: float | None) -> float:
    """Return the direction of a thruster at `point` when dragged to `pointer` [rad].

    Args:
        body: The body that is pushed.
        point: Attachment in the world [m].
        pointer: Where the pointer is [m].
        step: The angle's grid [rad], or None for any angle.
    """
    angle = math.atan2(pointer[1] - point[1], pointer[0] - point[0])
    if step is None:
        return angle
    through = centre_direction(body, point)
    for candidate in () if through is None else (through, through + math.pi):
        if abs(math.remainder(angle - candidate, math.tau)) <= CENTRE_REACH:
            return math.remainder(candidate, math.tau)
    return snap_angle(angle, step)


def centre_direction(body: Body, point: Point) -> float | None:
    """Direction from the attachment to the body's centre [rad], or None at the centre."""
    dx, dy = body.position[0] - point[0], body.position[1] - point[1]
    return math.atan2(dy, dx) if math.hypot(dx, dy) > 1e-3 else None


class ThrusterTool(Tool):
    """Press on a body, drag in the direction in which it shall be pushed."""

    id = "thruster"
    label = "Thruster"
    hint = "Press on a shape and drag in the direction of the push. Ctrl: any angle."
    click_click = True
    creates = True

    def hover(self, session: ToolContext, event: PointerEvent) -> Feedback:
        """Report whether there is something to push."""
        if self._body(session, event.world) is None:
            return Feedback(hint=NO_BODY, cursor=Cursor.REFUSED)
        return Feedback(cursor=Cursor.CROSS)

    def press(self, session: ToolContext, event: PointerEvent) -> Gesture | None:
        """Place and aim one thruster."""
        body = self._body(session, event.world)
        if body is None:
            session.complain(NO_BODY)
            return None
        return self._aim(session, event, body)

    def _aim(self, session: ToolContext, event: PointerEvent, body: Body) -> Gesture:
        rules = session.rules(event.modifiers)
        point = snap_point(event.world, rules, session.targets()).point
        through = centre_direction(body, point)
        direction = math.pi / 2 if through is None else through
        while True:
            command = AddThruster(body=body.id, point=point, direction=direction)
            reach = 60 * session.metres
            tip = (point[0] + reach * math.cos(direction), point[1] + reach * math.sin(direction))
            degrees = math.degrees(math.remainder(direction, math.tau))
            event = yield Feedback(
                command=command,
                marks=(
                    Line(a=point, b=tip, style=Style.FORCE, arrow=True),
                    Label(at=tip, text=f"{degrees:.0f}°"),
                ),
                cursor=Cursor.CROSS,
            )
            if math.dist(event.world, point) > AIM_PIXELS * session.metres:
                step = None if event.modifiers.ctrl else session.angle_step
                direction = aimed(body, point, event.world, step=step)
            if event.typed:
                direction = math.radians(event.typed[0])
            if event.kind is Pointer.RELEASE:
                return AddThruster(body=body.id, point=point, direction=direction)

    def _body(self, session: ToolContext, point: Point) -> Body | None:
        level = session.document.level
        under = bodies_at(level, point, without=session.document.hidden, arena=False)
        return level.body(int(under[0])) if under else None
