"""Marks on top of the level: selection, hover, tool marks, handles, key caps."""

import dataclasses
import itertools
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Final

from imgui_bundle import imgui

from editor.base.controls import Drive, key_caps
from editor.base.language import tr
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
from editor.documents.commands.base import EntityId
from editor.drawing.vectors import Painter, Placement
from editor.editing.gauges import KINDS
from editor.toolkit import draw_list
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Rgba, alpha, u32
from editor.toolkit.widgets import draw_key_plate, font, px
from kinetix.level.geometry import STANDARD_ARENA
from kinetix.level.model import ARENA_NAMES, MOTOR_BINDINGS, Circle, Joint, Thruster

Point = tuple[float, float]

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

_CAP: Final = 0.16
"""Height of a key cap [m] …"""
_CAP_PX: Final = 17.0
"""… but no more than this [px at 100 %]."""
_CAP_LEAST_PX: Final = 9.0
"""Smaller ones could not be read and are not drawn [px]."""
_ROUND: Final = frozenset({HandleKind.ROTATE, HandleKind.AIM, HandleKind.RADIUS}) | KINDS
"""Handles that turn or lengthen something are round; those of sizes have corners."""
HANDLE_PX: Final = 4.5
"""Half the side of a handle [px at 100 %]."""


def dashed(
    draw: imgui.ImDrawList, points: Sequence[Point], colour: int, width: float, *, closed: bool
) -> None:
    """A dashed line through points [px]."""
    dash, gap = px(6), px(4)
    pairs = list(zip(points, [*points[1:], *points[:1]], strict=True))
    for (ax, ay), (bx, by) in pairs if closed else pairs[:-1]:
        length = math.hypot(bx - ax, by - ay)
        if length < 1e-6:
            continue
        ux, uy = (bx - ax) / length, (by - ay) / length
        at = 0.0
        while at < length:
            end = min(at + dash, length)
            draw.add_line(
                (ax + ux * at, ay + uy * at), (ax + ux * end, ay + uy * end), colour, width
            )
            at = end + gap


def arrow(
    draw: imgui.ImDrawList, a: Point, b: Point, colour: int, width: float, head: float
) -> None:
    """A line with a head at `b` [px]."""
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    if length < 1e-3:
        return
    ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    head = min(head, length)
    base = (b[0] - ux * head, b[1] - uy * head)
    draw.add_line(a, base, colour, width)
    wing = head * 0.45
    draw.add_triangle_filled(
        b,
        (base[0] - uy * wing, base[1] + ux * wing),
        (base[0] + uy * wing, base[1] - ux * wing),
        colour,
    )


def label_plate(draw: imgui.ImDrawList, at: Point, words: str, colour: Rgba | None = None) -> None:
    """A short text on a plate, to the lower right of a place [px]."""
    words = tr(words)
    with font(FONTS.regular, SMALL):
        size = imgui.calc_text_size(words)
        low = (at[0] + px(14), at[1] + px(14))
        high = (low[0] + size.x + px(12), low[1] + size.y + px(6))
        draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.94)), px(5))
        draw.add_rect(low, high, u32(COLOURS.line), px(5))
        draw.add_text((low[0] + px(6), low[1] + px(3)), u32(colour or COLOURS.text), words)


@dataclasses.dataclass(kw_only=True)
class Room:
    """The places on the screen that labels have taken, so that none covers another."""

    taken: list[tuple[Point, Point]] = dataclasses.field(default_factory=list)

    def take(self, low: Point, high: Point) -> bool:
        """Take a rectangle [px] if it is free; returns whether it was."""
        for other_low, other_high in self.taken:
            beside = low[0] >= other_high[0] or high[0] <= other_low[0]
            if not beside and low[1] < other_high[1] and high[1] > other_low[1]:
                return False
        self.taken.append((low, high))
        return True


