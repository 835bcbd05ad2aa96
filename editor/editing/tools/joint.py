"""Joins two bodies where they overlap: a hinge, or a weld that also holds the angle."""

import math

from editor.base.events import Pointer, PointerEvent
from editor.base.overlay import Cursor, Dot, Line, Mark, Outline, Ring, Style
from editor.base.prompts import Choice, MenuQuestion
from editor.documents.commands.joints import AddJoint
from editor.documents.document import Document
from editor.editing.picking import bodies_at
from editor.editing.snapping import snap_point
from editor.editing.tools.base import Feedback, Gesture, Tool, ToolContext
from kinetix.level.geometry import referenced_body, world_vertices
from kinetix.level.model import BodyReference, Circle, JointKind, Level, Point

TOO_FEW = "A joint needs two overlapping shapes"
_TOUCHING = 3.0
"""Shapes nearer to the pointer than this can be joined where none overlap [px]."""
_HUB = 1 / 3
"""The part of a circle's radius within which its centre is meant."""
PAIRS_MAX = 10
"""Pairs offered when several bodies lie under the pointer."""


class JointTool(Tool):
    """Click where two bodies overlap; with two bodies selected they are taken."""

    id = "joint"
    label = "Joint"
    hint = "Click where two shapes overlap: a hinge with a motor."
    kind: JointKind = "revolute"
    creates = True

    def hover(self, session: ToolContext, event: PointerEvent) -> Feedback:
        """Show the anchor and the two bodies, or why there is nothing to join."""
        point = self._point(session, event)
        pairs = self._pairs(session, point)
        if not pairs:
            return Feedback(hint=TOO_FEW, cursor=Cursor.REFUSED)
        return Feedback(
            marks=pair_marks(session.document.level, pairs[0], point), cursor=Cursor.CROSS
        )

    def press(self, session: ToolContext, event: PointerEvent) -> Gesture | None:
        """Join at the release; several pairs are asked about."""
        point = self._point(session, event)
        pairs = self._pairs(session, point)
        if not pairs:
            session.complain(TOO_FEW)
            return None
        return self._join(session, pairs, point)

    def _join(
        self, session: ToolContext, pairs: list[tuple[BodyReference, BodyReference]], point: Point
    ) -> Gesture:
        document = session.document
        level = document.level
        while True:
            marks = pair_marks(level, pairs[0], point)
            event = yield Feedback(marks=marks, cursor=Cursor.CROSS)
            if event.kind is Pointer.RELEASE:
                break
        if len(pairs) == 1:
            return AddJoint(bodies=pairs[0], point=point, kind=self.kind)
        choices = tuple(
            Choice(
                id=str(k),
                label=f"{document.name_of(a)} — {document.name_of(b)}",
                ids=(a, b),
            )
            for k, (a, b) in enumerate(pairs[:PAIRS_MAX])
        )
        session.ask(
            MenuQuestion(
                title="Join which shapes?",
                choices=choices,
                at=event.screen,
                answer=lambda choice: self._answered(session, document, pairs, point, choice),
            )
        )
        return None

    def _answered(
        self,
        session: ToolContext,
        document: Document,
        pairs: list[tuple[BodyReference, BodyReference]],
        point: Point,
        choice: str | None,
    ) -> None:
        if choice is not None:
            command = AddJoint(bodies=pairs[int(choice)], point=point, kind=self.kind)
            session.execute(command, on=document)
            session.tool_done()

    def _point(self, session: ToolContext, event: PointerEvent) -> Point:
        rules = session.rules(event.modifiers)
        hub = self._hub(session, event.world) if rules.smart else None
        if hub is not None and self._pairs(session, hub):
            return hub
        return snap_point(event.world, rules, session.targets()).point

    def _hub(self, session: ToolContext, point: Point) -> Point | None:
        """Return the centre of the uppermost wheel that a point lies near the middle of.

        A wheel that turns about another point wobbles.
        """
        level = session.document.level
        for found in bodies_at(level, point, without=session.document.hidden, arena=False):
            body = referenced_body(level, found)  # pyright: ignore[reportArgumentType]
            if isinstance(body.shape, Circle):
                near = math.dist(body.position, point) <= _HUB * body.shape.radius
                return body.position if near else None
        return None

    def _pairs(
        self, session: ToolContext, point: Point
    ) -> list[tuple[BodyReference, BodyReference]]:
        """Return the pairs of bodies that overlap at a point; where none do, those that touch."""
        margin = _TOUCHING * session.metres
        return self._pairs_at(session, point, 0.0) or self._pairs_at(session, point, margin)

    def _pairs_at(
        self, session: ToolContext, point: Point, margin: float
    ) -> list[tuple[BodyReference, BodyReference]]:
        level = session.document.level
        selected = [i for i in session.selection if any(i == body.id for body in level.bodies)]
        under = list(bodies_at(level, point, without=session.document.hidden, margin=margin))
        if len(selected) == 2 and set(selected) <= set(under):
            return [(selected[0], selected[1])]  # pyright: ignore[reportReturnType]
        found = [(a, b) for i, a in enumerate(under) for b in under[i + 1 :]]
        free = [pair for pair in found if not all(isinstance(end, str) for end in pair)]
        return free  # pyright: ignore[reportReturnType]


class WeldTool(JointTool):
    """Like Joint, but the two bodies keep their angle."""

    id = "weld"
    label = "Weld"
    hint = "Click where two shapes overlap: they become one rigid piece."
    kind: JointKind = "fixed"


def pair_marks(
    level: Level, pair: tuple[BodyReference, BodyReference], point: Point
) -> tuple[Mark, ...]:
    """Return the two bodies of a joint and its anchor: A solid, B dashed."""
    marks: list[Mark] = []
    for reference, style in zip(pair, (Style.BODY_A, Style.BODY_B), strict=True):
        body = referenced_body(level, reference)
        if isinstance(body.shape, Circle):
            marks.append(Ring(centre=body.position, radius=body.shape.radius, style=style))
        else:
            marks.append(Outline(points=world_vertices(body), style=style))
        marks.append(Line(a=body.position, b=point, style=style))
    return (*marks, Dot(at=point, style=Style.PREVIEW))
