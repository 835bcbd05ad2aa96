"""Ends of episodes and their rewards: touches of green with blue and with red."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.engine.types import World
from kinetix.environment.state import NO_DISTANCE
from kinetix.level.compile import Labels
from kinetix.level.features import capacity_of_world

NEUTRAL, GREEN, BLUE, RED = range(4)
GOAL_TOUCH = GREEN * BLUE
DEATH_TOUCH = GREEN * RED


def touch_matrix(touching: Bool[Array, " q"], capacity: Capacity) -> Bool[Array, "b b"]:
    """Return the candidate pairs' flags as a matrix, each at (first, second) of its pair only.

    Slices and concatenation instead of a scatter: the pairs of one row of the matrix lie side by
    side in the list, so that under vmap this is nothing but copying.

    Args:
        touching: Flags in the order of `kinetix.engine.pairs.candidate_pairs`.
        capacity: The sizes that the list was made for.
    """
    polygons, circles = capacity.polygons, capacity.circles
    rows, start = [], 0
    for polygon in range(polygons):
        first = max(polygon + 1, ARENA_BODIES)
        count = max(polygons - first, 0)
        rows.append(_row(touching[start : start + count], capacity.bodies, first))
        start += count
    polygon_rows = start
    start += circles * polygons
    for circle in range(circles):
        with_polygons = touching[polygon_rows + circle * polygons :][:polygons]
        count = circles - circle - 1
        gap = jnp.zeros(circle + 1, bool)
        rows.append(jnp.concatenate([with_polygons, gap, touching[start : start + count]]))
        start += count
    return jnp.stack(rows)


def _row(flags: Bool[Array, " k"], width: int, offset: int) -> Bool[Array, " b"]:
    """Return the flags from column `offset` on, false elsewhere."""
    return (
        jnp.pad(flags, (offset, width - offset - flags.shape[0]))
        if flags.size
        else jnp.zeros(width, bool)
    )


def active_roles(world: World, labels: Labels) -> Int[Array, " b"]:
    """Roles; bodies that are not active have none."""
    return jnp.where(world.bodies.active, labels.role, 0)


def sparse_reward(
    touching: Bool[Array, " q"], world: World, labels: Labels, *, includes_joined: bool
) -> Float[Array, ""]:
    """Return the reward of one physics step.

    Args:
        touching: Which candidate pairs touched.
        world: Its shapes give the capacity.
        labels: The roles.
        includes_joined: Whether pairs of one jointed component count.

    Returns:
        −1 where green touches red, otherwise +1 where green touches blue, otherwise 0.
    """
    first, second = candidate_pairs(capacity_of_world(world)).T
    if not includes_joined:
        touching = touching & world.collides[first, second]
    role = active_roles(world, labels)
    product = role[first] * role[second]
    goal = jnp.any(touching & (product == GOAL_TOUCH))
    death = jnp.any(touching & (product == DEATH_TOUCH))
    return jnp.where(death, -1.0, jnp.where(goal, 1.0, 0.0))


def goal_distance(position: Float[Array, "b 2"], world: World, labels: Labels) -> Float[Array, ""]:
    """Return the sum over all pairs of a green and a blue body of their positions' distance [m]."""
    role = active_roles(world, labels)
    pairs = (role[:, None] == GREEN) & (role[None, :] == BLUE)
    x, y = position[:, 0], position[:, 1]
    squared = (x[:, None] - x[None, :]) ** 2 + (y[:, None] - y[None, :]) ** 2
    return jnp.sum(jnp.sqrt(jnp.where(pairs, squared, 0.0)))


def dense_reward(
    distance: Float[Array, ""], last_distance: Float[Array, ""], scale: float
) -> Float[Array, ""]:
    """Return the reward of coming closer: the distance lost in this step times the scale.

    0 in the first step of an episode (the last distance is −1) and where the result is not finite.
    """
    gain = -(distance - last_distance) * scale
    counts = jnp.isfinite(gain) & (last_distance != NO_DISTANCE)
    return jnp.where(counts, gain, 0.0)
