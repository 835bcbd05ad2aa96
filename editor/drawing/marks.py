"""Marks on top of the level: selection, hover, tool marks, handles."""

import dataclasses
import itertools
import math
from collections.abc import Collection, Sequence
from typing import Final

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.base.overlay import (
    Arc,
    Box,
    Dot,
    Handle,
    HandleKind,
    Label,
    Line,
    Mark,
    Outline,
    Ring,
    Style,
)
from editor.base.wording import entities_by_id
from editor.documents.commands.base import EntityId
from editor.drawing.strokes import arrow, dashed, label_plate
from editor.drawing.vectors import Painter, Placement
from editor.editing.gauges import KINDS
from editor.toolkit import draw_list
from editor.toolkit.appearance import COLOURS, Rgba, alpha, u32
from editor.toolkit.widgets import px
from kinetix.level.geometry import STANDARD_ARENA
from kinetix.level.model import ARENA_NAMES, Circle, Joint, Thruster

_STYLES: Final[dict[Style, Rgba]] = {
    Style.PREVIEW: COLOURS.accent_strong,
    Style.GUIDE: (0.93, 0.2, 0.55, 1.0),
    Style.SELECTED: COLOURS.accent_strong,
    Style.HOVER: COLOURS.accent,
    Style.BODY_A: COLOURS.accent_strong,
    Style.BODY_B: COLOURS.accent_strong,
    Style.MARQUEE_CONTAINED: COLOURS.accent_strong,
    Style.MARQUEE_TOUCHING: (0.1, 0.62, 0.42, 1.0),
    Style.FORCE: (0.95, 0.45, 0.05, 1.0),
    Style.QUANTITY: (0.10, 0.45, 0.95, 1.0),
    Style.REFUSED: COLOURS.bad,
}
_GAUGE: Final = {HandleKind.MOTOR: Style.FORCE, HandleKind.POWER: Style.FORCE}
_DASHED: Final = (Style.BODY_B, Style.MARQUEE_TOUCHING)
_HALO: Final = (1.0, 1.0, 1.0, 0.85)
"""Under thin coloured lines, so that they stand out on bodies of any colour."""

_ROUND: Final = frozenset({HandleKind.ROTATE, HandleKind.AIM, HandleKind.RADIUS}) | KINDS
"""Handles that turn or lengthen something are round; those of sizes have corners."""
HANDLE_PX: Final = 4.5
"""Half the side of a handle [px at 100 %]."""


