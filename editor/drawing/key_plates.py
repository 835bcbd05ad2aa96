"""The keys that drive a joint or thruster, drawn beside it."""

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Final

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.base.controls import Drive, key_caps
from editor.documents.commands.base import EntityId
from editor.drawing.strokes import Room
from editor.drawing.vectors import Painter, Placement
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, u32
from editor.toolkit.widgets import draw_key_plate, font, px
from kinetix.level.model import MOTOR_BINDINGS

_CAP: Final = 0.16
"""Height of a key cap [m] …"""
_CAP_PX: Final = 17.0
"""… but no more than this [px at 100 %]."""
_CAP_LEAST_PX: Final = 9.0
"""Smaller ones could not be read and are not drawn [px]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class CapPlace:
    """Place of the key caps of a joint or thruster."""

    entity: int
    low: Point
    high: Point


def paint_key_caps(
    painter: Painter,
    where: Placement,
    keys: Mapping[str, Drive],
    held: Collection[str],
    *,
    hidden: Collection[EntityId] = (),
    pointed: Collection[EntityId] = (),
) -> tuple[CapPlace, ...]:
    """Draw the keys that drive each joint and thruster beside it; held ones are lit.

    They shrink with the level and give way to each other, so that they do not bury it.

    Args:
        painter: Draws.
        where: The level and its poses.
        keys: The play keys.
        held: Those that are down.
        hidden: Entities whose keys are not drawn.
        pointed: Entities whose keys are drawn in full size, whatever the zoom.

    Returns:
        Where they were drawn.
    """
    wanted = [
        (i, at, caps) for i, at, caps in _driven(painter, where, keys, held) if i not in hidden
    ]
    wanted.sort(key=lambda row: row[0] not in pointed)
    room, places = Room(), []
    for entity, at, caps in wanted:
        full = entity in pointed
        height = px(_CAP_PX) if full else min(px(_CAP_PX), _CAP * painter.camera.scale)
        if height < px(_CAP_PX) * 0.5 and height < _CAP_LEAST_PX:
            continue
        place = _plates(painter.draw, at, caps, height, room, must=full)
        if place is not None:
            places.append(CapPlace(entity=entity, low=place[0], high=place[1]))
    return tuple(places)


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
            draw_key_plate(draw, *plate, lit=lit, opacity=0.92)
            ink = u32(COLOURS.backdrop if lit else COLOURS.text)
            spot = (x + (wide - size.x) / 2, y + (height - size.y) / 2)
            draw.add_text(spot, ink, words)
            x += wide + gap
        return low, (low[0] + width, low[1] + height)


def _channel_caps(
    channel: int, keys: Mapping[str, Drive], held: Collection[str]
) -> list[tuple[str, bool]]:
    driving = sorted((drive.value, key) for key, drive in keys.items() if drive.channel == channel)
    words = key_caps(channel, keys)
    return [(cap, key in held) for cap, (_, key) in zip(words, driving, strict=True)]
