"""MuJoCo (package `mujoco`): scenes as planar_model.py says them. See protocol.py.

Settings: `substeps`.
"""

from typing import Any

import mujoco
import numpy as np
from planar_model import coordinates, planar_model, starting_speeds, turned
from protocol import THRUSTER_POWER, Scene, axial_inertia, motor_law, motors_of, serve


class MujocoWorld:
    """One scene."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Build and compile the model."""
        self._scene = scene
        self._substeps = settings["substeps"]
        self._lawful = settings["lawful"]
        self._model = planar_model(scene, timestep=scene["dt"] / self._substeps)
        self._data = mujoco.MjData(self._model)
        self._place = coordinates(scene)
        self._data.qvel[:] = starting_speeds(scene)
        self._motors = motors_of(scene)

    def step(self) -> None:
        """Advance by one frame."""
        for _ in range(self._substeps):
            if self._lawful and (self._motors or self._scene["thrusters"]):
                self._actuate()
            mujoco.mj_step(self._model, self._data)

    def state(self) -> list[tuple[float, ...]]:
        """Return the poses and velocities, as the protocol asks."""
        return [self._seen(index) for index in range(self._scene["recorded"])]

    def _seen(self, index: int) -> tuple[float, ...]:
        told = self._scene["bodies"][index]
        if not told["mass"]:
            return (*told["position"], told["angle"], 0.0, 0.0, 0.0)
        place = self._place[index]
        offset, speed = self._data.qpos[place : place + 3], self._data.qvel[place : place + 3]
        x, y = told["position"]
        return (x + offset[0], y + offset[1], told["angle"] + offset[2], *speed)

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
        pushed = turned([force, 0.0, 0.0], angle + told["angle"])
        arm = turned([*told["position"], 0.0], angle)
        turning = arm[0] * pushed[1] - arm[1] * pushed[0]
        self._data.qfrc_applied[place : place + 3] += np.array([*pushed[:2], turning])


if __name__ == "__main__":
    serve(MujocoWorld, mujoco.__version__)
