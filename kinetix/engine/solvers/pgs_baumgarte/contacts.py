"""Contacts of kinetix-env's scheme: which there are, and one solution of a batch of them."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.collision import jax2d
from kinetix.engine.collision.jax2d import Manifold
from kinetix.engine.maths import Vec, cross, dot, nonzero, spin, vec
from kinetix.engine.pairs import candidate_pairs, may_push, pair_counts
from kinetix.engine.solvers.pgs_baumgarte.moving import Impulses, Moving
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Parameters, State, World
from kinetix.pytree import pytree


@pytree
class Contacts:
    """One slot of one kind of contact, prepared for the sweeps."""

    manifold: Manifold
    pushes: Bool[Array, "q n"]
    """True where an impulse may act (the reward looks at `manifold.active` instead)."""
    bounce: Float[Array, "q n"]
    """Restitution target: approach velocity times restitution [m/s], negative."""
    friction: Float[Array, "q n"]
    batch: Int[Array, "q n"]
    """Batch that solves the pair."""


class Kinds:
    """The static pair lists of a capacity, by contact slot."""

    def __init__(self, spec: SceneSpec) -> None:
        pairs = candidate_pairs(spec.capacity)
        first, second, _ = pair_counts(spec.capacity)
        self.polygons = spec.capacity.polygons
        self.slots = (
            pairs[:first],
            pairs[:first],
            pairs[first : first + second],
            pairs[first + second :],
        )

    def manifolds(self, world: World, state: State) -> tuple[Manifold, ...]:
        """Return the step-start contacts of every slot, collision modes and activity applied."""
        shapes = jax2d.move_shapes(world.bodies, state)
        centre = vec(state.position[self.polygons :])
        radius = world.bodies.radius
        polygon_pairs, _, mixed, circles = self.slots
        deeper, other = jax2d.polygon_polygon(polygon_pairs[:, 0], polygon_pairs[:, 1], shapes)
        found = (
            deeper,
            other,
            jax2d.circle_polygon(mixed[:, 0] - self.polygons, mixed[:, 1], centre, radius, shapes),
            jax2d.circle_circle(
                circles[:, 0] - self.polygons, circles[:, 1] - self.polygons, centre, radius
            ),
        )
        return tuple(
            dataclasses.replace(manifold, active=manifold.active & may_touch(world, pairs))
            for manifold, pairs in zip(found, self.slots, strict=True)
        )


def may_touch(world: World, pairs: Int[np.ndarray, "q 2"]) -> Bool[Array, "q n"]:
    """Both bodies active and the collision modes allow it."""
    bodies = world.bodies
    a, b = pairs[:, 0], pairs[:, 1]
    mode_a, mode_b = bodies.collision_mode[a], bodies.collision_mode[b]
    return bodies.active[a] & bodies.active[b] & may_push(mode_a, mode_b)


def contact_velocity(
    moving: Moving, point: Vec, a: Int[np.ndarray, " q"], b: Int[np.ndarray, " q"]
) -> Vec:
    """Velocity of body b relative to body a at a point."""
    arm_a, arm_b = point - moving.position[a], point - moving.position[b]
    return (
        moving.velocity[b]
        + spin(moving.omega[b], arm_b)
        - moving.velocity[a]
        - spin(moving.omega[a], arm_a)
    )


def solve_points(
    world: World,
    moving: Moving,
    contacts: Contacts,
    impulses: Impulses,
    here: Bool[Array, "q n"],
    pairs: Int[np.ndarray, "q 2"],
    parameters: Parameters,
) -> tuple[Moving, Impulses]:
    """Solve the chosen points from the current velocities and apply all of them at once."""
    bodies = world.bodies
    a, b = pairs[:, 0], pairs[:, 1]
    manifold = contacts.manifold
    normal = manifold.normal
    tangent = Vec(x=normal.y, y=-normal.x)
    arm_a, arm_b = manifold.point - moving.position[a], manifold.point - moving.position[b]
    mass_a, mass_b = bodies.inverse_mass[a], bodies.inverse_mass[b]
    inertia_a, inertia_b = bodies.inverse_inertia[a], bodies.inverse_inertia[b]

    def effective(direction: Vec) -> Float[Array, "q n"]:
        along_a, along_b = dot(arm_a, direction), dot(arm_b, direction)
        return nonzero(
            mass_a
            + mass_b
            + inertia_a * (dot(arm_a, arm_a) - along_a**2)
            + inertia_b * (dot(arm_b, arm_b) - along_b**2)
        )

    relative = contact_velocity(moving, manifold.point, a, b)
    bias = (
        parameters.baumgarte_collision
        / parameters.dt
        * jnp.maximum(0, manifold.depth - parameters.slop)
    )
    wanted = (bias - dot(relative, normal) - contacts.bounce) / effective(normal)
    total_normal = jnp.maximum(impulses.normal + wanted, 0)
    gained_normal = total_normal - impulses.normal

    # The tangent sees the velocities with this point's own normal impulse in them.
    push = normal * gained_normal
    after = relative + push * (mass_a + mass_b)
    after = (
        after
        + spin(inertia_b * cross(arm_b, push), arm_b)
        + spin(inertia_a * cross(arm_a, push), arm_a)
    )
    bound = parameters.base_friction * contacts.friction * total_normal
    total_tangent = jnp.clip(
        impulses.tangent - dot(after, tangent) / effective(tangent), -bound, bound
    )
    gained_tangent = total_tangent - impulses.tangent

    acts = here & contacts.pushes
    total = jax.tree.map(
        lambda x: jnp.where(acts, x, 0), normal * gained_normal + tangent * gained_tangent
    )
    moving = apply_impulses(world, moving, total, arm_a, arm_b, pairs)
    return moving, Impulses(
        normal=jnp.where(here, jnp.where(contacts.pushes, total_normal, 0), impulses.normal),
        tangent=jnp.where(here, jnp.where(contacts.pushes, total_tangent, 0), impulses.tangent),
    )


def apply_impulses(
    world: World,
    moving: Moving,
    impulse: Vec,
    arm_a: Vec,
    arm_b: Vec,
    pairs: Int[np.ndarray, "q 2"],
) -> Moving:
    """Add impulses on b (and their opposites on a) to the velocities, summed over the pairs."""
    bodies = world.bodies
    count = bodies.inverse_mass.shape[0]
    on_b = (pairs[None, :, 1] == np.arange(count)[:, None]).astype(np.float32)
    on_a = (pairs[None, :, 0] == np.arange(count)[:, None]).astype(np.float32)

    def gather(to_a: Float[Array, "q n"], to_b: Float[Array, "q n"]) -> Float[Array, "b n"]:
        return jnp.asarray(on_b, to_b.dtype) @ to_b - jnp.asarray(on_a, to_a.dtype) @ to_a

    return dataclasses.replace(
        moving,
        velocity=moving.velocity
        + Vec(
            x=gather(impulse.x, impulse.x) * bodies.inverse_mass,
            y=gather(impulse.y, impulse.y) * bodies.inverse_mass,
        ),
        omega=moving.omega
        + gather(cross(arm_a, impulse), cross(arm_b, impulse)) * bodies.inverse_inertia,
    )
