"""All shapes of a step, and which pairs of them may push each other. Worlds on the last axis."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants
from kinetix.engine.collision.moving import MovingCircle, MovingPolygon
from kinetix.engine.lookup import take
from kinetix.engine.maths import Vec, dot, length, vec
from kinetix.engine.pairs import may_push
from kinetix.engine.shapes import Polygons, rows, turn_polygons
from kinetix.engine.store import Store
from kinetix.engine.types import Parameters, State, World
from kinetix.pytree import pytree

Pairs = tuple[Int[np.ndarray, " q"], Int[np.ndarray, " q"]]
"""Bodies a and bodies b of the candidate pairs."""


@pytree
class MovingShapes:
    """Poses and velocities of all shapes."""

    polygons: Polygons
    radius: Float[Array, "r n"]
    centre: Vec
    velocity: Vec
    spin: Float[Array, "b n"]
    store: Store

    @staticmethod
    def of(world: World, state: State, store: Store) -> "MovingShapes":
        """Return the shapes at the start of a step."""
        polygons = store(turn_polygons(world.bodies, state.rotation))
        centre, velocity = store((vec(state.position), vec(state.velocity)))
        return MovingShapes(
            polygons=polygons,
            radius=world.bodies.radius,
            centre=centre,
            velocity=velocity,
            spin=state.angular_velocity,
            store=store,
        )

    def listed(self, shape: str, bodies: Int[np.ndarray, " q"]) -> MovingCircle | MovingPolygon:
        """Return shapes by indices that are the same in every world."""
        return self._picked(shape, bodies, _rows)

    def chosen(self, shape: str, bodies: Int[Array, "k n"]) -> MovingCircle | MovingPolygon:
        """Return shapes by indices that differ from world to world."""
        return self._picked(shape, bodies, take)

    def _picked(
        self, shape: str, bodies: Any, pick: Callable[[Any, Any], Any]
    ) -> MovingCircle | MovingPolygon:
        polygons = self.polygons
        centre, velocity, spin = pick((self.centre, self.velocity, self.spin), bodies)
        if shape == "circle":
            radius = pick(self.radius, bodies - polygons.offsets.shape[0])
            return MovingCircle(centre=centre, velocity=velocity, radius=radius)
        corners, normals, offsets = self.store(
            pick((polygons.corners, polygons.normals, polygons.offsets), bodies)
        )
        return MovingPolygon(
            centre=centre,
            velocity=velocity,
            corners=corners,
            normals=normals,
            offsets=offsets,
            spin=spin,
        )


def _rows(tree: Any, bodies: Int[np.ndarray, " q"]) -> Any:
    return jax.tree.map(lambda x: rows(x, bodies), tree)


@pytree
class Rules:
    """Rules of the candidate pairs, distances aside."""

    may_touch: Bool[Array, "q n"]
    pushes: Bool[Array, "q n"]
    margin: Float[Array, "q n"]
    """Distance at which a contact is seen [m]."""

    @staticmethod
    def of(
        world: World, state: State, parameters: Parameters, shapes: MovingShapes, pairs: Pairs
    ) -> "Rules":
        """Return the rules of a step."""
        a, b = pairs
        bodies = world.bodies
        may_touch = bodies.active[a] & bodies.active[b]
        may_touch &= may_push(bodies.collision_mode[a], bodies.collision_mode[b])
        movable = (bodies.inverse_mass[a] > 0) | (bodies.inverse_mass[b] > 0)
        # A corner covers ω·R·dt on top of its centre's way; a circle's turning moves nothing.
        radius = jnp.concatenate([shapes.polygons.radius, jnp.zeros_like(bodies.radius)], axis=0)
        sweep = jnp.abs(state.angular_velocity) * jnp.where(bodies.active, radius, 0)
        closing = length(shapes.velocity[b] - shapes.velocity[a])
        closing = jnp.maximum(closing, _followed(shapes, pairs))
        ahead = parameters.dt * (closing + sweep[a] + sweep[b]) + constants.ACCELERATION_MARGIN
        return Rules(
            may_touch=may_touch,
            pushes=may_touch & movable & world.collides[a, b],
            margin=jnp.maximum(constants.SPECULATIVE_DISTANCE, ahead),
        )


def _followed(shapes: MovingShapes, pairs: Pairs) -> Float[Array, "q n"]:
    """Speed at which one body of a pair flies towards where the other one is [m/s].

    Bodies that fly behind each other do not close in until something stops the first one; the next
    one runs into it within the same step.
    """
    a, b = pairs
    apart = shapes.centre[b] - shapes.centre[a]
    towards_b = dot(shapes.velocity[a], apart) > 0
    towards_a = dot(shapes.velocity[b], apart) < 0
    return jnp.maximum(
        jnp.where(towards_b, length(shapes.velocity[a]), 0),
        jnp.where(towards_a, length(shapes.velocity[b]), 0),
    )
