"""Chipmunk (package `pymunk`): scenes in its own words. See protocol.py."""

import math
from typing import Any

import pymunk
from protocol import (
    MOTOR_POWER,
    MOTOR_SPEED,
    THRUSTER_POWER,
    Scene,
    UnsaidError,
    axial_inertia,
    both_fixed,
    motor_law,
    serve,
)

CATEGORIES = {"normal": 1, "always": 2, "ghost": 4}
MASKS = {"normal": 1 | 2, "always": 1 | 2 | 4, "ghost": 2}
SLOP = 5e-3
"""Overlap that is left alone [m]; the default of .1 is meant for pixels."""


class ChipmunkWorld:
    """One scene. Settings: `iterations`, `substeps`."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Build bodies and joints."""
        if not math.isfinite(scene["motor"] + scene["thruster"]):
            raise UnsaidError("it ends the program when a force is not a number")
        self._scene = scene
        self._substeps = settings["substeps"]
        self._h = scene["dt"] / self._substeps
        self._space = pymunk.Space()
        self._space.gravity = tuple(scene["gravity"])
        self._space.iterations = settings["iterations"]
        self._space.collision_slop = SLOP
        self._bodies = [self._body(body) for body in scene["bodies"]]
        self._motors = []
        self._lawful = settings["lawful"]
        self._thrusters = scene["thrusters"] if self._lawful else []
        for joint in scene["joints"]:
            if not both_fixed(scene, joint):
                self._join(joint)

    def step(self) -> None:
        """Advance by one frame."""
        for _ in range(self._substeps):
            for motor in self._motors:
                self._drive(*motor)
            for thruster in self._thrusters:
                self._push(thruster)
            self._space.step(self._h)

    def state(self) -> list[tuple[float, ...]]:
        """Return the poses and velocities, as the protocol asks."""
        return [
            (*body.position, body.angle, *body.velocity, body.angular_velocity)
            for body in self._bodies[: self._scene["recorded"]]
        ]

    def _body(self, told: dict[str, Any]) -> pymunk.Body:
        if told["mass"]:
            body = pymunk.Body(told["mass"], told["inertia"])
            body.velocity = tuple(told["velocity"])
            body.angular_velocity = told["angular_velocity"]
        else:
            body = pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position = tuple(told["position"])
        body.angle = told["angle"]
        if "radius" in told:
            shape: pymunk.Shape = pymunk.Circle(body, told["radius"])
        else:
            shape = pymunk.Poly(body, [tuple(corner) for corner in told["vertices"]])
        # Values of a pair are multiplied.
        shape.friction = math.sqrt(told["friction"])
        shape.elasticity = math.sqrt(told["restitution"])
        shape.filter = pymunk.ShapeFilter(
            group=told["group"],
            categories=CATEGORIES[told["collision"]],
            mask=MASKS[told["collision"]],
        )
        if not self._scene["inactive"]:
            self._space.add(body, shape)
        return body

    def _join(self, told: dict[str, Any]) -> None:
        a, b = self._bodies[told["a"]], self._bodies[told["b"]]
        pivot = pymunk.PivotJoint(a, b, tuple(told["anchor_a"]), tuple(told["anchor_b"]))
        pivot.collide_bodies = False
        self._space.add(pivot)
        if told["weld"]:
            self._space.add(pymunk.GearJoint(a, b, told["reference"], 1.0))
            return
        if told["limits"]:
            low, high = (told["reference"] + limit for limit in told["limits"])
            self._space.add(pymunk.RotaryLimitJoint(a, b, low, high))
        if told["motor"] and self._scene["motor"]:
            bodies = self._scene["bodies"]
            # Its rate is that of a against b.
            rate = -MOTOR_SPEED * told["motor"][0] * self._scene["motor"]
            motor = pymunk.SimpleMotor(a, b, rate)
            self._space.add(motor)
            inertia = axial_inertia(bodies[told["a"]], bodies[told["b"]])
            motor.max_force = MOTOR_POWER * told["motor"][1] * inertia
            if self._lawful:
                self._motors.append((told, motor, inertia))

    def _drive(self, told: dict[str, Any], motor: pymunk.SimpleMotor, inertia: float) -> None:
        a, b = motor.a, motor.b
        acceleration = motor_law(
            told,
            self._scene["motor"],
            b.angle - a.angle - told["reference"],
            b.angular_velocity - a.angular_velocity,
        )
        motor.max_force = abs(acceleration) * inertia

    def _push(self, told: dict[str, Any]) -> None:
        body = self._bodies[told["body"]]
        force = THRUSTER_POWER * told["power"] * self._scene["thruster"]
        if body.body_type != pymunk.Body.DYNAMIC or not force:
            return
        # A local force turns with the body.
        body.apply_force_at_local_point(
            (force * math.cos(told["angle"]), force * math.sin(told["angle"])),
            tuple(told["position"]),
        )


if __name__ == "__main__":
    serve(ChipmunkWorld, pymunk.version)
