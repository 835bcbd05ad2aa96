"""The fields of a state by kinetix-env's names; `EnvState.replace` writes them."""

from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.pytree import pytree


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
            a_index=joints.body_a,
            b_index=joints.body_b,
            a_relative_pos=joints.anchor_a,
            b_relative_pos=joints.anchor_b,
            global_position=self._in_world(joints.body_a, joints.anchor_a),
            active=joints.active,
            motor_speed=joints.motor_speed,
            motor_power=joints.motor_power,
            motor_on=joints.motor_on,
            motor_has_joint_limits=joints.limited,
            min_rotation=joints.limit_min,
            max_rotation=joints.limit_max,
            is_fixed_joint=joints.fixed,
            rotation=joints.reference_angle,
        )

    @property
    def thruster(self) -> ThrusterFields:
        """The thrusters."""
        thrusters = self.world.thrusters
        return ThrusterFields(
            object_index=thrusters.body,
            relative_position=thrusters.position,
            rotation=thrusters.angle,
            power=thrusters.power,
            global_position=self._in_world(thrusters.body, thrusters.position),
            active=thrusters.active,
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
        return RigidBodies(
            position=physics.position[..., part, :],
            rotation=physics.rotation[..., part],
            velocity=physics.velocity[..., part, :],
            angular_velocity=physics.angular_velocity[..., part],
            inverse_mass=bodies.inverse_mass[..., part],
            inverse_inertia=bodies.inverse_inertia[..., part],
            friction=bodies.friction[..., part],
            restitution=bodies.restitution[..., part],
            collision_mode=bodies.collision_mode[..., part],
            active=bodies.active[..., part],
            **shapes,
        )

    def _in_world(self, body: Array, local: Array) -> Float[Array, "*n k 2"]:
        """Points of bodies' frames in the world [m]."""
        angle = jnp.take_along_axis(jnp.asarray(self.physics.rotation), body, axis=-1)
        origin = jnp.take_along_axis(
            jnp.asarray(self.physics.position), jnp.asarray(body)[..., None], axis=-2
        )
        sine, cosine = jnp.sin(angle), jnp.cos(angle)
        x, y = local[..., 0], local[..., 1]
        turned = jnp.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
        return origin + turned
