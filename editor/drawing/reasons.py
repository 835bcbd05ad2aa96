"""Reasons for an agent's action over the level: attention, gradients, values of places."""

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui

from editor.base.wording import describe
from editor.drawing.agent_overlay import lean_colour
from editor.drawing.vectors import Painter, Placement
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Rgba, alpha, u32
from editor.toolkit.widgets import font, px
from editor.worker.requests import Explained
from kinetix.level.model import Circle

if TYPE_CHECKING:
    from editor.session import Session

_ATTENTION: Final[Rgba] = (0.55, 0.20, 0.75, 1.0)
_SALIENCY: Final[Rgba] = (0.95, 0.55, 0.05, 1.0)
_LEAST: Final = 0.02
"""Shares below this are not drawn."""


def paint_places(session: "Session", painter: Painter) -> None:
    """Tint the arena by what the agent would expect with a body there; under the level.

    Args:
        session: The app.
        painter: Where to draw.
    """
    told = _told(session, "places")
    if told is None or told.places is None:
        return
    draw, camera = painter.draw, painter.camera
    values = told.places - told.value
    most = max(float(np.abs(values).max()), 1e-6)
    x0, y0 = told.low
    for (row, column), value in np.ndenumerate(values / most):
        a = camera.to_screen((x0 + column * told.cell, y0 + (row + 1) * told.cell))
        b = camera.to_screen((x0 + (column + 1) * told.cell, y0 + row * told.cell))
        draw.add_rect_filled(a, b, u32(alpha(lean_colour(float(value)), 0.62)))


def paint_reasons(session: "Session", painter: Painter, where: Placement) -> None:
    """Draw attention and gradients on the entities, and what the colours mean.

    Args:
        session: The app.
        painter: Where to draw.
        where: The level and its poses.
    """
    attention = _told(session, "attention")
    if attention is not None and attention.attention is not None:
        _attention(painter, where, attention.attention)
    saliency = _told(session, "saliency")
    if saliency is not None:
        _saliency(painter, where, saliency)


def _told(session: "Session", overlay: str) -> Explained | None:
    reasons = session.viewer.reasons
    if overlay not in session.settings.agent_overlay or reasons.told is None:
        return None
    playback = session.playback
    level = playback.level if playback.active else session.document.level
    # In Edit a drag shows the level as it will be; the last answer still serves.
    same = reasons.level is not None and level is not None
    if not same or len(reasons.level.bodies) != len(level.bodies):  # pyright: ignore
        return None
    return reasons.told


def _reach(painter: Painter, where: Placement, index: int) -> tuple[tuple[float, float], float]:
    """Middle and radius of a body on the screen [px]."""
    body, pose = where.level.bodies[index], where.poses[index]
    middle = painter.camera.to_screen((pose[0], pose[1]))
    if isinstance(body.shape, Circle):
        reach = body.shape.radius
    else:
        reach = max(math.hypot(x, y) for x, y in body.shape.vertices)
    return middle, reach * painter.camera.scale


def _attention(painter: Painter, where: Placement, shares: np.ndarray) -> None:
    """A disc behind which each body shines through: the larger its share, the stronger."""
    draw = painter.draw
    most = max(float(shares.max()), 1e-6)
    for index, share in enumerate(shares.tolist()):
        if index >= len(where.level.bodies) or share < _LEAST:
            continue
        middle, reach = _reach(painter, where, index)
        strength = share / most
        tint = u32(alpha(_ATTENTION, 0.10 + 0.35 * strength))
        draw.add_circle_filled(middle, reach + px(4 + 8 * strength), tint)
        _label(draw, (middle[0], middle[1] - px(8)), f"{share:.0%}", _ATTENTION)


