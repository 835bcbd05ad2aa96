"""MuJoCo (package `mujoco`): planar scenes in its own words. See protocol.py.

Bodies slide along x and y and turn about z; boxes are thick and discs are spheres, so contacts stay
in the plane. It has no coefficient of restitution: scenes that bounce cannot be said.

Settings: `substeps`.
"""

import math
from typing import Any

import mujoco
import numpy as np
from protocol import (
    THRUSTER_POWER,
    Scene,
    UnsaidError,
    axial_inertia,
    both_fixed,
    motor_law,
    serve,
)

DEPTH = 0.5
"""Half the thickness of everything [m]."""
BITS = {"normal": (1, 1 | 2), "always": (2, 1 | 2 | 4), "ghost": (4, 2)}
"""What a body is, and what it collides with. MuJoCo lets two geoms meet when either wants to, so
pairs that must not are excluded one by one."""


class MujocoWorld:
    """One scene."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Build and compile the model."""
        if any(body["restitution"] for body in scene["bodies"]):
            raise UnsaidError("it has no coefficient of restitution")
        if scene["inactive"]:
            raise UnsaidError("bodies cannot be switched off")
        self._scene = scene
        self._substeps = settings["substeps"]
        self._lawful = settings["lawful"]
        spec = mujoco.MjSpec()
        spec.compiler.degree = False
        spec.option.timestep = scene["dt"] / self._substeps
        spec.option.gravity = [*scene["gravity"], 0.0]
        for index, body in enumerate(scene["bodies"]):
            self._body(spec, index, body)
        self._exclude(spec)
        joints = [joint for joint in scene["joints"] if not both_fixed(scene, joint)]
        for joint in joints:
            self._join(spec, joint)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._start()
        self._motors = [joint for joint in joints if joint["motor"] and scene["motor"]]

    def step(self) -> None:
        """Advance by one frame."""
        for _ in range(self._substeps):
            if self._lawful and (self._motors or self._scene["thrusters"]):
                self._actuate()
            mujoco.mj_step(self._model, self._data)

    def state(self) -> list[tuple[float, ...]]:
        """See the protocol."""
        return [self._seen(index) for index in range(self._scene["recorded"])]

    def _seen(self, index: int) -> tuple[float, ...]:
        told = self._scene["bodies"][index]
        if not told["mass"]:
            return (*told["position"], told["angle"], 0.0, 0.0, 0.0)
        place = self._place[index]
        offset, speed = self._data.qpos[place : place + 3], self._data.qvel[place : place + 3]
        x, y = told["position"]
        return (x + offset[0], y + offset[1], told["angle"] + offset[2], *speed)

    def _body(self, spec: Any, index: int, told: dict[str, Any]) -> None:
        c, s = math.cos(told["angle"] / 2), math.sin(told["angle"] / 2)
        body = spec.worldbody.add_body(
            name=f"b{index}", pos=[*told["position"], 0.0], quat=[c, 0, 0, s]
        )
        kind, wants = BITS[told["collision"]]
        geom = body.add_geom(
            friction=[told["friction"], 0.0, 0.0], condim=3, contype=kind, conaffinity=wants
        )
        if "radius" in told:
            geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
            geom.size = [told["radius"], 0, 0]
        elif _is_box(told["vertices"]):
            width, height = (max(p[k] for p in told["vertices"]) for k in (0, 1))
            geom.type = mujoco.mjtGeom.mjGEOM_BOX
            geom.size = [width, height, DEPTH]
        else:
            raise UnsaidError("a shape that is neither a disc nor a box")
        if told["mass"]:
            body.explicitinertial = True
            body.mass = told["mass"]
            body.inertia = [told["inertia"]] * 3
            body.ipos = [0, 0, 0]
            for axis in ([1, 0, 0], [0, 1, 0]):
                # Axes are those of the body's frame, which is turned at the start.
                turned = _turned(axis, -told["angle"])
                body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=turned)
            body.add_joint(name=f"t{index}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])

    def _exclude(self, spec: Any) -> None:
        bodies = self._scene["bodies"]
        for i, first in enumerate(bodies):
            for j, second in enumerate(bodies[:i]):
                same = first["group"] and first["group"] == second["group"]
                modes = {first["collision"], second["collision"]}
                if same or ("ghost" in modes and "always" not in modes):
                    spec.add_exclude(bodyname1=f"b{i}", bodyname2=f"b{j}")

    def _join(self, spec: Any, told: dict[str, Any]) -> None:
        a, b = told["a"], told["b"]
        if told["weld"]:
            anchor = [*told["anchor_b"], 0.0]
            relative = self._relative(told)
            spec.add_equality(
                type=mujoco.mjtEq.mjEQ_WELD,
                name1=f"b{a}",
                name2=f"b{b}",
                objtype=mujoco.mjtObj.mjOBJ_BODY,
                data=_padded([*anchor, *relative, 1.0]),
            )
            return
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_CONNECT,
            name1=f"b{a}",
            name2=f"b{b}",
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            data=_padded(told["anchor_a"]),
        )
        if told["limits"]:
            self._limit(spec, told)

    def _relative(self, told: dict[str, Any]) -> list[float]:
        """Pose of b in the frame of a, from the anchors and the reference angle."""
        angle = told["reference"]
        offset = _turned([*told["anchor_b"], 0.0], angle)
        x, y = told["anchor_a"][0] - offset[0], told["anchor_a"][1] - offset[1]
        return [x, y, 0.0, math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)]

    def _limit(self, spec: Any, told: dict[str, Any]) -> None:
        """Limits are those of a body's own hinge: sayable where the other body is fixed."""
        bodies = self._scene["bodies"]
        if bodies[told["a"]]["mass"]:
            raise UnsaidError("limits between two free bodies")
        hinge = spec.joint(f"t{told['b']}")
        # The hinge's angle counts from the start, the limits from the reference angle.
        start = bodies[told["b"]]["angle"] - bodies[told["a"]]["angle"] - told["reference"]
        hinge.limited = True
        hinge.range = [limit - start for limit in told["limits"]]

    def _start(self) -> None:
        self._place, place = {}, 0
        for index, body in enumerate(self._scene["bodies"]):
            if body["mass"]:
                self._place[index] = place
                self._data.qvel[place : place + 3] = [*body["velocity"], body["angular_velocity"]]
                place += 3

    def _actuate(self) -> None:
        forces = self._data.qfrc_applied
        forces[:] = 0
        bodies = self._scene["bodies"]
        for joint in self._motors:
            inertia = axial_inertia(bodies[joint["a"]], bodies[joint["b"]])
            a, b = self._seen(joint["a"]), self._seen(joint["b"])
            angle = b[2] - a[2] - joint["reference"]
            pull = motor_law(joint, self._scene["motor"], angle, b[5] - a[5]) * inertia
            for index, sign in ((joint["a"], -1), (joint["b"], 1)):
                if index in self._place:
                    forces[self._place[index] + 2] += sign * pull
        for thruster in self._scene["thrusters"]:
            self._push(thruster)

    def _push(self, told: dict[str, Any]) -> None:
        if told["body"] not in self._place:
            return
        place, angle = self._place[told["body"]], self._seen(told["body"])[2]
        force = THRUSTER_POWER * told["power"] * self._scene["thruster"]
        pushed = _turned([force, 0.0, 0.0], angle + told["angle"])
        arm = _turned([*told["position"], 0.0], angle)
        turning = arm[0] * pushed[1] - arm[1] * pushed[0]
        self._data.qfrc_applied[place : place + 3] += np.array([*pushed[:2], turning])


def _turned(vector: list[float], angle: float) -> list[float]:
    c, s = math.cos(angle), math.sin(angle)
    return [c * vector[0] - s * vector[1], s * vector[0] + c * vector[1], 0.0]


def _padded(values: list[float]) -> list[float]:
    """As many numbers as an equality constraint takes."""
    return [*values, *[0.0] * (mujoco.mjNEQDATA - len(values))]


def _is_box(corners: list[list[float]]) -> bool:
    width, height = (max(p[k] for p in corners) for k in (0, 1))
    wanted = {(sx * width, sy * height) for sx in (1, -1) for sy in (1, -1)}
    told = {(x, y) for x, y in corners}
    return len(told) == 4 and told == wanted and width > 0 and height > 0


if __name__ == "__main__":
    serve(MujocoWorld, mujoco.__version__)
