"""The fields of a state by kinetix-env's names; `EnvState.replace` writes them."""

from collections.abc import Mapping
from typing import Any, Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.pytree import pytree

MOTION: Final = ("position", "rotation", "velocity", "angular_velocity")
"""Fields of the moving state that both have by the same name, one of each body."""
CONSTANTS: Final = (
    "inverse_mass",
    "inverse_inertia",
    "friction",
    "restitution",
    "collision_mode",
    "active",
)
"""The same of what a step leaves as it is."""
JOINTS: Final = {
    "body_a": "a_index",
    "body_b": "b_index",
    "anchor_a": "a_relative_pos",
    "anchor_b": "b_relative_pos",
    "active": "active",
    "fixed": "is_fixed_joint",
    "reference_angle": "rotation",
    "motor_on": "motor_on",
    "motor_speed": "motor_speed",
    "motor_power": "motor_power",
    "limited": "motor_has_joint_limits",
    "limit_min": "min_rotation",
    "limit_max": "max_rotation",
}
"""kinetix-env's names by ours."""
THRUSTERS: Final = {
    "body": "object_index",
    "position": "relative_position",
    "angle": "rotation",
    "power": "power",
    "active": "active",
}
"""kinetix-env's names by ours."""


@pytree
class RigidBodies:
    """The polygons, or the circles, of a state."""

    position: Float[Array, "*n k 2"]
    rotation: Float[Array, "*n k"]
    velocity: Float[Array, "*n k 2"]
    angular_velocity: Float[Array, "*n k"]
    inverse_mass: Float[Array, "*n k"]
    inverse_inertia: Float[Array, "*n k"]
    friction: Float[Array, "*n k"]
    restitution: Float[Array, "*n k"]
    collision_mode: Int[Array, "*n k"]
    active: Bool[Array, "*n k"]
    n_vertices: Int[Array, "*n k"]
    vertices: Float[Array, "*n k 4 2"]
    radius: Float[Array, "*n k"]


@pytree
class JointFields:
    """The joints of a state."""

    a_index: Int[Array, "*n j"]
    b_index: Int[Array, "*n j"]
    a_relative_pos: Float[Array, "*n j 2"]
    b_relative_pos: Float[Array, "*n j 2"]
    global_position: Float[Array, "*n j 2"]
    active: Bool[Array, "*n j"]
    motor_speed: Float[Array, "*n j"]
    motor_power: Float[Array, "*n j"]
    motor_on: Bool[Array, "*n j"]
    motor_has_joint_limits: Bool[Array, "*n j"]
    min_rotation: Float[Array, "*n j"]
    max_rotation: Float[Array, "*n j"]
    is_fixed_joint: Bool[Array, "*n j"]
    rotation: Float[Array, "*n j"]


@pytree
class ThrusterFields:
    """The thrusters of a state."""

    object_index: Int[Array, "*n t"]
    relative_position: Float[Array, "*n t 2"]
    rotation: Float[Array, "*n t"]
    power: Float[Array, "*n t"]
    global_position: Float[Array, "*n t 2"]
    active: Bool[Array, "*n t"]