def _saliency(painter: Painter, where: Placement, told: Explained) -> None:
    """A ring around each entity, the thicker the more it matters."""
    draw, camera = painter.draw, painter.camera
    most = max(
        *(float(x.max()) if len(x) else 0.0 for x in (told.bodies, told.joints, told.thrusters)),
        1e-9,
    )
    for index, amount in enumerate(told.bodies.tolist()):
        if amount < _LEAST * most or index >= len(where.level.bodies):
            continue
        middle, reach = _reach(painter, where, index)
        _ring(draw, middle, reach + px(5), amount / most)
        _label(draw, (middle[0], middle[1] + px(7)), f"{amount:.2f}", _SALIENCY)
    for k, joint in enumerate(where.level.joints[: len(told.joints)]):
        if told.joints[k] >= _LEAST * most:
            middle = camera.to_screen(where.joint_point(joint))
            _ring(draw, middle, px(17), float(told.joints[k]) / most)
    for k, thruster in enumerate(where.level.thrusters[: len(told.thrusters)]):
        if told.thrusters[k] >= _LEAST * most:
            middle = camera.to_screen(where.point(thruster.body, thruster.position))
            _ring(draw, middle, px(14), float(told.thrusters[k]) / most)


def _ring(
    draw: imgui.ImDrawList, middle: tuple[float, float], radius: float, strength: float
) -> None:
    draw.add_circle(middle, radius, u32(alpha(_SALIENCY, 0.95)), 0, px(1 + 5 * strength))


def _label(draw: imgui.ImDrawList, middle: tuple[float, float], words: str, colour: Rgba) -> None:
    """Words on a small plate, so that they can be read on any body."""
    with font(FONTS.bold or FONTS.regular, SMALL - 1):
        size = imgui.calc_text_size(words)
        low = (middle[0] - size.x / 2, middle[1] - size.y / 2)
        high = (low[0] + size.x + px(6), low[1] + size.y)
        draw.add_rect_filled((low[0] - px(3), low[1]), (high[0] - px(3), high[1]), _PLATE, px(3))
        draw.add_text(low, u32(colour), words)


_PLATE: Final = imgui.color_convert_float4_to_u32((1.0, 1.0, 1.0, 0.85))


def paint_legend(session: "Session", draw: imgui.ImDrawList, corner: tuple[float, float]) -> None:
    """Write the legend of the colours, a line per overlay that is on.

    Args:
        session: The app.
        draw: Where to draw.
        corner: Lower left corner of the plate [px].
    """
    lines = _legend(session)
    if not lines:
        return
    with font(FONTS.regular, SMALL):
        step = imgui.get_text_line_height() + px(3)
        wide = max(imgui.calc_text_size(words).x for words, _ in lines) + px(34)
        low = (corner[0], corner[1] - step * len(lines) - px(10))
        high = (low[0] + wide, corner[1])
        draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.93)), px(6))
        draw.add_rect(low, high, u32(COLOURS.line), px(6))
        y = low[1] + px(5)
        for words, colour in lines:
            at = (low[0] + px(13), y + step / 2 - px(1))
            draw.add_circle_filled(at, px(5), u32(colour))
            draw.add_text((low[0] + px(24), y), u32(COLOURS.text), words)
            y += step


def _legend(session: "Session") -> list[tuple[str, Rgba]]:
    lines: list[tuple[str, Rgba]] = []
    told = _told(session, "attention")
    if told is not None:
        words = "Share of attention" if told.attention is not None else "It has no attention"
        lines.append((words, _ATTENTION))
    if _told(session, "saliency") is not None:
        what = "value" if session.viewer.reasons.about == "value" else "choice"
        lines.append((f"Slope of the {what} (10 cm, 0.1 rad, 1 m/s)", _SALIENCY))
    told = _told(session, "places")
    if told is not None and told.places is not None:
        low, high = float(told.places.min()), float(told.places.max())
        name = _name_of(session, told.body)
        words = f"Value with {name} there: {low:+.2f} (blue) to {high:+.2f} (red)"
        lines.append((words, lean_colour(1.0)))
    return lines


def _name_of(session: "Session", body: int | None) -> str:
    level = session.viewer.reasons.level
    return "it" if body is None or level is None else describe(level, body)