@dataclasses.dataclass(frozen=True, kw_only=True)
class CapPlace:
    """Place of the key caps of a joint or thruster."""

    entity: int
    low: Point
    high: Point


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
        found = self._find(entity)
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

    def _find(self, entity: int) -> Joint | Thruster | None:
        for part in (*self.where.level.joints, *self.where.level.thrusters):
            if part.id == entity:
                return part
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

    def key_caps(
        self,
        keys: Mapping[str, Drive],
        held: Collection[str],
        *,
        hidden: Collection[EntityId] = (),
        pointed: Collection[EntityId] = (),
    ) -> tuple[CapPlace, ...]:
        """Draw the keys that drive each joint and thruster beside it; held ones are lit.

        They shrink with the level and give way to each other, so that they do not bury it.

        Args:
            keys: The play keys.
            held: Those that are down.
            hidden: Entities whose keys are not drawn.
            pointed: Entities whose keys are drawn in full size, whatever the zoom.

        Returns:
            Where they were drawn.
        """
        wanted = [(i, at, caps) for i, at, caps in self._driven(keys, held) if i not in hidden]
        wanted.sort(key=lambda row: row[0] not in pointed)
        room, places = Room(), []
        for entity, at, caps in wanted:
            full = entity in pointed
            height = px(_CAP_PX) if full else min(px(_CAP_PX), _CAP * self.painter.camera.scale)
            if height < px(_CAP_PX) * 0.5 and height < _CAP_LEAST_PX:
                continue
            place = self._plates(at, caps, height, room, must=full)
            if place is not None:
                places.append(CapPlace(entity=entity, low=place[0], high=place[1]))
        return tuple(places)

    def _driven(
        self, keys: Mapping[str, Drive], held: Collection[str]
    ) -> Iterator[tuple[int, Point, list[tuple[str, bool]]]]:
        """Yield everything that keys drive: its id, its place [px], its keys and which are down."""
        camera = self.painter.camera
        for joint in self.where.level.joints:
            motor = joint.motor
            if joint.kind == "fixed" or motor is None or not motor.on:
                continue
            at = camera.to_screen(self.where.joint_point(joint))
            caps = _channel_caps(motor.binding, keys, held)
            yield joint.id, at, [("AUTO", False)] if motor.auto else caps
        for thruster in self.where.level.thrusters:
            at = camera.to_screen(self.where.point(thruster.body, thruster.position))
            caps = _channel_caps(MOTOR_BINDINGS + thruster.binding, keys, held)
            yield thruster.id, at, caps

    def _plates(
        self,
        at: Point,
        caps: Sequence[tuple[str, bool]],
        height: float,
        room: Room,
        *,
        must: bool,
    ) -> tuple[Point, Point] | None:
        """Draw a row of plates beside a place, where there is room; returns its corners [px]."""
        share = height / px(_CAP_PX)
        with font(FONTS.bold, (SMALL - 2) * share):
            sizes = [imgui.calc_text_size(words) for words, _ in caps]
            widths = [max(size.x + 8 * height / _CAP_PX, height) for size in sizes]
            gap = 2 * height / _CAP_PX
            width = sum(widths) + gap * (len(widths) - 1)
            away = px(8) * max(share, 0.6)
            corners = [
                (at[0] + away, at[1] - away - height),
                (at[0] - away - width, at[1] - away - height),
                (at[0] + away, at[1] + away),
                (at[0] - away - width, at[1] + away),
                (at[0] - width / 2, at[1] - 3 * away - height),
                (at[0] - width / 2, at[1] + 3 * away),
            ]
            free = (low for low in corners if room.take(low, (low[0] + width, low[1] + height)))
            low = next(free, corners[0] if must else None)
            if low is None:
                return None
            x, y = low
            for (words, lit), size, wide in zip(caps, sizes, widths, strict=True):
                plate = (x, y), (x + wide, y + height)
                draw_key_plate(self.draw, *plate, lit=lit, opacity=0.92)
                ink = u32(COLOURS.backdrop if lit else COLOURS.text)
                spot = (x + (wide - size.x) / 2, y + (height - size.y) / 2)
                self.draw.add_text(spot, ink, words)
                x += wide + gap
            return low, (low[0] + width, low[1] + height)


def _channel_caps(
    channel: int, keys: Mapping[str, Drive], held: Collection[str]
) -> list[tuple[str, bool]]:
    driving = sorted((drive.value, key) for key, drive in keys.items() if drive.channel == channel)
    words = key_caps(channel, keys)
    return [(cap, key in held) for cap, (_, key) in zip(words, driving, strict=True)]


def _grown(points: list[Point], by: float) -> list[Point]:
    """A convex polygon with its corners pushed away from the middle [px]."""
    cx = sum(x for x, _ in points) / len(points)
    cy = sum(y for _, y in points) / len(points)
    grown = []
    for x, y in points:
        length = max(math.hypot(x - cx, y - cy), 1e-6)
        grown.append((x + (x - cx) / length * by, y + (y - cy) / length * by))
    return grown