@dataclasses.dataclass(kw_only=True)
class Marker:
    """Draws marks of constant size on the screen over a painted level."""

    painter: Painter
    where: Placement

    @property
    def draw(self) -> imgui.ImDrawList:
        """The draw list."""
        return self.painter.draw

    def outline(
        self, entity: EntityId, colour: Rgba, width: float, *, dash: bool = False, grow: float = 0.0
    ) -> None:
        """A line around a body, joint, thruster or arena body.

        Args:
            entity: Its id or name.
            colour: Colour of the line.
            width: Thickness [px at 100 %].
            dash: Dashed instead of solid.
            grow: How far outside the edge [px at 100 %].
        """
        ring = self._ring(entity)
        if ring is not None:
            centre, radius = ring
            radius += px(grow)
            self.draw.add_circle(centre, radius, u32(_HALO), 0, px(width) + px(2))
            self.draw.add_circle(centre, radius, u32(colour), 0, px(width))
            return
        points = self._corners(entity)
        if not points:
            return
        if grow:
            points = _grown(points, px(grow))
        if dash:
            dashed(self.draw, points, u32(colour), px(width), closed=True)
            return
        draw_list.stroke(self.draw, points, u32(_HALO), px(width) + px(2), closed=True)
        draw_list.stroke(self.draw, points, u32(colour), px(width), closed=True)

    def _ring(self, entity: EntityId) -> tuple[Point, float] | None:
        if isinstance(entity, str):
            return None
        found = entities_by_id(self.where.level).get(entity)
        camera = self.painter.camera
        if isinstance(found, Joint):
            at = camera.to_screen(self.where.joint_point(found))
            return at, max(self.painter.style.joint_radius * camera.scale, 2.5) + px(3)
        if isinstance(found, Thruster):
            at = camera.to_screen(self.where.point(found.body, found.position))
            return at, self.painter.style.thruster_size / 2 * camera.scale + px(3)
        pose = self.where.pose(entity)
        if pose is None:
            return None
        body = self.where.level.bodies[self.where.index[entity]]
        if isinstance(body.shape, Circle):
            return camera.to_screen((pose[0], pose[1])), body.shape.radius * camera.scale
        return None

    def _corners(self, entity: EntityId) -> list[Point]:
        if isinstance(entity, str):
            if entity not in ARENA_NAMES:
                return []
            geometry = getattr(self.where.level.arena, entity).geometry
            geometry = geometry or STANDARD_ARENA[entity]
            x, y = geometry.position
            return self.painter.place((x, y, 0.0), geometry.vertices)
        pose = self.where.pose(entity)
        if pose is None:
            return []
        shape = self.where.level.bodies[self.where.index[entity]].shape
        return [] if isinstance(shape, Circle) else self.painter.place(pose, shape.vertices)

    def marks(self, marks: Sequence[Mark]) -> None:
        """Draw what a tool wants to be seen."""
        for mark in marks:
            self._mark(mark)

    def _mark(self, mark: Mark) -> None:  # noqa: C901 - one case a kind
        to_screen = self.painter.camera.to_screen
        match mark:
            case Line(a=a, b=b, style=style, arrow=True):
                arrow(self.draw, to_screen(a), to_screen(b), u32(_STYLES[style]), px(2.5), px(12))
            case Line(a=a, b=b, style=style):
                width = px(1) if style is Style.GUIDE else px(1.75)
                if style in _DASHED:
                    ends = (to_screen(a), to_screen(b))
                    dashed(self.draw, ends, u32(_STYLES[style]), width, closed=False)
                else:
                    self.draw.add_line(to_screen(a), to_screen(b), u32(_STYLES[style]), width)
            case Ring(centre=centre, radius=radius, style=style):
                r = radius * self.painter.camera.scale
                self.draw.add_circle(to_screen(centre), r, u32(_HALO), 0, px(4))
                self.draw.add_circle(to_screen(centre), r, u32(_STYLES[style]), 0, px(2))
            case Arc():
                self._arc(mark)
            case Outline(points=points, style=style):
                self._closed([to_screen(point) for point in points], style)
            case Box(low=low, high=high, style=style):
                a, b = to_screen((low[0], high[1])), to_screen((high[0], low[1]))
                self.draw.add_rect_filled(a, b, u32(alpha(_STYLES[style], 0.12)))
                self._closed([a, (b[0], a[1]), b, (a[0], b[1])], style)
            case Dot(at=at, style=style):
                self.draw.add_circle_filled(to_screen(at), px(5), u32(_HALO))
                self.draw.add_circle_filled(to_screen(at), px(3.5), u32(_STYLES[style]))
            case Label(at=at, text=words):
                label_plate(self.draw, to_screen(at), words)
            case Handle(kind=kind, at=at):
                self._handle(kind, to_screen(at))

    def _arc(self, arc: Arc) -> None:
        centre = self.painter.camera.to_screen(arc.centre)
        r, colour = arc.radius * self.painter.camera.scale, _STYLES[arc.style]
        # On the screen y points down, so counter-clockwise is a falling angle.
        sweep = max(-math.tau, min(arc.end - arc.start, math.tau))
        steps = max(int(abs(sweep) * 12), 2)
        angles = [-(arc.start + sweep * k / steps) for k in range(steps + 1)]
        points = [(centre[0] + r * math.cos(a), centre[1] + r * math.sin(a)) for a in angles]
        if arc.filled:
            fan: list[Point] = [centre, *points]
            for p, q in itertools.pairwise(fan[1:]):
                draw_list.fill(self.draw, (centre, p, q), u32(alpha(colour, 0.16)))
            draw_list.stroke(self.draw, fan, u32(colour), px(1.5), closed=True)
            return
        draw_list.stroke(self.draw, points, u32(_HALO), px(4.5))
        draw_list.stroke(self.draw, points, u32(colour), px(2.5))

    def _closed(self, points: list[Point], style: Style) -> None:
        colour = u32(_STYLES[style])
        if style in _DASHED:
            dashed(self.draw, points, colour, px(1.75), closed=True)
            return
        if style is not Style.MARQUEE_CONTAINED:
            draw_list.stroke(self.draw, points, u32(_HALO), px(4), closed=True)
        draw_list.stroke(self.draw, points, colour, px(1.75), closed=True)

    def _handle(self, kind: HandleKind, at: Point) -> None:
        r = px(HANDLE_PX)
        line, face = u32(COLOURS.accent_strong), u32((1.0, 1.0, 1.0, 1.0))
        if kind in _ROUND:
            self.draw.add_circle_filled(at, r + px(2), line)
            self.draw.add_circle_filled(at, r, face)
            if kind in KINDS:
                self.draw.add_circle_filled(
                    at, r - px(1.5), u32(_STYLES[_GAUGE.get(kind, Style.QUANTITY)])
                )
            if kind is HandleKind.ROTATE:
                self.draw.add_circle_filled(at, px(1.5), line)
            return
        if kind is HandleKind.VERTEX:
            points = [
                (at[0], at[1] - r - px(1)),
                (at[0] + r + px(1), at[1]),
                (at[0], at[1] + r + px(1)),
                (at[0] - r - px(1), at[1]),
            ]
            draw_list.fill(self.draw, points, face)
            draw_list.stroke(self.draw, points, line, px(1.75), closed=True)
            return
        low, high = (at[0] - r, at[1] - r), (at[0] + r, at[1] + r)
        self.draw.add_rect_filled(low, high, face, px(1.5))
        self.draw.add_rect(low, high, line, px(1.5), px(1.75))

    def selection(self, selected: Collection[EntityId], hovered: Collection[EntityId]) -> None:
        """Outlines of what is selected and of what the pointer is over."""
        for entity in hovered:
            if entity not in selected:
                self.outline(entity, COLOURS.accent, 1.5)
        for entity in selected:
            self.outline(entity, COLOURS.accent_strong, 2.25)


def _grown(points: list[Point], by: float) -> list[Point]:
    """Return a convex polygon with its corners pushed away from the middle [px]."""
    cx = sum(x for x, _ in points) / len(points)
    cy = sum(y for _, y in points) / len(points)
    grown = []
    for x, y in points:
        length = max(math.hypot(x - cx, y - cy), 1e-6)
        grown.append((x + (x - cx) / length * by, y + (y - cy) / length * by))
    return grown
