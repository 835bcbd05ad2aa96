"""Overlays of a playing agent: its actions, its network's outputs, a second player."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from imgui_bundle import imgui

from editor.base.camera import Point
from editor.base.controls import Drive, key_caps
from editor.base.language import tr
from editor.documents.commands.bodies import posed
from editor.drawing.futures_overlay import futures_of, outlook
from editor.drawing.strokes import arrow
from editor.drawing.vectors import Painter, Placement, poses_of
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons, Rgba, alpha, u32
from editor.toolkit.widgets import broken, font, px
from editor.worker.snapshots import Snapshot
from kinetix.level.controls import channels_in_use
from kinetix.level.model import MOTOR_BINDINGS, Circle, Level

if TYPE_CHECKING:
    from editor.session import Session


GHOST_OPACITY: Final = 0.45
"""Of the second player's level in ghost compare."""
_SAME: Final = 1e-3
"""A body that is this near to the first player's is not drawn twice [m and rad]."""
_FORWARD: Final[Rgba] = (0.84, 0.19, 0.15, 1.0)
"""Leans to +1: counter-clockwise, or burning."""
_BACKWARD: Final[Rgba] = (0.13, 0.40, 0.75, 1.0)
"""Leans to −1."""
_NEUTRAL: Final[Rgba] = (0.95, 0.95, 0.95, 1.0)
_AT_REST: Final[Rgba] = (0.45, 0.48, 0.54, 1.0)
_WIDTH: Final = 214.0
_APART: Final = "    "
_LEAST: Final = 128.0
"""In less room beside the arena the plate stands over it, or nowhere [px at 100 %]."""


_NAME: Final = 56.0
"""Width of what a bar is called [px at 100 %]."""
_NUMBER: Final = 46.0
_UNDER: Final = 13.0
"""Height that a bar under its name takes [px at 100 %]."""
_BAR: Final = 60.0
"""A bar that is no longer beside its name and number stands under them [px at 100 %]."""


RING: Final = 22.0
"""Radius of the ring on a joint with its arrow [px at 100 %]."""


def lean_colour(value: float) -> Rgba:
    """Return a diverging scale: −1 blue, 0 white, +1 red."""
    end = _FORWARD if value > 0 else _BACKWARD
    share = min(abs(value), 1.0)
    red, green, blue = (
        (1 - share) * a + share * b for a, b in zip(_NEUTRAL[:3], end[:3], strict=True)
    )
    return red, green, blue, 1.0


def paint_heat(painter: Painter, where: Placement, snapshot: Snapshot) -> None:
    """A ring on every joint and thruster that the agent drives: where its policy leans.

    The ring's colour is the expected action, the arrow what was chosen.

    Args:
        painter: Where to draw.
        where: The level and its poses.
        snapshot: The moment; without a mind nothing is drawn.
    """
    mind = snapshot.mind
    if mind is None:
        return
    draw, camera = painter.draw, painter.camera
    for k, joint in enumerate(where.level.joints):
        motor = joint.motor
        if joint.kind != "revolute" or motor is None or not motor.on or motor.auto:
            continue
        centre = camera.to_screen(where.joint_point(joint))
        _ring(draw, centre, px(12), mind.intention[motor.binding])
        _turn_arrow(draw, centre, px(12), float(snapshot.motor[k]) * _sign(motor.speed))
    for k, thruster in enumerate(where.level.thrusters):
        at = where.point(thruster.body, thruster.position)
        centre = camera.to_screen(at)
        _ring(draw, centre, px(9), mind.intention[MOTOR_BINDINGS + thruster.binding])
        if snapshot.thruster[k] > 0.05:
            angle = where.angle(thruster.body) + thruster.angle
            tip = _along(centre, angle, px(30) * float(snapshot.thruster[k]))
            arrow(draw, centre, tip, u32(_FORWARD), px(3), px(10))


def _sign(value: float) -> float:
    return -1.0 if value < 0 else 1.0


