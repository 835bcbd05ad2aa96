"""The keys that drive a joint or thruster, drawn beside it."""

import dataclasses
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Final, TypeAlias

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.base.controls import Drive, key_caps
from editor.documents.commands.base import EntityId
from editor.drawing.strokes import Room
from editor.drawing.vectors import Painter, Placement
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, u32
from editor.toolkit.widgets import draw_key_plate, font, px
from kinetix.level.geometry import bounds, touches_box
from kinetix.level.model import MOTOR_BINDINGS, Body

_CAP: Final = 0.16
"""Height of a key cap [m] …"""
_CAP_PX: Final = 17.0
"""… but no more than this [px at 100 %]."""
_CAP_LEAST_PX: Final = 9.0
"""Smaller ones could not be read and are not drawn [px]."""
_FURTHER: Final = (3, 5, 7)
"""Distances above and below to try once all corners are taken [usual distance]."""

Covered: TypeAlias = Callable[[Point, Point], bool]
"""Takes two opposite corners of a rectangle [px]; returns whether a shape overlaps it."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class CapPlace:
    """Place of the key caps of a joint or thruster."""

    entity: int
    low: Point
    high: Point


def paint_key_caps(  # noqa: PLR0913 - keys give way to that much
    painter: Painter,
    where: Placement,
    keys: Mapping[str, Drive],
    held: Collection[str],
    *,
    hidden: Collection[EntityId] = (),
    pointed: Collection[EntityId] = (),
    avoid: Sequence[Body] = (),
    ring: float = 0.0,
) -> tuple[CapPlace, ...]:
    """Draw the keys that drive each joint and thruster beside it; held ones are lit.

    They shrink with the level and give way to each other and to shapes, so that they do not bury
    it.

    Args:
        painter: Draws.
        where: The level and its poses.
        keys: The play keys.
        held: Those that are down.
        hidden: Entities whose keys are not drawn.
        pointed: Entities whose keys are drawn in full size, whatever the zoom.
        avoid: Shapes that the keys keep off, where there is room beside them.
        ring: Radius of what is drawn around every joint and thruster, and stays in sight [px].

    Returns:
        Where they were drawn.
    """
    wanted = [
        (i, at, caps) for i, at, caps in _driven(painter, where, keys, held) if i not in hidden
    ]
    wanted.sort(key=lambda row: row[0] not in pointed)
    room, places = Room(), []
    covered = _covering(painter, avoid)
    usual = min(px(_CAP_PX), _CAP * painter.camera.scale)
    # A place as far to the side as up lies outside of the ring.
    away = max(px(8) * max(usual / px(_CAP_PX), 0.6), ring / math.sqrt(2))
    small = usual < px(_CAP_PX) * 0.5 and usual < _CAP_LEAST_PX
    for entity, at, caps in wanted:
        full = entity in pointed
        if small and not full:
            continue
        height = px(_CAP_PX) if full else usual
        place = _plates(painter.draw, at, caps, (height, usual, away), room, covered, must=full)
        if place is not None:
            places.append(CapPlace(entity=entity, low=place[0], high=place[1]))
    return tuple(places)


def _covering(painter: Painter, bodies: Sequence[Body]) -> Covered:
    boxes = [(body, bounds(body)) for body in bodies]

    def covered(low: Point, high: Point) -> bool:
        left, top = painter.camera.to_world(low)
        right, bottom = painter.camera.to_world(high)
        box = (left, bottom, right, top)
        return any(
            own[0] <= right
            and own[2] >= left
            and own[1] <= top
            and own[3] >= bottom
            # The box around a shape rules out nearly all others at once.
            and touches_box(body, box)
            for body, own in boxes
        )

    return covered


def _driven(
    painter: Painter, where: Placement, keys: Mapping[str, Drive], held: Collection[str]
) -> Iterator[tuple[int, Point, list[tuple[str, bool]]]]:
    """Yield everything that keys drive: its id, its place [px], its keys and which are down."""
    camera = painter.camera
    for joint in where.level.joints:
        motor = joint.motor
        if joint.kind == "fixed" or motor is None or not motor.on:
            continue
        at = camera.to_screen(where.joint_point(joint))
        caps = _channel_caps(motor.binding, keys, held)
        yield joint.id, at, [("AUTO", False)] if motor.auto else caps
    for thruster in where.level.thrusters:
        at = camera.to_screen(where.point(thruster.body, thruster.position))
        caps = _channel_caps(MOTOR_BINDINGS + thruster.binding, keys, held)
        yield thruster.id, at, caps


def _plates(
    draw: imgui.ImDrawList,
    at: Point,
    caps: Sequence[tuple[str, bool]],
    lengths: tuple[float, float, float],
    room: Room,
    covered: Covered,
    *,
    must: bool,
) -> tuple[Point, Point] | None:
    """Draw a row of plates beside a place, where there is room; returns its corners [px].

    Of the lengths, the first is the height that is drawn. The second, which most plates have,
    chooses the place: one that grows under the pointer stays there. The third is how far away.
    """
    height, usual, away = lengths
    with font(FONTS.bold, (SMALL - 2) * height / px(_CAP_PX)):
        sizes = [imgui.calc_text_size(words) for words, _ in caps]
        widths = [max(size.x + 8 * height / _CAP_PX, height) for size in sizes]
        gap = 2 * height / _CAP_PX
        width = sum(widths) + gap * (len(widths) - 1)
        spots = _spots(at, away, (width, height))
        share = usual / height
        sparing = _spots(at, away, (width * share, usual))
        clear = [
            spot
            for spot, (x, y) in zip(spots, sparing, strict=True)
            if not covered((x, y), (x + width * share, y + usual))
        ]
        near = spots[:6]  # the corners, and the nearest places above and below
        low = next(
            (low for low in (*clear, *near) if room.take(low, (low[0] + width, low[1] + height))),
            spots[0] if must else None,
        )
        if low is None:
            return None
        x, y = low
        for (words, lit), size, wide in zip(caps, sizes, widths, strict=True):
            plate = (x, y), (x + wide, y + height)
            draw_key_plate(draw, *plate, lit=lit, opacity=0.92)
            ink = u32(COLOURS.backdrop if lit else COLOURS.text)
            spot = (x + (wide - size.x) / 2, y + (height - size.y) / 2)
            draw.add_text(spot, ink, words)
            x += wide + gap
        return low, (low[0] + width, low[1] + height)


def _spots(at: Point, away: float, size: Point) -> list[Point]:
    """Return upper left corners for a row of plates: the four corners, then above and below."""
    (x, y), (width, height) = at, size
    left, right, above, below = x - away - width, x + away, y - away - height, y + away
    corners = [(right, above), (left, above), (right, below), (left, below)]
    for far in _FURTHER:
        corners += [(x - width / 2, y - far * away - height), (x - width / 2, y + far * away)]
    return corners


def _channel_caps(
    channel: int, keys: Mapping[str, Drive], held: Collection[str]
) -> list[tuple[str, bool]]:
    driving = sorted((drive.value, key) for key, drive in keys.items() if drive.channel == channel)
    words = key_caps(channel, keys)
    return [(cap, key in held) for cap, (_, key) in zip(words, driving, strict=True)]
