"""Poses of a state in the world, for both renderers."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine.types import State, World


def rotated(vector: Float[Array, "*s 2"], angle: Float[Array, "*s"]) -> Float[Array, "*s 2"]:
    """Return vectors turned counter-clockwise by angles [rad]."""
    cos, sin = jnp.cos(angle), jnp.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return jnp.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def corners(world: World) -> Float[Array, "p v 2"]:
    """Return corners of the polygons in their own frames [m]; padding repeats the last real corner.

    So a triangle is a quadrilateral with an edge of length zero, and is drawn as a triangle.
    """
    vertices = world.bodies.vertices
    slot = jnp.arange(vertices.shape[1])[None, :, None]
    last = world.bodies.vertex_count[:, None, None] - 1
    held = vertices[:, 0]
    filled = []
    for corner in range(vertices.shape[1]):
        held = jnp.where(slot[:, corner] <= last[:, 0], vertices[:, corner], held)
        filled.append(held)
    return jnp.stack(filled, axis=1)


def centroids(corners: Float[Array, "p v 2"]) -> Float[Array, "p 2"]:
    """Centroids of polygons [m], by the shoelace formula; of one without an area, a corner."""
    arms = corners[:, 1:] - corners[:, :1]
    a, b = arms[:, :-1], arms[:, 1:]
    twice = a[..., :1] * b[..., 1:] - a[..., 1:] * b[..., :1]
    area = twice.sum(axis=1)
    return corners[:, 0] + ((a + b) * twice).sum(axis=1) / jnp.where(area == 0, 1.0, 3 * area)


def world_corners(world: World, state: State) -> Float[Array, "p v 2"]:
    """Return corners of the polygons in the world [m]."""
    local = corners(world)
    polygons = local.shape[0]
    angle = jnp.broadcast_to(state.rotation[:polygons, None], local.shape[:2])
    return rotated(local, angle) + state.position[:polygons, None, :]


def joint_anchors(world: World, state: State) -> Float[Array, "j 2"]:
    """Return the places at which joints are drawn [m].

    The anchor on a fixed body counts; between two moving bodies it is the mean of the two anchors,
    weighted by the inverse masses.
    """
    joints = world.joints
    at_a, at_b = (
        rotated(anchor, state.rotation[body]) + state.position[body]
        for anchor, body in ((joints.anchor_a, joints.body_a), (joints.anchor_b, joints.body_b))
    )
    mass_a = world.bodies.inverse_mass[joints.body_a]
    mass_b = world.bodies.inverse_mass[joints.body_b]
    total = mass_a + mass_b
    share_b = jnp.where(
        mass_a == 0, 0.0, jnp.where(mass_b == 0, 1.0, mass_b / jnp.where(total == 0, 1.0, total))
    )[:, None]
    return at_a * (1 - share_b) + at_b * share_b


def thruster_poses(world: World, state: State) -> tuple[Float[Array, "t 2"], Float[Array, " t"]]:
    """Return the places of the thrusters [m] and the directions in which they push [rad]."""
    thrusters = world.thrusters
    turn = state.rotation[thrusters.body]
    position = rotated(thrusters.position, turn) + state.position[thrusters.body]
    return position, turn + thrusters.angle


__all__ = ["centroids", "corners", "joint_anchors", "rotated", "thruster_poses", "world_corners"]
