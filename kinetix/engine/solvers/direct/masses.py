"""Effective inertia of bodies: their own plus the geometric stiffness of loaded joints.

Worlds are on the last axis.
Source: Andrews, Teichmann & Kry (2017), "Geometric Stiffness for Real-time Constrained Multibody
Dynamics".
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine import constants
from kinetix.engine.collision import Found
from kinetix.engine.lookup import onto
from kinetix.engine.maths import Vec, dot, nonzero, rotate, vec, where
from kinetix.engine.solvers.rows import Links, Masses
from kinetix.engine.types import State, World


def masses_of(world: World) -> Float[Array, "b n"]:
    """The mass of each body; 0 if it is fixed or an empty slot."""
    inverse = world.bodies.inverse_mass
    return jnp.where(inverse > 0, 1 / nonzero(inverse), 0) * world.bodies.active


def borne(world: World, found: Found, force: Float[Array, "c n"]) -> Float[Array, "b n"]:
    """Return the load of each body [kg]: the mass whose weight is half of all that presses on it.

    It cannot weigh more than all bodies together: what presses harder is a motor or a blow.

    Args:
        world: The worlds.
        found: The contacts.
        force: That they bore in the last step [N].
    """
    points, count = found.points, len(world.bodies.inverse_mass)
    pressed = onto(force, points.body_a, count) + onto(force, points.body_b, count)
    gravity = jnp.sqrt(jnp.sum(world.gravity**2, axis=0))
    total = jnp.sum(masses_of(world), axis=0)
    # What lies still is pressed from below as much as from above.
    return jnp.minimum(pressed / 2 / nonzero(gravity), total)


def effective_masses(
    world: World,
    state: State,
    links: Links,
    bears: Float[Array, "b n"],
    h: Float[Array, " n"],
    substeps: int,
) -> tuple[Masses, Float[Array, "b n"]]:
    """Inverse masses with the stiffness of taut joints added to the inertia, and what is loose.

    A body that bears far more than its own weight would be thrown by the least error of what
    presses on it: contacts are prepared for a whole step, while a plank turns under its load. It
    counts as heavier, so that it bears `MOST_BORNE` times its mass; the load hardly notices.

    A force f at an arm r turns with the body: a spring of stiffness r·f that linearised joints do
    not see. As inertia h²·r·f it keeps heavy hanging loads stable; ordinary scenes do not notice.
    Welds are left out: bodies do not swing about them.
    h²·r·f over the body's own inertia is (h·swing rate)², which separates taut joints from loose
    ones. The forces are those of the last step. One that grows at a blow acts for a whole step
    before it is known, so the inertia is that of a step, not of a substep.
    """
    joints, bodies, cache = world.joints, world.bodies, state.cache
    excess = jnp.maximum(1, bears * bodies.inverse_mass / constants.MOST_BORNE)
    inverse_mass, inverse_inertia = bodies.inverse_mass / excess, bodies.inverse_inertia / excess
    count = inverse_inertia.shape[0]
    force = Vec(x=cache.joint_force_x, y=cache.joint_force_y)
    force = where(joints.fixed, force * 0, force)
    stiffness = jnp.zeros_like(inverse_inertia)
    ends = links.look_up((state.rotation, inverse_mass, inverse_inertia))
    (angle_a, mass_a, inertia_a), (angle_b, mass_b, inertia_b) = ends
    for body, angle, anchor, sign, mass, inertia, other in (
        (joints.body_a, angle_a, joints.anchor_a, -1, mass_a, inertia_a, mass_b),
        (joints.body_b, angle_b, joints.anchor_b, 1, mass_b, inertia_b, mass_a),
    ):
        arm = rotate(jnp.cos(angle), jnp.sin(angle), vec(anchor))
        # On a pivot that stands still a body turns about it, not about its own centre.
        about = jnp.where(other > 0, 1, mass / nonzero(mass + dot(arm, arm) * inertia))
        stiffness += sign * onto(dot(arm, force) * about, body, count)
    swing = h**2 * jnp.maximum(stiffness, 0) * inverse_inertia
    late = min(substeps, constants.MOST_LATE)
    angular = inverse_inertia / jnp.maximum(1, late**2 * swing)
    masses = Masses(linear=inverse_mass, angular=angular)
    return masses, jnp.clip((constants.TAUT - swing) / (0.8 * constants.TAUT), 0, 1)


def pivoted(world: World, links: Links) -> Float[Array, "b n"]:
    """1 for bodies joined to fixed bodies only, negative for those joined to a moving one.

    What is welded to a fixed body stands still too.
    """
    joints, inverse_mass = world.joints, world.bodies.inverse_mass
    count = inverse_mass.shape[0]

    def of_joints(found: Float[Array, "b n"]) -> tuple[tuple[Array, Array], ...]:
        of_a, of_b = links.look_up(found)
        return (joints.body_a, of_b), (joints.body_b, of_a)

    moves = inverse_mass
    for body, other in of_joints(moves):
        welded = joints.active & joints.fixed & (other == 0)
        moves = jnp.where(onto(welded.astype(moves.dtype), body, count) > 0, 0, moves)
    hangs = jnp.zeros_like(inverse_mass)
    for body, other in of_joints(moves):
        weight = jnp.where(other > 0, -float(count), jnp.ones_like(other))
        hangs += onto(jnp.where(joints.active, weight, 0), body, count)
    return jnp.where(inverse_mass > 0, jnp.minimum(hangs, 1), 0)
