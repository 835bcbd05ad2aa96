"""Box2D 2.3 (package `box2d`): scenes in its own words. See protocol.py."""

import math
from typing import Any

import Box2D
from protocol import (
    MOTOR_POWER,
    MOTOR_SPEED,
    THRUSTER_POWER,
    Scene,
    axial_inertia,
    both_fixed,
    motor_law,
    serve,
)

CATEGORIES = {"normal": 1, "always": 2, "ghost": 4}
MASKS = {"normal": 1 | 2, "always": 1 | 2 | 4, "ghost": 2}


SKIN = Box2D.b2_polygonRadius - Box2D.b2_linearSlop / 2
"""Half the gap of two polygons at rest [m]: theirs are made smaller by so much, so that bodies that
touch in a scene touch here."""


class Box2dWorld:
    """One scene. Settings: `iterations` [velocity, position], `substeps`, `bullets`."""

    def __init__(self, scene: Scene, settings: dict[str, Any]) -> None:
        """Build bodies and joints."""
        self._scene = scene
        self._velocity_iterations, self._position_iterations = settings["iterations"]
        self._substeps = settings["substeps"]
        self._h = scene["dt"] / self._substeps
        self._world = Box2D.b2World(gravity=scene["gravity"], doSleep=False)
        self._bodies = [self._body(body, settings["bullets"]) for body in scene["bodies"]]
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
            self._world.Step(self._h, self._velocity_iterations, self._position_iterations)

    def state(self) -> list[tuple[float, ...]]:
        """Return the poses and velocities, as the protocol asks."""
        return [
            (*body.position, body.angle, *body.linearVelocity, body.angularVelocity)
            for body in self._bodies[: self._scene["recorded"]]
        ]

    def _body(self, told: dict[str, Any], bullets: bool) -> Any:
        place = {
            "position": told["position"],
            "angle": told["angle"],
            "active": not self._scene["inactive"],
        }
        if not told["mass"]:
            body = self._world.CreateStaticBody(**place)
        else:
            body = self._world.CreateDynamicBody(
                **place,
                linearVelocity=told["velocity"],
                angularVelocity=told["angular_velocity"],
                bullet=bullets,
                allowSleep=False,
            )
        if "radius" in told:
            shape = Box2D.b2CircleShape(radius=told["radius"])
        else:
            shape = Box2D.b2PolygonShape(vertices=shrunk(told["vertices"], SKIN))
        body.CreateFixture(
            shape=shape,
            density=1.0,
            friction=told["friction"],
            restitution=told["restitution"],
            groupIndex=-told["group"],
            categoryBits=CATEGORIES[told["collision"]],
            maskBits=MASKS[told["collision"]],
        )
        if told["mass"]:
            body.massData = Box2D.b2MassData(mass=told["mass"], center=(0, 0), I=told["inertia"])
        return body

    def _join(self, told: dict[str, Any]) -> None:
        a, b = self._bodies[told["a"]], self._bodies[told["b"]]
        ends = {
            "bodyA": a,
            "bodyB": b,
            "localAnchorA": tuple(told["anchor_a"]),
            "localAnchorB": tuple(told["anchor_b"]),
            "referenceAngle": told["reference"],
            "collideConnected": False,
        }
        if told["weld"]:
            self._world.CreateJoint(Box2D.b2WeldJointDef(**ends))
            return
        low, high = told["limits"] or (0.0, 0.0)
        joint = self._world.CreateJoint(
            Box2D.b2RevoluteJointDef(
                **ends, enableLimit=bool(told["limits"]), lowerAngle=low, upperAngle=high
            )
        )
        if told["motor"] and self._scene["motor"]:
            bodies = self._scene["bodies"]
            inertia = axial_inertia(bodies[told["a"]], bodies[told["b"]])
            joint.motorSpeed = MOTOR_SPEED * told["motor"][0] * self._scene["motor"]
            joint.motorEnabled = True
            joint.maxMotorTorque = MOTOR_POWER * told["motor"][1] * inertia
            if self._lawful:
                self._motors.append((told, joint, inertia))

    def _drive(self, told: dict[str, Any], joint: Any, inertia: float) -> None:
        acceleration = motor_law(told, self._scene["motor"], joint.angle, joint.speed)
        joint.maxMotorTorque = abs(acceleration) * inertia

    def _push(self, told: dict[str, Any]) -> None:
        body = self._bodies[told["body"]]
        force = THRUSTER_POWER * told["power"] * self._scene["thruster"]
        if not body.mass or not force:
            return
        direction = told["angle"] + body.angle
        body.ApplyForce(
            (force * math.cos(direction), force * math.sin(direction)),
            body.GetWorldPoint(tuple(told["position"])),
            True,
        )


def shrunk(corners: list[list[float]], by: float) -> list[tuple[float, float]]:
    """A convex counter-clockwise polygon, its edges moved inwards; as it was where too thin."""
    count = len(corners)
    edges = []
    for k in range(count):
        (ax, ay), (bx, by_) = corners[k], corners[(k + 1) % count]
        length = math.hypot(bx - ax, by_ - ay)
        if length == 0:
            return [(x, y) for x, y in corners]
        # The normal points outwards.
        nx, ny = (by_ - ay) / length, (ax - bx) / length
        edges.append((nx, ny, nx * ax + ny * ay - by))
    found = []
    for k in range(count):
        (ax, ay, a), (bx, by_, b) = edges[k - 1], edges[k]
        cross = ax * by_ - ay * bx
        if cross <= 0:
            return [(x, y) for x, y in corners]
        found.append(((a * by_ - b * ay) / cross, (ax * b - bx * a) / cross))
    inside = all(nx * x + ny * y <= distance + 1e-9 for nx, ny, distance in edges for x, y in found)
    return found if inside else [(x, y) for x, y in corners]


if __name__ == "__main__":
    serve(Box2dWorld, Box2D.__version__)
