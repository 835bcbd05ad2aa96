"""Debug drawing: what the simulation knows and the picture does not show, layer by layer."""

import dataclasses
import math
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.drawing.strokes import Room, arrow, dashed
from editor.drawing.vectors import Painter, Placement, pack
from editor.play.impulses import received_impulses
from editor.toolkit import draw_list
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Rgba, alpha, u32
from editor.toolkit.widgets import font, px
from editor.worker.snapshots import Snapshot
from kinetix.level.graph import components, may_push, pieces
from kinetix.level.model import Circle, Joint

if TYPE_CHECKING:
    from editor.session import Session


LAYERS: Final[dict[str, str]] = {
    "ids": "Names",
    "aabbs": "Bounding boxes",
    "centres": "Centres of mass",
    "velocities": "Velocities",
    "trails": "Trails",
    "contacts": "Contacts",
    "normals": "Contact normals",
    "penetration": "Penetration",
    "impulses": "Impulses received",
    "anchors": "Joint anchors and error",
    "limits": "Joint limits",
    "motors": "Motor drive",
    "thrust": "Thruster force",
    "groups": "Collision groups",
    "matrix": "Collision matrix",
}
"""Names in the settings and what the switches say."""

SIMULATED: Final = frozenset(
    {"trails", "contacts", "normals", "penetration", "impulses", "motors", "thrust"}
)
"""Those that show nothing before a simulation runs."""

_VELOCITY_SECONDS: Final = 0.15
"""An arrow is as long as the way in this time."""
_TRAIL_STATES: Final = 120
_LEAST_IMPULSE: Final = 1e-3
"""Less is not drawn [N s]."""
_IMPULSE_LENGTH: Final = 0.6
"""Length of the arrow of 1 N s [m]."""
_MATRIX_MOST: Final = 40
"""With more bodies the table would fill the canvas."""
_BLUE: Final[Rgba] = (0.10, 0.45, 0.95, 1.0)
_PINK: Final[Rgba] = (0.90, 0.15, 0.50, 1.0)
_ORANGE: Final[Rgba] = (0.95, 0.45, 0.05, 1.0)
_GROUPS: Final = (
    (230, 120, 40),
    (40, 130, 220),
    (150, 70, 200),
    (20, 150, 120),
    (200, 50, 90),
    (120, 120, 20),
)


def paint_debug(session: "Session", painter: Painter, where: Placement) -> None:
    """Draw every layer that is switched on.

    Args:
        session: Its settings name the layers; its playback has the simulated values.
        painter: Where to draw.
        where: The level and its poses.
    """
    snapshot = session.playback.snapshot if session.playback.active else None
    pen = _Pen(painter=painter, where=where, snapshot=snapshot)
    ring = session.playback.ring.newest(_TRAIL_STATES) if snapshot is not None else ()
    for name in session.settings.debug_draw:
        if name == "trails":
            pen.trails(ring)
        elif name == "impulses":
            pen.impulses(ring[-2:])
        elif name in LAYERS and (snapshot is not None or name not in SIMULATED):
            getattr(pen, name)()


