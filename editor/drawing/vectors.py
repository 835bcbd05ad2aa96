"""A level as vectors on a Dear ImGui draw list: everything that Edit shows of it, without JAX.

Colours, thicknesses and marks come from `kinetix.render.palette` and `kinetix.render.style`, which
the JAX renderer uses too; the two drawings of one level must agree.
"""

import dataclasses
import math
from collections.abc import Collection, Sequence
from typing import Final

from imgui_bundle import imgui

from editor.base.camera import Camera, Point
from editor.base.glyphs import glyph_place
from editor.editing.picking import end_masses
from editor.toolkit import draw_list
from kinetix.level.geometry import ARENA_WIDTH, STANDARD_ARENA, arena_body, joint_place
from kinetix.level.model import (
    ROLES,
    Body,
    BodyReference,
    Circle,
    Joint,
    Level,
    Thruster,
)
from kinetix.render.palette import KINETIX, Palette, Rgb, ink
from kinetix.render.style import (
    ROLE_GLYPHS,
    ROLE_PATTERNS,
    STYLE,
    THRUSTER_FLAME,
    THRUSTER_NOZZLE,
    Pattern,
    Style,
    glyph_radius,
)

Pose = tuple[float, float, float]
"""x [m], y [m], angle [rad] of a body."""


def pack(colour: Rgb, opacity: float = 1.0) -> int:
    """Return a colour as draw lists take it."""
    red, green, blue = colour
    return round(opacity * 255) << 24 | blue << 16 | green << 8 | red


def inset(points: Sequence[Point], distance: float) -> list[Point] | None:
    """A convex polygon of either winding, its edges moved inwards; None when nothing is left."""
    count = len(points)
    area = sum(
        points[k - 1][0] * points[k][1] - points[k - 1][1] * points[k][0] for k in range(count)
    )
    sign = 1.0 if area > 0 else -1.0
    normals = []
    for k in range(count):
        (ax, ay), (bx, by) = points[k], points[(k + 1) % count]
        length = math.hypot(bx - ax, by - ay)
        if length < 1e-9:
            return None
        normals.append((sign * (ay - by) / length, sign * (bx - ax) / length))
    moved = []
    for k in range(count):
        (mx, my), (nx, ny) = normals[k - 1], normals[k]
        bend = 1.0 + mx * nx + my * ny
        if bend < 1e-6:
            return None
        x, y = points[k]
        moved.append((x + distance * (mx + nx) / bend, y + distance * (my + ny) / bend))
    for k in range(count):
        (ax, ay), (bx, by) = points[k], points[(k + 1) % count]
        (cx, cy), (dx, dy) = moved[k], moved[(k + 1) % count]
        if (bx - ax) * (dx - cx) + (by - ay) * (dy - cy) <= 0:
            return None
    return moved


def poses_of(level: Level) -> list[Pose]:
    """Return the poses of the bodies at the start."""
    return [(body.position[0], body.position[1], body.angle) for body in level.bodies]


