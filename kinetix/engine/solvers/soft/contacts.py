"""Contacts as soft constraints, and what one of them does to its two bodies.

`push_normal` and its like hold for one slot in many worlds and for many slots alike. Every row has
one accumulated impulse; a later solve without bias (*relax*) takes out of it what an earlier one
put in to correct positions.

Worlds are on the last axis.
Source: Catto (2024), "Solver2D"; the formulas are written out in docs/physics.md.
"""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine import constants
from kinetix.engine.collision import Points
from kinetix.engine.lookup import take
from kinetix.engine.maths import Vec, dot, rotate
from kinetix.engine.solvers.soft.levers import Lever, SplitMasses
from kinetix.engine.solvers.soft.springs import Spring
from kinetix.engine.solvers.visit import Targets, Twist, at_bodies
from kinetix.engine.types import Parameters, World
from kinetix.pytree import pytree


@pytree
class SoftContacts:
    """Contact points as solvers see them: fixed for the whole step."""

    lever: Lever
    normal: Vec
    friction: Float[Array, "*k n"]
    restitution: Float[Array, "*k n"]
    used: Bool[Array, "*k n"]


@pytree
class ContactDrive:
    """Targets of a solve for the contacts: change with the gap and with the kind of solve."""

    bias: Float[Array, "*k n"]
    """Closing speed that is left (open gaps) or separating speed that is asked for (negative)."""
    mass: Float[Array, "*k n"]
    keep: Float[Array, "*k n"]


@pytree
class ContactImpulse:
    """Accumulated impulses of contact points [N s]."""

    normal: Float[Array, "*k n"]
    tangent: Float[Array, "*k n"]


def contact_rows(
    world: World, points: Points, targets: Targets, masses: SplitMasses, parameters: Parameters
) -> SoftContacts:
    """Return the rows of a step's contact points."""
    bodies = world.bodies
    a, b = points.body_a, points.body_b
    friction = jnp.sqrt(take(bodies.friction, a) ** 2 + take(bodies.friction, b) ** 2)
    return SoftContacts(
        lever=masses.lever(targets, points.arm_a, points.arm_b),
        normal=points.normal,
        friction=parameters.base_friction * friction,
        restitution=jnp.minimum(take(bodies.restitution, a), take(bodies.restitution, b)),
        used=points.key >= 0,
    )


def soft_contacts(
    rows: SoftContacts, gap: Float[Array, "c n"], spring: Spring, h: Float[Array, " n"]
) -> ContactDrive:
    """Overlaps are pushed apart softly; open gaps may close in this substep but not overlap.

    A fixed body is twice as stiff, so that what lies on it does not sink under a stack.
    """
    fixed = (rows.lever.mass_a == 0) | (rows.lever.mass_b == 0)
    soft = spring.at(h, jnp.where(fixed, 2.0, 1.0).astype(gap.dtype), rows.lever.copied)
    overlap = jnp.minimum(gap + constants.SLOP, 0)
    push = jnp.maximum(soft.mass * soft.rate * overlap, -constants.PUSH_SPEED)
    is_open = gap > 0
    return ContactDrive(
        bias=jnp.where(is_open, gap / h, push),
        mass=jnp.where(is_open, 1, soft.mass),
        keep=jnp.where(is_open, 0, soft.keep),
    )


def relaxed_contacts(gap: Float[Array, "c n"], h: Float[Array, " n"]) -> ContactDrive:
    """Overlaps are left alone: only what the velocities demand."""
    return ContactDrive(
        bias=jnp.where(gap > 0, gap / h, 0), mass=jnp.ones_like(gap), keep=jnp.zeros_like(gap)
    )


def push_normal(
    known: tuple[SoftContacts, ContactDrive], a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Return the impulse that keeps two bodies apart."""
    rows, drive = known
    lever, normal = rows.lever, rows.normal
    closing = dot(normal, lever.speed(a, b))
    wanted = (drive.mass * closing + drive.bias) / lever.resistance(normal)
    total = jnp.maximum(impulse.normal * (1 - drive.keep) - wanted, 0)
    total = jnp.where(rows.used, total, 0)
    pushed = lever.push(normal * (total - impulse.normal))
    return *pushed, ContactImpulse(normal=total, tangent=impulse.tangent)


def push_tangent(
    rows: SoftContacts, a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Friction, within the cone that the normal impulse allows.

    It comes after all normal impulses. Before them it would be bounded by what the soft sweep has
    weakened: a block on a slope slides 4 % too far. Point by point it would answer to the tilt of a
    body whose other corner has not pushed yet: stacks wander sideways.
    """
    lever, normal = rows.lever, rows.normal
    across = Vec(x=normal.y, y=-normal.x)
    slip = dot(across, lever.speed(a, b))
    bound = rows.friction * impulse.normal
    tangent = jnp.clip(impulse.tangent - slip / lever.resistance(across), -bound, bound)
    pushed = lever.push(across * (tangent - impulse.tangent))
    return *pushed, ContactImpulse(normal=impulse.normal, tangent=tangent)


def bounce_contact(
    known: tuple[SoftContacts, Float[Array, "*k n"]], a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Separate at least as fast as `known[1]`, where it is positive."""
    rows, wanted = known
    lever, normal = rows.lever, rows.normal
    closing = dot(normal, lever.speed(a, b)) - wanted
    total = jnp.maximum(impulse.normal - closing / lever.resistance(normal), 0)
    total = jnp.where(wanted > 0, total, impulse.normal)
    pushed = lever.push(normal * (total - impulse.normal))
    return *pushed, ContactImpulse(normal=total, tangent=impulse.tangent)


def contact_push(rows: SoftContacts, impulse: ContactImpulse) -> tuple[Twist, Twist]:
    """Return the velocity changes of accumulated impulses."""
    across = Vec(x=rows.normal.y, y=-rows.normal.x)
    return rows.lever.push(rows.normal * impulse.normal + across * impulse.tangent)


def moved_gap(
    rows: SoftContacts, targets: Targets, gap: Float[Array, "c n"], moved: Twist
) -> Float[Array, "c n"]:
    """The gap at the step's contact points after the bodies have moved and turned since its start.

    Args:
        rows: The contacts.
        targets: Their bodies.
        gap: At the start of the step [m].
        moved: Displacement of all bodies since then [m, rad].
    """
    way = []
    for arm, body in ((rows.lever.arm_a, targets.body_a), (rows.lever.arm_b, targets.body_b)):
        by = at_bodies(moved, body)
        cos, sin = jnp.cos(by.turn), jnp.sin(by.turn)
        way.append(Vec(x=by.x, y=by.y) + rotate(cos, sin, arm) - arm)
    return gap + dot(rows.normal, way[1] - way[0])