class FieldsOfKinetixEnv:
    """Properties of an `EnvState`, for one state and for batches of any shape."""

    world: Any
    physics: Any
    labels: Any

    @property
    def polygon(self) -> RigidBodies:
        """The polygons, the arena first."""
        bodies = self.world.bodies
        return self._rigid_bodies(
            slice(0, self._polygons),
            n_vertices=bodies.vertex_count,
            vertices=bodies.vertices,
            radius=jnp.zeros(jnp.shape(bodies.vertex_count)),
        )

    @property
    def circle(self) -> RigidBodies:
        """The circles."""
        radius = self.world.bodies.radius
        return self._rigid_bodies(
            slice(self._polygons, None),
            n_vertices=jnp.zeros(jnp.shape(radius), jnp.int32),
            vertices=jnp.zeros((*jnp.shape(radius), 4, 2)),
            radius=radius,
        )

    @property
    def joint(self) -> JointFields:
        """The joints; a position is that of the anchor on body a."""
        joints = self.world.joints
        return JointFields(
            **_named(joints, JOINTS),
            global_position=self._in_world(joints.body_a, joints.anchor_a),
        )

    @property
    def thruster(self) -> ThrusterFields:
        """The thrusters."""
        thrusters = self.world.thrusters
        return ThrusterFields(
            **_named(thrusters, THRUSTERS),
            global_position=self._in_world(thrusters.body, thrusters.position),
        )

    @property
    def collision_matrix(self) -> Bool[Array, "*n b b"]:
        """False between bodies of one jointed component."""
        return self.world.collides

    @property
    def gravity(self) -> Float[Array, "*n 2"]:
        """Acceleration of gravity [m/s²]."""
        return self.world.gravity

    @property
    def thruster_bindings(self) -> Int[Array, "*n t"]:
        """Action channel of every thruster."""
        return self.labels.thruster_binding

    @property
    def motor_bindings(self) -> Int[Array, "*n j"]:
        """Action channel of every motor."""
        return self.labels.motor_binding

    @property
    def motor_auto(self) -> Bool[Array, "*n j"]:
        """True if the motor always runs."""
        return self.labels.motor_auto

    @property
    def polygon_shape_roles(self) -> Int[Array, "*n p"]:
        """0 none, 1 green, 2 blue, 3 red."""
        return self.labels.role[..., : self._polygons]

    @property
    def circle_shape_roles(self) -> Int[Array, "*n r"]:
        """0 none, 1 green, 2 blue, 3 red."""
        return self.labels.role[..., self._polygons :]

    @property
    def polygon_highlighted(self) -> Bool[Array, "*n p"]:
        """False: what is selected is the editor's business."""
        return jnp.zeros(jnp.shape(self.polygon_shape_roles), bool)

    @property
    def circle_highlighted(self) -> Bool[Array, "*n r"]:
        """False: what is selected is the editor's business."""
        return jnp.zeros(jnp.shape(self.circle_shape_roles), bool)

    @property
    def polygon_densities(self) -> Float[Array, "*n p"]:
        """Mass per area [kg/m²]."""
        return self.labels.density[..., : self._polygons]

    @property
    def circle_densities(self) -> Float[Array, "*n r"]:
        """Mass per area [kg/m²]."""
        return self.labels.density[..., self._polygons :]

    @property
    def _polygons(self) -> int:
        return jnp.shape(self.world.bodies.vertex_count)[-1]

    def _rigid_bodies(self, part: slice, **shapes: Array) -> RigidBodies:
        bodies, physics = self.world.bodies, self.physics
        constants: dict[str, Any] = {name: getattr(bodies, name)[..., part] for name in CONSTANTS}
        return RigidBodies(
            position=physics.position[..., part, :],
            rotation=physics.rotation[..., part],
            velocity=physics.velocity[..., part, :],
            angular_velocity=physics.angular_velocity[..., part],
            **constants,
            **shapes,
        )

    def _in_world(self, body: Array, local: Array) -> Float[Array, "*n k 2"]:
        """Return points of bodies' frames in the world [m]."""
        angle = jnp.take_along_axis(jnp.asarray(self.physics.rotation), body, axis=-1)
        origin = jnp.take_along_axis(
            jnp.asarray(self.physics.position), jnp.asarray(body)[..., None], axis=-2
        )
        sine, cosine = jnp.sin(angle), jnp.cos(angle)
        x, y = local[..., 0], local[..., 1]
        turned = jnp.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
        return origin + turned


def _named(values: Any, names: Mapping[str, str]) -> dict[str, Any]:
    """Return the fields of joints or thrusters by kinetix-env's names."""
    return {theirs: getattr(values, ours) for ours, theirs in names.items()}