@dataclasses.dataclass(kw_only=True)
class Painter:
    """Draws parts of a level through a camera."""

    draw: imgui.ImDrawList
    camera: Camera
    palette: Palette = KINETIX
    style: Style = STYLE
    opacity: float = 1.0
    """Of everything that is drawn (ghosts are fainter)."""

    def colour(self, rgb: Rgb) -> int:
        """Return the colour at the painter's opacity."""
        return pack(rgb, self.opacity)

    def outline_px(self) -> float:
        """Thickness of edges on the screen [px]."""
        return max(self.style.outline * self.camera.scale, self.style.least_outline)

    def mark_outline_px(self) -> float:
        """Thickness of the edges of joint and thruster marks [px]."""
        return max(self.style.mark_outline * self.camera.scale, self.style.least_outline / 2)

    def place(self, pose: Pose, points: Sequence[Point]) -> list[Point]:
        """Return points of a body's frame on the screen [px]."""
        camera = self.camera
        scale = camera.scale
        c, s = math.cos(pose[2]) * scale, math.sin(pose[2]) * scale
        ox, oy = camera.to_screen((pose[0], pose[1]))
        return [(ox + c * x - s * y, oy - s * x - c * y) for x, y in points]

    def paper(self, *, grid: float | None, width: float = ARENA_WIDTH) -> None:
        """The arena's square, with a grid of that step [m] on it if wanted."""
        camera = self.camera
        low, high = self.square(width)
        self.draw.add_rect_filled(low, high, self.colour(self.palette.background))
        if grid is None:
            return
        dark = sum(self.palette.background) < 384
        base = 255 if dark else 0
        thin, thick = pack((base, base, base), 0.07), pack((base, base, base), 0.15)
        # Lines closer than this melt into grey: show every second, fifth … one instead.
        while grid * camera.scale < 7.0:
            grid *= 2.0
        for k in range(round(width / grid) + 1):
            at = k * grid
            strong = abs(at - round(at)) < 1e-6
            colour = thick if strong else thin
            x, y = camera.to_screen((at, at))
            x, y = math.floor(x) + 0.5, math.floor(y) + 0.5
            self.draw.add_line((x, low[1]), (x, high[1]), colour)
            self.draw.add_line((low[0], y), (high[0], y), colour)

    def square(self, width: float) -> tuple[Point, Point]:
        """Upper left and lower right corner of the arena on whole pixels, so that edges meet."""
        left, top = self.camera.to_screen((0.0, width))
        right, bottom = self.camera.to_screen((width, 0.0))
        return (round(left), round(top)), (round(right), round(bottom))

    def floor(self, level: Level) -> None:
        """The floor, cut off at the arena's edge."""
        floor = arena_body(level.arena, "floor")
        low, high = self.square(ARENA_WIDTH)
        self.draw.push_clip_rect(low, high, True)
        self.body(floor, (*floor.position, floor.angle))
        self.draw.pop_clip_rect()

    def _polygon(self, points: list[Point], fill: Rgb) -> None:
        inner = inset(points, self.outline_px())
        draw_list.fill(self.draw, points, self.colour(self.palette.outline))
        if inner is not None:
            draw_list.fill(self.draw, inner, self.colour(fill))

    def body(self, body: Body, pose: Pose) -> None:
        """A body with outline, pattern and role glyph."""
        role = ROLES.index(body.role)
        fill = self.palette.fill(role, fixed=body.fixed)
        middle, inscribed = glyph_place(body)
        (centre,) = self.place(pose, [middle])
        if isinstance(body.shape, Circle):
            self._circle(centre, inscribed, pose[2], fill)
        else:
            self._polygon(self.place(pose, body.shape.vertices), fill)
        pattern = ROLE_PATTERNS[role]
        if self.style.patterns and pattern is not None:
            self._pattern(body, pose, pattern, fill)
        if self.style.glyphs:
            self._glyph(role, centre, glyph_radius(inscribed, self.style), pose[2], fill)

    def _circle(self, centre: Point, radius: float, angle: float, fill: Rgb) -> None:
        scale = self.camera.scale
        line = self.outline_px()
        outline = self.colour(self.palette.outline)
        r = radius * scale
        self.draw.add_circle_filled(centre, r, outline)
        self.draw.add_circle_filled(centre, max(r - line, 0.0), self.colour(fill))
        tip = (centre[0] - math.sin(angle) * r, centre[1] - math.cos(angle) * r)
        spoke = max(self.style.spoke * scale, self.style.least_outline)
        self.draw.add_line(centre, tip, outline, spoke)

    def _glyph(self, role: int, centre: Point, radius: float, angle: float, fill: Rgb) -> None:
        glyph = ROLE_GLYPHS[role]
        r = radius * self.camera.scale
        if glyph is None or r < 1.5:
            return
        colour = self.colour(ink(fill))
        if glyph.disc > 0:
            self.draw.add_circle_filled(centre, glyph.disc * r, colour)
        if glyph.ring is not None:
            low, high = glyph.ring
            self.draw.add_circle(centre, (low + high) / 2 * r, colour, 0, (high - low) * r)
        if glyph.cross is not None:
            length, width = glyph.cross
            for turn in (math.pi / 4, -math.pi / 4):
                dx, dy = math.cos(angle + turn) * length * r, -math.sin(angle + turn) * length * r
                start, end = (centre[0] - dx, centre[1] - dy), (centre[0] + dx, centre[1] + dy)
                self.draw.add_line(start, end, colour, 2 * width * r)

    def _pattern(self, body: Body, pose: Pose, pattern: Pattern, fill: Rgb) -> None:
        colour = pack(ink(fill), 0.5 * self.opacity)
        width = max(pattern.width * self.camera.scale, 1.0)
        for angle in pattern.angles:
            for a, b in _stripes(body, angle, pattern.period, self.style.outline):
                start, end = self.place(pose, (a, b))
                self.draw.add_line(start, end, colour, width)

    def joint(self, joint: Joint, at: Point, angle: float) -> None:
        """A joint's mark: a disc, or a square for a weld.

        Args:
            joint: The joint.
            at: Where it is [m].
            angle: Angle of its first body [rad].
        """
        fill = joint_colour(joint, self.palette)
        outline = self.colour(self.palette.outline)
        x, y = self.camera.to_screen(at)
        r = max(self.style.joint_radius * self.camera.scale, 2.5)
        line = self.mark_outline_px()
        if joint.kind == "fixed":
            corners = [(-r, -r), (r, -r), (r, r), (-r, r)]
            c, s = math.cos(angle), math.sin(angle)
            points = [(x + c * u + s * v, y - s * u + c * v) for u, v in corners]
            draw_list.fill(self.draw, points, outline)
            inner = inset(points, line)
            if inner is not None:
                draw_list.fill(self.draw, inner, self.colour(fill))
            return
        self.draw.add_circle_filled((x, y), r, outline)
        self.draw.add_circle_filled((x, y), max(r - line, 0.0), self.colour(fill))

    def thruster(self, thruster: Thruster, at: Point, angle: float, *, level: float = 1.0) -> None:
        """Draw a thruster's mark.

        Args:
            thruster: The thruster.
            at: Where it is [m].
            angle: Where it pushes, in the world [rad].
            level: How hard it burns, 0 … 1; lengthens the flame.
        """
        size = self.style.thruster_size
        outline = self.colour(self.palette.outline)
        line = self.mark_outline_px()
        flame = self.palette.thruster_bindings[thruster.binding % 2]
        tip = 0.6 + 0.8 * level
        flame_points = [(x if x > 0 else x * tip, y) for x, y in THRUSTER_FLAME]
        for shape, fill in ((flame_points, flame), (THRUSTER_NOZZLE, self.palette.nozzle)):
            points = self.place((*at, angle), [(x * size, y * size) for x, y in shape])
            draw_list.fill(self.draw, points, outline)
            inner = inset(points, line)
            if inner is not None:
                draw_list.fill(self.draw, inner, self.colour(fill))


