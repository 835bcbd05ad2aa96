"""Content of a page: poses over time and facts about each moment, packed small."""

import base64
import dataclasses
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from jaxtyping import Float, Int

from kinetix.level.controls import channels_in_use, names_driven_by
from kinetix.level.geometry import arena_bodies
from kinetix.level.model import (
    MOTOR_BINDINGS,
    THRUSTER_BINDINGS,
    Body,
    Circle,
    Joint,
    Level,
)
from kinetix.render.palette import KINETIX, ROLE_NAMES, Rgb

MILLIMETRES: Final = 1000.0
"""Positions are whole millimetres in 16 bits: ±32 m."""
TURN: Final = 65536 / (2 * np.pi)
"""Angles are 1/65536 of a turn in 32 bits, not wrapped: fast wheels turn often between moments."""
MOST_BYTES: Final = 600_000
"""Of one film before base64, half of it for poses: beyond it moments are left out."""
_ROW_BYTES: Final = 14
"""Of a moment without its poses: time, six controls, value, entropy."""
_POSE_BYTES: Final = 8
"""Size of the pose of one body."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Film:
    """One player's episode. Axis `k` is time with the start, `b` the level's bodies in order."""

    level: Level
    title: str
    """Name of the player or of the scene."""
    seconds: Float[np.ndarray, " k"]
    """Times of the moments [s]."""
    position: Float[np.ndarray, "k b 2"]
    """Of the bodies, as snapshots and runs have them [m]."""
    angle: Float[np.ndarray, "k b"]
    """Angles of the bodies [rad]."""
    actions: Float[np.ndarray, "k 6"] | None = None
    """Controls in the step before each moment: −1 … 1 per motor, 0 … 1 per thruster."""
    value: Float[np.ndarray, " k"] | None = None
    """Expected return of the agent; NaN where nothing is known."""
    entropy: Float[np.ndarray, " k"] | None = None
    """Entropy of its policy [nat]."""
    outcome: str = ""
    """See `kinetix.environment.outcome.Outcome`; empty where it has not ended."""
    facts: tuple[tuple[str, str], ...] = ()
    """Physics, seed, mode and the like, to be read below the film."""


def scene_of(level: Level) -> dict[str, Any]:
    """Return what a page draws that does not move: shapes, colours, joints, thrusters."""
    index = {body.id: k for k, body in enumerate(level.bodies)}
    return {
        "name": level.name,
        "bodies": [_shape(body) for body in level.bodies],
        "arena": [
            {**_shape(body), "at": [*body.position, body.angle]}
            for body in arena_bodies(level.arena)
            if body.collision != "ghost"
        ],
        "joints": [_joint(joint, index) for joint in level.joints],
        "thrusters": [
            {
                "body": index[thruster.body],
                "at": list(thruster.position),
                "angle": thruster.angle,
                "power": thruster.power,
                "channel": MOTOR_BINDINGS + thruster.binding,
                "colour": _css(KINETIX.thruster_bindings[thruster.binding]),
            }
            for thruster in level.thrusters
            if thruster.body in index
        ],
        "controls": list(channels_in_use(level)),
        "names": {
            channel: ", ".join(names)
            for channel in channels_in_use(level)
            if (names := names_driven_by(level, channel))
        },
    }


def packed(film: Film) -> dict[str, Any]:
    """Return a film as JSON values, its arrays as base64 of small integers.

    Bodies that never move have one pose, the others one for each of the moments in `shown`; times,
    controls and values are stored for every moment.
    """
    count = len(film.seconds)
    rows = _spread(count, MOST_BYTES // 2 // _ROW_BYTES)
    poses = _whole(film)[rows]
    moving = np.flatnonzero((poses != poses[:1]).any(axis=(0, 2)))
    shown = _spread(len(rows), MOST_BYTES // 2 // (_POSE_BYTES * max(len(moving), 1)))
    moved = poses[shown][:, moving]
    return {
        "title": film.title,
        "outcome": film.outcome,
        "facts": [*film.facts, *_left_out(count, len(shown))],
        "count": len(rows),
        "seconds": _base64(np.rint(film.seconds[rows] * 1000), "<u4"),
        "start": poses[0].tolist(),
        "moving": moving.tolist(),
        "shown": _base64(shown, "<u4"),
        "places": _base64(moved[..., :2], "<i2"),
        "angles": _base64(moved[..., 2], "<i4"),
        "actions": None if film.actions is None else _base64(_controls(film.actions[rows]), "<i1"),
        "value": _curve(film.value, rows),
        "entropy": _curve(film.entropy, rows),
    }


def _spread(count: int, most: int) -> Int[np.ndarray, " r"]:
    """Return about `most` of `count` rows, evenly spread, with the first and the last."""
    stride = max(1, -(-count // max(most, 1)))
    return np.unique(np.append(np.arange(0, count, stride), count - 1))


def _left_out(count: int, shown: int) -> list[tuple[str, str]]:
    """Return the message where a page lacks poses."""
    if shown == count:
        return []
    return [("left out", f"{count - shown} of {count} moments; between others bodies move evenly")]


def _whole(film: Film) -> Int[np.ndarray, "k b 3"]:
    """Return the poses as whole millimetres and parts of a turn."""
    poses = _last_known(np.concatenate([film.position, film.angle[..., None]], axis=-1))
    poses = np.rint(np.nan_to_num(poses * [MILLIMETRES, MILLIMETRES, TURN]))
    poses[..., :2] = np.clip(poses[..., :2], -32767, 32767)
    poses[..., 2] = np.clip(poses[..., 2], -(2**31) + 1, 2**31 - 1)
    return poses.astype(np.int64)


def _last_known(poses: Float[np.ndarray, "k b 3"]) -> Float[np.ndarray, "k b 3"]:
    """Return poses in which a body that is NaN stays where it was last."""
    moment = np.arange(len(poses))[:, None]
    known = np.where(np.isfinite(poses).all(axis=-1), moment, 0)
    return np.take_along_axis(poses, np.maximum.accumulate(known)[..., None], axis=0)


def _controls(actions: Float[np.ndarray, "k u"]) -> Float[np.ndarray, "k 6"]:
    """Hundredths, as many controls as a page knows."""
    wide = np.zeros((len(actions), MOTOR_BINDINGS + THRUSTER_BINDINGS))
    wide[:, : actions.shape[1]] = actions[:, : wide.shape[1]]
    return np.rint(np.clip(wide, -1, 1) * 100)


def _curve(values: np.ndarray | None, rows: np.ndarray) -> str | None:
    if values is None or not np.isfinite(values).any():
        return None
    kept = values[rows]
    # The lowest number means that nothing is known.
    return _base64(np.where(np.isfinite(kept), np.clip(kept * 1000, -32767, 32767), -32768), "<i2")


def _base64(values: Any, kind: str) -> str:
    return base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode()


def _shape(body: Body) -> dict[str, Any]:
    fill = KINETIX.fill(ROLE_NAMES.index(body.role), body.fixed)
    shape: dict[str, Any] = {"fill": _css(fill)}
    if isinstance(body.shape, Circle):
        return shape | {"radius": body.shape.radius}
    return shape | {"corners": [list(corner) for corner in body.shape.vertices]}


def _joint(joint: Joint, index: dict[int, int]) -> dict[str, Any]:
    motor = joint.motor
    driven = joint.kind == "revolute" and motor is not None and motor.on
    colour = KINETIX.uncontrolled
    if driven and motor is not None and not motor.auto:
        colour = KINETIX.motor_bindings[motor.binding]
    side = joint.a if joint.a in index else joint.b
    return {
        "body": index.get(side, -1) if isinstance(side, int) else -1,
        "at": list(joint.anchor_a if side == joint.a else joint.anchor_b),
        "weld": joint.kind == "fixed",
        "colour": _css(colour),
        "channel": motor.binding if driven and motor is not None and not motor.auto else -1,
        "way": -1 if motor is not None and motor.speed < 0 else 1,
    }


def _css(colour: Rgb | Sequence[int]) -> str:
    red, green, blue = colour
    return f"#{red:02x}{green:02x}{blue:02x}"
