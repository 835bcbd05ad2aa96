"""The names of shapes, joints and thrusters, written beside them."""

from collections.abc import Collection, Iterator
from typing import Final

from imgui_bundle import imgui

from editor.documents.commands.base import EntityId
from editor.drawing.key_plates import CapPlace
from editor.drawing.strokes import Room
from editor.drawing.vectors import Painter, Placement, Point
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Rgba, alpha, u32
from editor.toolkit.widgets import font, px
from kinetix.level.model import Body, Circle

_MOST: Final = 26
"""Longer names are cut to so many characters."""


def paint_names(
    painter: Painter,
    where: Placement,
    *,
    hidden: Collection[EntityId] = (),
    caps: Collection[CapPlace] = (),
) -> None:
    """Write the names that the level has; one that would cover another or a key is left out.

    Args:
        painter: Where to draw.
        where: The level and its poses.
        hidden: Entities whose names are not written.
        caps: The key caps that are on the canvas.
    """
    room = Room(taken=[(cap.low, cap.high) for cap in caps])
    with font(FONTS.regular, SMALL):
        for entity, name, at, ink in _named(painter, where):
            if entity in hidden:
                continue
            words = name if len(name) <= _MOST else f"{name[: _MOST - 1]}…"
            _tag(painter.draw, room, at, words, ink)


def _named(painter: Painter, where: Placement) -> Iterator[tuple[EntityId, str, Point, Rgba]]:
    """Yield what has a name: its id, its name, the top of its place [px], its ink."""
    level, camera = where.level, painter.camera
    for body, (x, y, _) in zip(level.bodies, where.poses, strict=True):
        if body.name:
            # Within a large shape the name stands on its middle, below a small one.
            inside = _half(body) * camera.scale > px(18)
            at = camera.to_screen((x, y if inside else y - _half(body)))
            yield body.id, body.name, (at[0], at[1] + px(10 if inside else 2)), COLOURS.text
    for joint in level.joints:
        if joint.name:
            x, y = camera.to_screen(where.joint_point(joint))
            yield joint.id, joint.name, (x, y + px(7)), COLOURS.accent
    for thruster in level.thrusters:
        if thruster.name:
            x, y = camera.to_screen(where.point(thruster.body, thruster.position))
            yield thruster.id, thruster.name, (x, y + px(7)), COLOURS.accent


def _half(body: Body) -> float:
    """Return about how far a body reaches from its middle, at least [m]."""
    if isinstance(body.shape, Circle):
        return body.shape.radius
    return min(max(abs(point[axis]) for point in body.shape.vertices) for axis in (0, 1))


def _tag(draw: imgui.ImDrawList, room: Room, at: Point, words: str, ink: Rgba) -> None:
    """Draw a name on a plate, its upper edge in the middle at `at` or as near as there is room."""
    size = imgui.calc_text_size(words)
    width, height = size.x + px(8), size.y + px(3)
    for shift in (0.0, height + px(2), -height - px(2), 2 * (height + px(2))):
        low = (at[0] - width / 2, at[1] + shift)
        high = (low[0] + width, low[1] + height)
        if room.take(low, high):
            draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.88)), px(4))
            draw.add_rect(low, high, u32(COLOURS.line), px(4))
            draw.add_text((low[0] + px(4), low[1] + px(1.5)), u32(ink), words)
            return