def _stripes(body: Body, angle: float, period: float, margin: float) -> list[tuple[Point, Point]]:
    """Parallel chords of a body's shape, in its frame [m]."""
    c, s = math.cos(angle), math.sin(angle)
    chords = []
    if isinstance(body.shape, Circle):
        r = body.shape.radius - margin
        for k in range(-int(r / period), int(r / period) + 1):
            offset = k * period
            half = math.sqrt(max(r * r - offset * offset, 0.0))
            x, y = -s * offset, c * offset
            chords.append(((x - c * half, y - s * half), (x + c * half, y + s * half)))
        return chords
    points = inset(body.shape.vertices, margin) or []
    if not points:
        return chords
    across = [-s * x + c * y for x, y in points]
    for k in range(math.ceil(min(across) / period), math.floor(max(across) / period) + 1):
        hits = []
        for i in range(len(points)):
            u, v = across[i - 1] - k * period, across[i] - k * period
            if u * v < 0:
                t = u / (u - v)
                (ax, ay), (bx, by) = points[i - 1], points[i]
                hits.append((ax + t * (bx - ax), ay + t * (by - ay)))
        if len(hits) == 2:
            chords.append((hits[0], hits[1]))
    return chords


def joint_colour(joint: Joint, palette: Palette) -> Rgb:
    """Return colour of a joint's mark: its binding's, or neutral when nothing drives it."""
    if joint.kind == "fixed" or joint.motor is None or not joint.motor.on:
        return palette.uncontrolled
    return palette.motor_bindings[joint.motor.binding]


@dataclasses.dataclass(kw_only=True)
class Placement:
    """Places of everything of a level at one moment."""

    level: Level
    poses: list[Pose]
    index: dict[BodyReference, int] = dataclasses.field(default_factory=dict)

    def __post_init__(self) -> None:
        """Index the bodies by id."""
        self.index = {body.id: k for k, body in enumerate(self.level.bodies)}

    def pose(self, reference: BodyReference) -> Pose | None:
        """Pose of a body or arena body; None when it does not exist."""
        if isinstance(reference, str):
            geometry = getattr(self.level.arena, reference).geometry or STANDARD_ARENA[reference]
            x, y = geometry.position
            return x, y, 0.0
        at = self.index.get(reference)
        return self.poses[at] if at is not None else None

    def point(self, reference: BodyReference, local: Point) -> Point:
        """Return a point of a body's frame in the world [m]."""
        x, y, angle = self.pose(reference) or (0.0, 0.0, 0.0)
        c, s = math.cos(angle), math.sin(angle)
        return x + c * local[0] - s * local[1], y + s * local[0] + c * local[1]

    def joint_point(self, joint: Joint) -> Point:
        """Return the place at which a joint is drawn, by the rule of the renderer [m]."""
        points = (self.point(joint.a, joint.anchor_a), self.point(joint.b, joint.anchor_b))
        return joint_place(*points, end_masses(self.level, joint))

    def angle(self, reference: BodyReference) -> float:
        """Return the angle of a body [rad]."""
        return (self.pose(reference) or (0.0, 0.0, 0.0))[2]


NOTHING: Final[frozenset[int | str]] = frozenset()


def paint_level(
    painter: Painter,
    where: Placement,
    *,
    hidden: Collection[int | str] = NOTHING,
    thrust: Sequence[float] | None = None,
) -> None:
    """Draw a level in the order of `style.DRAW_ORDER`.

    Args:
        painter: Where and how.
        where: The level and its poses.
        hidden: Ids of what is left out.
        thrust: How hard each thruster burns, 0 … 1; None: the mark as it is.
    """
    level = where.level
    painter.floor(level)
    for circles in (False, True):
        for body, pose in zip(level.bodies, where.poses, strict=True):
            if isinstance(body.shape, Circle) is circles and body.id not in hidden:
                painter.body(body, pose)
    for joint in level.joints:
        if joint.id not in hidden:
            painter.joint(joint, where.joint_point(joint), where.angle(joint.a))
    for k, thruster in enumerate(level.thrusters):
        if thruster.id not in hidden:
            painter.thruster(
                thruster,
                where.point(thruster.body, thruster.position),
                where.angle(thruster.body) + thruster.angle,
                level=0.5 if thrust is None else thrust[k],
            )
