"""Planar scenes as models of MuJoCo, for `mujoco` and MJX. See protocol.py.

Bodies slide along x and y and turn about z; boxes are thick and discs are spheres, so contacts stay
in the plane. There is no coefficient of restitution: scenes that bounce cannot be said.
"""

import math
from typing import Any

import mujoco
from protocol import Scene, UnsaidError, both_fixed

DEPTH = 0.5
"""Half the thickness of everything [m]."""
BITS = {"normal": (1, 1 | 2), "always": (2, 1 | 2 | 4), "ghost": (4, 2)}
"""Collision bits of a body, and of its partners. MuJoCo lets two geoms meet when either wants to,
so pairs that must not are excluded one by one."""


def planar_model(scene: Scene, *, timestep: float) -> mujoco.MjModel:
    """The scene's bodies and joints; every free body has three coordinates, in the scene's order.

    Raises:
        UnsaidError: MuJoCo has no words for something in it.
        ValueError: It refuses the model.
    """
    if any(body["restitution"] for body in scene["bodies"]):
        raise UnsaidError("it has no coefficient of restitution")
    if scene["inactive"]:
        raise UnsaidError("bodies cannot be switched off")
    spec = empty_spec(scene, timestep)
    for index, body in enumerate(scene["bodies"]):
        _add_body(spec, index, body)
    _exclude(spec, scene["bodies"])
    for joint in scene["joints"]:
        if not both_fixed(scene, joint):
            _join(spec, scene["bodies"], joint)
    return spec.compile()


def empty_spec(scene: Scene, timestep: float) -> Any:
    """Return a model without bodies: radians, the scene's gravity."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = timestep
    spec.option.gravity = [*scene["gravity"], 0.0]
    return spec


def coordinates(scene: Scene) -> dict[int, int]:
    """Return the index of each free body's first coordinate."""
    free = [index for index, body in enumerate(scene["bodies"]) if body["mass"]]
    return {index: 3 * place for place, index in enumerate(free)}


def starting_speeds(scene: Scene) -> list[float]:
    """The speeds of all coordinates at the start; the coordinates themselves are zero then."""
    free = [body for body in scene["bodies"] if body["mass"]]
    return [speed for body in free for speed in (*body["velocity"], body["angular_velocity"])]


def put_shape(geom: Any, told: dict[str, Any]) -> None:
    """Give a geom the shape of a body: a sphere or a thick box.

    Raises:
        UnsaidError: It is neither a disc nor a box.
    """
    if "radius" in told:
        geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
        geom.size = [told["radius"], 0, 0]
    elif _is_box(told["vertices"]):
        width, height = (max(p[k] for p in told["vertices"]) for k in (0, 1))
        geom.type = mujoco.mjtGeom.mjGEOM_BOX
        geom.size = [width, height, DEPTH]
    else:
        raise UnsaidError("a shape that is neither a disc nor a box")


def turned(vector: list[float], angle: float) -> list[float]:
    """Return a vector (x, y, 0) turned about z."""
    c, s = math.cos(angle), math.sin(angle)
    return [c * vector[0] - s * vector[1], s * vector[0] + c * vector[1], 0.0]


def quaternion(angle: float) -> list[float]:
    """Return the quaternion of a turn about z."""
    return [math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)]


def may_meet(first: dict[str, Any], second: dict[str, Any]) -> bool:
    """Return whether two bodies collide by their modes and groups."""
    same = first["group"] and first["group"] == second["group"]
    modes = {first["collision"], second["collision"]}
    return not same and ("ghost" not in modes or "always" in modes)


def _add_body(spec: Any, index: int, told: dict[str, Any]) -> None:
    body = spec.worldbody.add_body(
        name=f"b{index}", pos=[*told["position"], 0.0], quat=quaternion(told["angle"])
    )
    kind, wants = BITS[told["collision"]]
    geom = body.add_geom(
        friction=[told["friction"], 0.0, 0.0], condim=3, contype=kind, conaffinity=wants
    )
    put_shape(geom, told)
    if told["mass"]:
        body.explicitinertial = True
        body.mass = told["mass"]
        body.inertia = [told["inertia"]] * 3
        body.ipos = [0, 0, 0]
        for axis in ([1, 0, 0], [0, 1, 0]):
            # Axes are those of the body's frame, which is turned at the start.
            own = turned(axis, -told["angle"])
            body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=own)
        body.add_joint(name=f"t{index}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])


def _exclude(spec: Any, bodies: list[dict[str, Any]]) -> None:
    for i, first in enumerate(bodies):
        for j, second in enumerate(bodies[:i]):
            if not may_meet(first, second):
                spec.add_exclude(bodyname1=f"b{i}", bodyname2=f"b{j}")


def _join(spec: Any, bodies: list[dict[str, Any]], told: dict[str, Any]) -> None:
    ends = {
        "name1": f"b{told['a']}",
        "name2": f"b{told['b']}",
        "objtype": mujoco.mjtObj.mjOBJ_BODY,
    }
    if told["weld"]:
        data = _padded([*told["anchor_b"], 0.0, *_relative(told), 1.0])
        spec.add_equality(type=mujoco.mjtEq.mjEQ_WELD, data=data, **ends)
        return
    data = _padded(told["anchor_a"])
    spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, data=data, **ends)
    if told["limits"]:
        _limit(spec, bodies, told)


def _relative(told: dict[str, Any]) -> list[float]:
    """Pose of b in the frame of a, from the anchors and the reference angle."""
    offset = turned([*told["anchor_b"], 0.0], told["reference"])
    x, y = told["anchor_a"][0] - offset[0], told["anchor_a"][1] - offset[1]
    return [x, y, 0.0, *quaternion(told["reference"])]


def _limit(spec: Any, bodies: list[dict[str, Any]], told: dict[str, Any]) -> None:
    """Limits are those of a body's own hinge: sayable where the other body is fixed."""
    if bodies[told["a"]]["mass"]:
        raise UnsaidError("limits between two free bodies")
    hinge = spec.joint(f"t{told['b']}")
    # The hinge's angle counts from the start, the limits from the reference angle.
    start = bodies[told["b"]]["angle"] - bodies[told["a"]]["angle"] - told["reference"]
    hinge.limited = True
    hinge.range = [limit - start for limit in told["limits"]]


def _padded(values: list[float]) -> list[float]:
    """As many numbers as an equality constraint takes."""
    return [*values, *[0.0] * (mujoco.mjNEQDATA - len(values))]


def _is_box(corners: list[list[float]]) -> bool:
    width, height = (max(p[k] for p in corners) for k in (0, 1))
    wanted = {(sx * width, sy * height) for sx in (1, -1) for sy in (1, -1)}
    told = {(x, y) for x, y in corners}
    return len(told) == 4 and told == wanted and width > 0 and height > 0
