"""A small picture of a level, drawn with Pillow: neither JAX nor OpenGL is needed.

Colours, thicknesses and marks are those of the other drawings (`kinetix.render`). The picture is
drawn at twice its size and halved, which smooths the edges.
"""

import math
from typing import Final

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw

from editor.base.camera import Point
from editor.base.glyphs import glyph_place
from kinetix.level.geometry import ARENA_WIDTH, arena_body, referenced_body, to_world
from kinetix.level.model import ROLES, Body, Circle, Joint, Level, Thruster
from kinetix.render.palette import KINETIX, Palette, Rgb, ink
from kinetix.render.style import (
    ROLE_GLYPHS,
    STYLE,
    THRUSTER_FLAME,
    THRUSTER_NOZZLE,
    glyph_radius,
)

SIDE: Final = 160
"""Width and height of a stored thumbnail [px]."""
_OVERSAMPLING: Final = 2
_LEAST_MARK: Final = 3.0
"""Marks and glyphs are at least this large before halving [px]: they tell what can be driven."""


def draw_thumbnail(level: Level, side: int = SIDE) -> UInt8[np.ndarray, "h w 3"]:
    """Return the arena as the level starts.

    Args:
        level: The level.
        side: Width and height of the picture [px].

    Returns:
        uint8[side, side, 3], top row first.
    """
    big = side * _OVERSAMPLING
    image = Image.new("RGB", (big, big), KINETIX.background)
    sketch = _Sketch(ImageDraw.Draw(image), big / ARENA_WIDTH, KINETIX)
    sketch.body(arena_body(level.arena, "floor"))
    for circles in (False, True):
        for body in level.bodies:
            if isinstance(body.shape, Circle) is circles:
                sketch.body(body)
    for joint in level.joints:
        sketch.joint(level, joint)
    for thruster in level.thrusters:
        sketch.thruster(level, thruster)
    return np.asarray(image.resize((side, side), Image.Resampling.BOX))


class _Sketch:
    """Draws parts of a level, world metres in, pixels out."""

    def __init__(self, draw: ImageDraw.ImageDraw, scale: float, palette: Palette) -> None:
        self._draw = draw
        self._scale = scale
        self._palette = palette
        self._line = max(STYLE.outline * scale, 2.0)

    def _at(self, point: Point) -> Point:
        return point[0] * self._scale, (ARENA_WIDTH - point[1]) * self._scale

    def body(self, body: Body) -> None:
        """A body with its outline and role glyph."""
        role = ROLES.index(body.role)
        fill = self._palette.fill(role, fixed=body.fixed)
        middle, inscribed = glyph_place(body)
        if isinstance(body.shape, Circle):
            self._disc(body.position, inscribed * self._scale, fill)
            tip = to_world(body, (0.0, inscribed))
            ends = (self._at(body.position), self._at(tip))
            self._draw.line(ends, self._palette.outline, round(self._line))
        else:
            self._polygon([to_world(body, v) for v in body.shape.vertices], fill)
        radius = glyph_radius(inscribed, STYLE) * self._scale
        self._glyph(role, body, to_world(body, middle), radius, fill)

    def _disc(self, centre: Point, radius: float, fill: Rgb) -> None:
        x, y = self._at(centre)
        box = (x - radius, y - radius, x + radius, y + radius)
        self._draw.ellipse(box, fill, self._palette.outline, max(1, round(self._line)))

    def _polygon(self, points: list[Point], fill: Rgb, line: float = 0.0) -> None:
        corners = [self._at(point) for point in points]
        self._draw.polygon(corners, fill, self._palette.outline, max(1, round(line or self._line)))

    def _glyph(self, role: int, body: Body, at: Point, radius: float, fill: Rgb) -> None:
        glyph = ROLE_GLYPHS[role]
        if glyph is None:
            return
        r, colour = max(radius, _LEAST_MARK), ink(fill)
        x, y = self._at(at)
        if glyph.disc > 0:
            d = glyph.disc * r
            self._draw.ellipse((x - d, y - d, x + d, y + d), colour)
        if glyph.ring is not None:
            low, high = glyph.ring
            width = max(1, round((high - low) * r))
            self._draw.ellipse(
                (x - high * r, y - high * r, x + high * r, y + high * r), None, colour, width
            )
        if glyph.cross is not None:
            length, width = glyph.cross
            for turn in (math.pi / 4, -math.pi / 4):
                dx = math.cos(body.angle + turn) * length * r
                dy = -math.sin(body.angle + turn) * length * r
                ends = ((x - dx, y - dy), (x + dx, y + dy))
                self._draw.line(ends, colour, max(1, round(2 * width * r)))

    def joint(self, level: Level, joint: Joint) -> None:
        """A joint's mark: a disc, or a square for a weld."""
        try:
            a, b = referenced_body(level, joint.a), referenced_body(level, joint.b)
        except KeyError:
            return
        (ax, ay), (bx, by) = to_world(a, joint.anchor_a), to_world(b, joint.anchor_b)
        x, y = self._at(((ax + bx) / 2, (ay + by) / 2))
        r = max(STYLE.joint_radius * self._scale, _LEAST_MARK)
        driven = joint.kind == "revolute" and joint.motor is not None and joint.motor.on
        fill = self._palette.uncontrolled
        if driven and joint.motor is not None:
            fill = self._palette.motor_bindings[joint.motor.binding % 4]
        box = (x - r, y - r, x + r, y + r)
        if joint.kind == "fixed":
            self._draw.rectangle(box, fill, self._palette.outline, 1)
        else:
            self._draw.ellipse(box, fill, self._palette.outline, 1)

    def thruster(self, level: Level, thruster: Thruster) -> None:
        """A thruster's nozzle and flame."""
        try:
            body = level.body(thruster.body)
        except KeyError:
            return
        x, y = to_world(body, thruster.position)
        angle, size = body.angle + thruster.angle, STYLE.thruster_size
        c, s = math.cos(angle) * size, math.sin(angle) * size
        flame = self._palette.thruster_bindings[thruster.binding % 2]
        for shape, fill in ((THRUSTER_FLAME, flame), (THRUSTER_NOZZLE, self._palette.nozzle)):
            points = [(x + c * u - s * v, y + s * u + c * v) for u, v in shape]
            self._polygon(points, fill, line=1.0)