def _along(start: Point, angle: float, length: float) -> Point:
    return start[0] + math.cos(angle) * length, start[1] - math.sin(angle) * length


def _ring(draw: imgui.ImDrawList, centre: Point, radius: float, lean: float) -> None:
    draw.add_circle(centre, radius, u32((0.05, 0.06, 0.08, 0.85)), 0, px(6))
    draw.add_circle(centre, radius, u32(lean_colour(lean)), 0, px(3.5))


def _turn_arrow(draw: imgui.ImDrawList, centre: Point, radius: float, turn: float) -> None:
    """A bent arrow: the way in which the motor drives; none while it rests."""
    if abs(turn) < 0.05:
        return
    r = radius + px(7)
    colour = u32(_FORWARD if turn > 0 else _BACKWARD)
    # On the screen y points down, so counter-clockwise is a falling angle.
    start, end = (0.6, -1.5) if turn > 0 else (-0.6, 1.5)
    draw.path_arc_to(centre, r, start - math.pi / 2, end - math.pi / 2, 18)
    draw.path_stroke(colour, px(3))
    at = end - math.pi / 2
    tip = (centre[0] + r * math.cos(at), centre[1] + r * math.sin(at))
    along = -1.0 if turn > 0 else 1.0
    ahead = (tip[0] - along * math.sin(at) * px(9), tip[1] + along * math.cos(at) * px(9))
    arrow(draw, tip, ahead, colour, px(3), px(9))


def paint_ghost(painter: Painter, level: Level, solid: Snapshot, snapshot: Snapshot) -> None:
    """The second player's bodies, half transparent, where they are not the first one's.

    Args:
        painter: Where to draw; its opacity is changed for it.
        level: The level.
        solid: The first player's moment.
        snapshot: The second player's moment.
    """
    moved = np.hypot(*(snapshot.position - solid.position).T) + np.abs(snapshot.angle - solid.angle)
    apart = (moved > _SAME).tolist()
    scene = posed(level, snapshot)
    where = Placement(level=scene, poses=poses_of(scene))
    before, painter.opacity = painter.opacity, GHOST_OPACITY
    for circles in (False, True):
        for body, pose, visible in zip(scene.bodies, where.poses, apart, strict=True):
            if isinstance(body.shape, Circle) is circles and visible:
                painter.body(body, pose)
    painter.opacity = before


@dataclasses.dataclass(frozen=True, kw_only=True)
class Room:
    """Room for the plate around its player's arena."""

    beside: float
    """Width between the arena and the right edge of the player's part of the canvas [px]."""
    across: float
    """Width between what else is said of the episode and that edge [px]."""
    above: float
    """Height between the arena and the plate's upper edge, negative where it begins lower [px]."""
    over: float
    """Height of a plate that stands over the arena [px]."""


def paint_numbers(session: "Session", draw: imgui.ImDrawList, corner: Point, *, room: Room) -> None:
    """A plate with who plays, what it expects, how sure it is, and the other player beside it.

    Args:
        session: The app.
        draw: Where to draw.
        corner: Upper right corner of the plate [px].
        room: The plate is made narrower for the width beside the arena, within reason, else lower
            for the height above it; where it has to stand over the arena it has fewer bars, so that
            it covers a part of it alone, or is left out.
    """
    playback = session.playback
    snapshot = playback.snapshot
    if snapshot is None:
        return
    rival = session.viewer.rival
    other = rival.shown(playback.engine_step) if rival.active else None
    if snapshot.mind is None and other is None and playback.casting is None:
        return
    lines: list[tuple[str, Rgba]] = []
    who = playback.player or "You"
    if session.viewer.other_physics:
        who = f"{who}, {playback.played_under}"
    draws = ""
    if playback.casting is not None:
        casting = playback.casting
        draws = "likeliest actions" if casting.deterministic else f"attempt {casting.attempt}"
        draws = f"{draws}, seed {casting.seed}"
    lines.append((f"{who}{_APART}return {snapshot.total_reward:+.2f}", COLOURS.text))
    if draws:
        lines.append((draws, COLOURS.muted))
    futures = futures_of(snapshot)
    if futures is not None:
        lines.append((outlook(futures), COLOURS.info))
    if other is not None:
        difference = snapshot.total_reward - other.total_reward
        sign = Icons.worse if difference > 0.005 else Icons.better if difference < -0.005 else "="
        ended = f"  {other.outcome}" if other.outcome else ""
        words = f"{rival.player}{_APART}return {other.total_reward:+.2f}{ended}   {sign}"
        lines.append((words, COLOURS.info))
    elif rival.waiting:
        lines.append((f"{rival.player}{_APART}preparing …", COLOURS.info))
    level = playback.level
    controls = channels_in_use(level) if level is not None else ()
    peak = max((abs(m.mind.value) for m in playback.moments if m.mind is not None), default=0.0)
    facts = _Facts(controls=controls, keys=session.control_keys, most_value=value_range(peak))
    _plate(draw, lines, snapshot, facts, corner, room)


