"""The rows that the symbolic observations share: one per polygon, circle, joint and thruster.

Columns are those of `features.Layout`, in its order.
"""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.observations.features import Layout
from kinetix.environment.state import EnvState

ANGULAR_VELOCITY_SCALE = 10.0
"""Angular velocities are shown as tanh(ω / this) [rad/s]."""
GRAVITY_SCALE = 10.0
"""Gravity is shown divided by this [m/s²]."""


def finite(tree: Any) -> Any:
    """The same pytree without NaN (0 instead) and infinities (the largest numbers instead)."""
    return jax.tree.map(
        lambda x: jnp.nan_to_num(x) if jnp.issubdtype(x.dtype, jnp.floating) else x, tree
    )


def gravity_feature(state: EnvState) -> Float[Array, ""]:
    """Return the vertical gravity over 10 m/s²."""
    return state.world.gravity[1] / GRAVITY_SCALE


def body_rows(state: EnvState, layout: Layout) -> tuple[Array, Array]:
    """Return polygons' rows and circles' rows."""
    polygons = layout.capacity.polygons
    bodies, physics = state.world.bodies, state.physics
    base = jnp.concatenate(
        [
            physics.position,
            physics.velocity,
            _column(bodies.inverse_mass),
            _column(bodies.inverse_inertia),
            _column(state.labels.density),
            _column(jnp.tanh(physics.angular_velocity / ANGULAR_VELOCITY_SCALE)),
            one_hot(state.labels.role, layout.roles),
            _column(jnp.sin(physics.rotation)),
            _column(jnp.cos(physics.rotation)),
            _column(bodies.friction),
            _column(bodies.restitution),
        ],
        axis=1,
    )
    circle_rows = jnp.concatenate(
        [
            base[polygons:],
            _column(bodies.radius),
            jnp.ones((layout.capacity.circles, 1), base.dtype),
        ],
        axis=1,
    )
    corner = jnp.arange(bodies.vertices.shape[1])
    used = corner[None, :] < bodies.vertex_count[:, None]
    vertices = jnp.where(used[:, :, None], bodies.vertices, -1.0)
    polygon_rows = jnp.concatenate(
        [
            base[:polygons],
            jnp.zeros((polygons, 1), base.dtype),
            vertices.reshape(polygons, -1),
            _column((bodies.vertex_count <= 3).astype(jnp.float32)),
        ],
        axis=1,
    )
    return polygon_rows, circle_rows


def joint_rows(state: EnvState, layout: Layout) -> tuple[Array, Array]:
    """Return joints' rows seen from body b, and seen from body a."""
    joints = state.world.joints
    hinge = ~joints.fixed
    low, high = joints.limit_min, joints.limit_max
    head = jnp.stack([joints.active, joints.fixed], axis=1).astype(jnp.float32)
    motor = jnp.stack(
        [
            joints.motor_speed,
            joints.motor_power,
            joints.motor_on.astype(jnp.float32),
            joints.limited.astype(jnp.float32),
        ],
        axis=1,
    )
    limits = jnp.stack(
        [
            jnp.sin(low),
            jnp.cos(low),
            jnp.sin(high),
            jnp.cos(high),
            low - joints.reference_angle,
            high - joints.reference_angle,
        ],
        axis=1,
    )
    tail = jnp.concatenate(
        [
            _column(jnp.sin(joints.reference_angle)),
            _column(jnp.cos(joints.reference_angle)),
            _where(motor, hinge),
            _where(one_hot(state.labels.motor_binding, layout.motor_bindings), hinge),
            _where(limits, hinge & joints.limited),
        ],
        axis=1,
    )
    from_b = jnp.concatenate([head, joints.anchor_b, joints.anchor_a, tail], axis=1)
    from_a = jnp.concatenate([head, joints.anchor_a, joints.anchor_b, tail], axis=1)
    return from_b, from_a


def thruster_rows(state: EnvState, layout: Layout) -> Float[Array, "t f"]:
    """Return the rows of thrusters."""
    thrusters = state.world.thrusters
    return jnp.concatenate(
        [
            _column(thrusters.active.astype(jnp.float32)),
            thrusters.position,
            one_hot(state.labels.thruster_binding, layout.thruster_bindings),
            _column(jnp.sin(thrusters.angle)),
            _column(jnp.cos(thrusters.angle)),
            _column(thrusters.power),
        ],
        axis=1,
    )


def flat_rows(state: EnvState, layout: Layout) -> tuple[Array, Array, Array, Array]:
    """Return the rows of the flat forms by kind: polygons, circles, joints, thrusters.

    Walls and ceiling are left out, bodies of joints and thrusters are one-hot columns, rows of
    inactive entities are zero.
    """
    capacity, world = layout.capacity, state.world
    polygon_rows, circle_rows = body_rows(state, layout)
    from_b, _ = joint_rows(state, layout)
    joints = jnp.concatenate(
        [
            from_b,
            one_hot(world.joints.body_b, capacity.bodies),
            one_hot(world.joints.body_a, capacity.bodies),
        ],
        axis=1,
    )
    thrusters = jnp.concatenate(
        [thruster_rows(state, layout), one_hot(world.thrusters.body, capacity.bodies)], axis=1
    )
    first = layout.flat_polygons[1] if len(layout.flat_polygons) > 1 else capacity.polygons
    active = world.bodies.active
    listed = [polygon_rows[:1], polygon_rows[first:]]
    listed_active = jnp.concatenate([active[:1], active[first : capacity.polygons]])
    return (
        _where(jnp.concatenate(listed), listed_active),
        _where(circle_rows, active[capacity.polygons :]),
        _where(joints, world.joints.active),
        _where(thrusters, world.thrusters.active),
    )


def one_hot(index: Int[Array, " e"], width: int) -> Float[Array, "e w"]:
    """1.0 in the column of the index; all zero where it is out of range."""
    return (index[:, None] == jnp.arange(width)[None, :]).astype(jnp.float32)


def _column(values: Float[Array, " e"]) -> Float[Array, "e 1"]:
    return values[:, None]


def _where(rows: Float[Array, "e f"], kept: Bool[Array, " e"]) -> Float[Array, "e f"]:
    return jnp.where(kept[:, None], rows, 0.0)