@dataclasses.dataclass(kw_only=True)
class _Pen:
    """One method a layer."""

    painter: Painter
    where: Placement
    snapshot: Snapshot | None
    room: Room = dataclasses.field(default_factory=Room)
    """Labels that would cover another one are left out: zooming in shows them."""

    @property
    def draw(self) -> imgui.ImDrawList:
        return self.painter.draw

    def _at(self, point: Point) -> Point:
        return self.painter.camera.to_screen(point)

    def ids(self) -> None:
        with font(FONTS.mono, SMALL):
            for body, pose in zip(self.where.level.bodies, self.where.poses, strict=True):
                x, y = self._at((pose[0], pose[1]))
                words = body.name or f"#{body.id}"
                size = imgui.calc_text_size(words)
                low = (x - size.x / 2 - px(3), y + px(6))
                high = (x + size.x / 2 + px(3), y + size.y + px(8))
                if not self.room.take(low, high):
                    continue
                self.draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.85)), px(3))
                self.draw.add_text((low[0] + px(3), low[1]), u32(COLOURS.text), words)

    def aabbs(self) -> None:
        for body, pose in zip(self.where.level.bodies, self.where.poses, strict=True):
            if isinstance(body.shape, Circle):
                r = body.shape.radius
                low = self._at((pose[0] - r, pose[1] + r))
                high = self._at((pose[0] + r, pose[1] - r))
            else:
                points = self.painter.place(pose, body.shape.vertices)
                low = (min(x for x, _ in points), min(y for _, y in points))
                high = (max(x for x, _ in points), max(y for _, y in points))
            self.draw.add_rect(low, high, u32(alpha(_BLUE, 0.8)), 0.0, px(1))

    def centres(self) -> None:
        r = px(5)
        for pose in self.where.poses:
            x, y = self._at((pose[0], pose[1]))
            colour = u32(_PINK)
            self.draw.add_circle((x, y), r, colour, 0, px(1.5))
            self.draw.add_line((x - r, y), (x + r, y), colour, px(1.5))
            self.draw.add_line((x, y - r), (x, y + r), colour, px(1.5))

    def velocities(self) -> None:
        for body, pose in zip(self.where.level.bodies, self.where.poses, strict=True):
            vx, vy = body.velocity
            if math.hypot(vx, vy) < 1e-3:
                continue
            tip = (pose[0] + vx * _VELOCITY_SECONDS, pose[1] + vy * _VELOCITY_SECONDS)
            start = self._at((pose[0], pose[1]))
            arrow(self.draw, start, self._at(tip), u32(_BLUE), px(2), px(9))

    def trails(self, states: tuple[Snapshot, ...]) -> None:
        if len(states) < 2:
            return
        for index, body in enumerate(self.where.level.bodies):
            if body.fixed:
                continue
            points = [self._at(tuple(state.position[index].tolist())) for state in states]
            draw_list.stroke(self.draw, points, u32(alpha(_PINK, 0.7)), px(1.5))

    def contacts(self) -> None:
        assert self.snapshot is not None
        for contact in self.snapshot.contacts:
            self.draw.add_circle_filled(self._at(contact.at), px(4), u32(_ORANGE))

    def normals(self) -> None:
        assert self.snapshot is not None
        for contact in self.snapshot.contacts:
            x, y = self._at(contact.at)
            nx, ny = contact.normal
            tip = (x + nx * px(24), y - ny * px(24))
            arrow(self.draw, (x, y), tip, u32(_ORANGE), px(1.75), px(8))

    def penetration(self) -> None:
        assert self.snapshot is not None
        with font(FONTS.mono, SMALL - 1):
            for contact in self.snapshot.contacts:
                if contact.separation < -1e-4:
                    x, y = self._at(contact.at)
                    words = f"{-contact.separation * 1000:.1f} mm"
                    size = imgui.calc_text_size(words)
                    low = (x + px(6), y - px(16))
                    if not self.room.take(low, (low[0] + size.x, low[1] + size.y)):
                        continue
                    self.draw.add_text((x + px(6), y - px(16)), u32(COLOURS.bad), words)

    def impulses(self, states: tuple[Snapshot, ...]) -> None:
        """Draw the impulse of contacts and joints on each body in the last step, with its size."""
        level = self.where.level
        if len(states) < 2 or states[1].step != states[0].step + 1:
            return
        received = received_impulses(level, states[0], states[1])
        with font(FONTS.mono, SMALL - 1):
            for pose, impulse in zip(self.where.poses, received, strict=True):
                size = math.hypot(*impulse) if impulse is not None else 0.0
                if impulse is None or size < _LEAST_IMPULSE:
                    continue
                # The square root keeps a touch and a crash on one screen.
                length = _IMPULSE_LENGTH * math.sqrt(size)
                tip = (
                    pose[0] + impulse[0] / size * length,
                    pose[1] + impulse[1] / size * length,
                )
                end = self._at(tip)
                arrow(self.draw, self._at((pose[0], pose[1])), end, u32(_PINK), px(2.5), px(9))
                words = f"{size:.2g} Ns"
                low, room = (end[0] + px(5), end[1] - px(8)), imgui.calc_text_size(words)
                high = (low[0] + room.x + px(6), low[1] + room.y + px(2))
                if not self.room.take(low, high):
                    continue
                self.draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.85)), px(3))
                self.draw.add_text((low[0] + px(3), low[1] + px(1)), u32(COLOURS.text), words)

    def anchors(self) -> None:
        for joint in self.where.level.joints:
            a = self._at(self.where.point(joint.a, joint.anchor_a))
            b = self._at(self.where.point(joint.b, joint.anchor_b))
            self.draw.add_circle(a, px(4), u32(_BLUE), 0, px(1.5))
            self.draw.add_circle(b, px(6), u32(_PINK), 0, px(1.5))
            if math.dist(a, b) > 1.0:
                self.draw.add_line(a, b, u32(COLOURS.bad), px(2))
            for end, body in ((a, joint.a), (b, joint.b)):
                pose = None if isinstance(body, str) else self.where.pose(body)
                if pose is not None:
                    centre = self._at((pose[0], pose[1]))
                    dashed(self.draw, (end, centre), u32(alpha(_BLUE, 0.6)), px(1), closed=False)

    def limits(self) -> None:
        for joint in self.where.level.joints:
            limits = joint.limits
            if joint.kind == "fixed" or limits is None or not limits.on:
                continue
            self._wedge(joint, limits.min, limits.max)

    def _wedge(self, joint: Joint, low: float, high: float) -> None:
        centre = self._at(self.where.joint_point(joint))
        base = self.where.angle(joint.a) + joint.reference_angle
        now = self.where.angle(joint.b)
        r = px(34)
        self.draw.path_clear()
        self.draw.path_line_to(centre)
        self.draw.path_arc_to(centre, r, -(base + low), -(base + high), 24)
        self.draw.path_fill_concave(u32(alpha(_BLUE, 0.18)))
        self.draw.path_arc_to(centre, r, -(base + low), -(base + high), 24)
        self.draw.path_stroke(u32(_BLUE), px(1.5))
        tip = (centre[0] + r * math.cos(now), centre[1] - r * math.sin(now))
        inside = low <= now - base <= high
        self.draw.add_line(centre, tip, u32(_BLUE if inside else COLOURS.bad), px(2))

    def motors(self) -> None:
        assert self.snapshot is not None
        for joint, drive in zip(self.where.level.joints, self.snapshot.motor.tolist(), strict=True):
            if joint.motor is None or abs(drive) < 1e-3:
                continue
            centre = self._at(self.where.joint_point(joint))
            r, turn = px(16), math.copysign(0.5 + 2.0 * abs(drive), drive * joint.motor.speed)
            self.draw.path_arc_to(centre, r, math.pi / 2, math.pi / 2 - turn, 20)
            self.draw.path_stroke(u32(_ORANGE), px(2.5))
            end = math.pi / 2 - turn
            tip = (centre[0] + r * math.cos(end), centre[1] + r * math.sin(end))
            along = -math.copysign(1.0, turn)
            ahead = (
                tip[0] - along * math.sin(end) * px(8),
                tip[1] + along * math.cos(end) * px(8),
            )
            arrow(self.draw, tip, ahead, u32(_ORANGE), px(2), px(8))

    def thrust(self) -> None:
        assert self.snapshot is not None
        for thruster, drive in zip(
            self.where.level.thrusters, self.snapshot.thruster.tolist(), strict=True
        ):
            if drive < 1e-3:
                continue
            at = self.where.point(thruster.body, thruster.position)
            angle = self.where.angle(thruster.body) + thruster.angle
            length = 0.3 * thruster.power * drive
            tip = (at[0] + length * math.cos(angle), at[1] + length * math.sin(angle))
            arrow(self.draw, self._at(at), self._at(tip), u32(_ORANGE), px(3), px(11))

    def groups(self) -> None:
        """Bodies that never push each other (one jointed component) get one colour."""
        for number, group in enumerate(pieces(self.where.level, self.where.level.joints)):
            if len(group) < 2:
                continue
            colour = pack(_GROUPS[number % len(_GROUPS)], 0.9)
            for body_id in group:
                pose = self.where.pose(body_id)
                if pose is not None:
                    at = self._at((pose[0], pose[1]))
                    self.draw.add_circle(at, px(9), colour, 0, px(3))

    def matrix(self) -> None:
        """Draw the pairs of bodies that can push each other as a table in the corner."""
        level = self.where.level
        bodies = [(body.id, body) for body in level.bodies]
        count = len(bodies)
        if not 2 <= count <= _MATRIX_MOST:
            return
        component = components(level.joints)
        side, edge = px(11), px(26)
        left, bottom = self.draw.get_clip_rect_min().x + px(14), self.draw.get_clip_rect_max().y
        top = bottom - px(14) - count * side
        low = (left - px(4), top - edge + px(4))
        high = (left + edge + count * side + px(6), bottom - px(8))
        self.draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.95)), px(5))
        with font(FONTS.mono, 9):
            for k, (body_id, _) in enumerate(bodies):
                words = str(body_id)
                size = imgui.calc_text_size(words)
                row, column = top + k * side, left + edge + k * side
                at = (left + edge - size.x - px(3), row + (side - size.y) / 2)
                self.draw.add_text(at, u32(COLOURS.muted), words)
                at = (column + (side - size.x) / 2, top - size.y - px(2))
                self.draw.add_text(at, u32(COLOURS.muted), words)
        for i, a in enumerate(bodies):
            for j, b in enumerate(bodies):
                if i == j:
                    continue
                x, y = left + edge + j * side, top + i * side
                box = ((x + px(1), y + px(1)), (x + side - px(1), y + side - px(1)))
                pushes = may_push(a, b, component)
                colour = alpha(COLOURS.good, 0.9) if pushes else COLOURS.field
                self.draw.add_rect_filled(*box, u32(colour), px(2))