def value_range(peak: float) -> float:
    """Return the end of the value bar: at least 1, and beyond the largest value of the episode."""
    return max(1.0, math.ceil(2 * peak) / 2)


def most_entropy(controls: Sequence[int]) -> float:
    """Return the entropy of a policy that draws all of some controls evenly [nat]."""
    return sum(math.log(3 if k < MOTOR_BINDINGS else 2) for k in controls)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Facts:
    """Values that the bars of the plate show."""

    controls: tuple[int, ...]
    keys: Mapping[str, Drive]
    most_value: float


def _plate(
    draw: imgui.ImDrawList,
    lines: list[tuple[str, Rgba]],
    snapshot: Snapshot,
    facts: _Facts,
    corner: Point,
    room: Room,
) -> None:
    mind = snapshot.mind
    thinks = mind is not None and not mind.scripted
    controls = facts.controls if thinks and mind is not None and mind.chances else ()
    bars = 1 + bool(facts.controls) + len(controls) if thinks else 0
    by_hand = mind is not None and mind.by_hand
    right, top = corner
    lines = [(tr(words), colour) for words, colour in lines]
    if by_hand:
        lines.insert(0, (tr("You drive; the agent only watches"), COLOURS.warn))
    with font(FONTS.regular, SMALL):
        step = imgui.get_text_line_height() + px(4)
        wide = max([imgui.calc_text_size(words).x for words, _ in lines] + [px(_WIDTH)]) + px(20)
        beside = room.beside >= px(_LEAST)
        wide = min(wide, room.beside if beside else room.across)
        if wide < px(_LEAST):
            return
        lines = [(part, c) for words, c in lines for part in _fitted(words, wide - px(20))]
        row = step if wide - px(20) >= px(_NAME + _BAR + _NUMBER) else step + px(_UNDER)
        if not beside:
            words = len(lines) * step + px(14)
            tall = room.above if words <= room.above else room.over
            if words > tall:
                return
            bars = min(bars, int((tall - words) / row))
        height = len(lines) * step + bars * row + px(14)
        low, high = (right - wide, top), (right, top + height)
        draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.93)), px(7))
        draw.add_rect(low, high, u32(COLOURS.line), px(7))
        x, y = low[0] + px(10), low[1] + px(8)
        for words, colour in lines:
            draw.add_text((x, y), u32(colour), words)
            y += step
        if not thinks or mind is None:
            return
        for index in range(bars):
            place = _Row(left=x, right=high[0] - px(10), top=y, under=row > step)
            if index == 0:
                _bar(draw, place, "value", mind.value, (-facts.most_value, facts.most_value))
            elif index == 1:
                _bar(draw, place, "entropy", mind.entropy, (0.0, most_entropy(facts.controls)))
            else:
                channel = controls[index - 2]
                caps = " ".join(key_caps(channel, facts.keys))
                _chances(draw, place, caps, mind.chances[channel], mind.own_action[channel])
            y += row


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Row:
    """Place of a bar with its name and its number."""

    left: float
    right: float
    top: float
    under: bool
    """True if the bar stands under its name, in all of the width."""

    def write(self, draw: imgui.ImDrawList, name: str, number: str) -> None:
        """Write the name at the left and the number at the right."""
        draw.add_text((self.left, self.top), u32(COLOURS.muted), tr(name))
        size = imgui.calc_text_size(number)
        draw.add_text((self.right - size.x, self.top), u32(COLOURS.text), number)

    def bar(self) -> tuple[float, float, float]:
        """Return where the bar begins, where it ends, and its middle line."""
        line = imgui.get_text_line_height()
        if self.under:
            return self.left, self.right, self.top + line + px(_UNDER / 2)
        return self.left + px(_NAME), self.right - px(_NUMBER), self.top + line / 2


def _fitted(words: str, room: float) -> list[str]:
    """Break a line that is too long [px]: first where its parts stand apart."""
    if imgui.calc_text_size(words).x <= room:
        return [words]
    return broken(words.replace(_APART, "\n"), room)


def _chances(
    draw: imgui.ImDrawList,
    place: _Row,
    label: str,
    chances: tuple[float, float, float],
    chosen: float,
) -> None:
    """A control's probabilities side by side: backward, at rest, forward; the chosen one marked."""
    left, right, middle = place.bar()
    at = left
    sign = (chosen > 0) - (chosen < 0)
    number = ""
    for way, chance, colour in zip((-1, 0, 1), chances, _WAYS, strict=True):
        end = at + (right - left) * chance
        draw.add_rect_filled((at, middle - px(4)), (end, middle + px(4)), u32(colour))
        if way == sign:
            draw.add_rect_filled((at, middle + px(5)), (end, middle + px(7)), u32(COLOURS.text))
            number = f"{chance:.2f}"
        at = end
    place.write(draw, label, number)


_WAYS: Final = (_BACKWARD, _AT_REST, _FORWARD)


def _bar(
    draw: imgui.ImDrawList,
    place: _Row,
    label: str,
    value: float,
    limits: tuple[float, float],
) -> None:
    """A number with its place between two limits."""
    left, right, middle = place.bar()
    low, high = limits
    zero = left + (right - left) * (0.0 - low) / (high - low)
    at = left + (right - left) * (min(max(value, low), high) - low) / (high - low)
    draw.add_rect_filled((left, middle - px(4)), (right, middle + px(4)), u32(COLOURS.field), px(3))
    colour = COLOURS.info if label == "entropy" else COLOURS.good if value >= 0 else COLOURS.bad
    draw.add_rect_filled(
        (min(zero, at), middle - px(4)), (max(zero, at), middle + px(4)), u32(colour), px(3)
    )
    place.write(draw, label, f"{value:+.2f}" if low < 0 else f"{value:.2f}")


def paint_reason(
    draw: imgui.ImDrawList, area: tuple[Point, Point], title: str, reason: str
) -> None:
    """A plate in the upper middle that says why play stands still.

    Args:
        draw: Where to draw.
        area: Upper left corner and size of the canvas [px].
        title: The head line.
        reason: The sentence.
    """
    (x, y), (width, _) = area
    with font(FONTS.regular, SMALL + 1):
        title = tr(title)
        lines = broken(tr(reason), min(width - px(80), px(560)))
        step = imgui.get_text_line_height() + px(3)
        wide = max(imgui.calc_text_size(line).x for line in [title, *lines]) + px(32)
        low = (x + (width - wide) / 2, y + px(56))
        high = (low[0] + wide, low[1] + step * (len(lines) + 1) + px(20))
        draw.add_rect_filled(low, high, u32(alpha(COLOURS.backdrop, 0.94)), px(8))
        draw.add_rect(low, high, u32(COLOURS.bad), px(8), px(2))
        top = low[1] + px(10)
        for line, colour in [(title, COLOURS.bad), *((line, COLOURS.text) for line in lines)]:
            draw.add_text((low[0] + px(16), top), u32(colour), line)
            top += step
