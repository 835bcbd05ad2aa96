"""Impacts within a substep: bounces, blows passed on, what held until then. Worlds last.

A substep sees its forces and its impacts at once. What depends on their order is put right here.
"""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants
from kinetix.engine.lookup import row
from kinetix.engine.maths import Vec, dot, nonzero
from kinetix.engine.solvers.direct.blocks import AbstractBlock, Cone
from kinetix.engine.solvers.direct.contact_system import ContactSystem
from kinetix.engine.solvers.rows import Velocity, speeds
from kinetix.pytree import pytree

Impulses = Float[Array, "m n"]


def bounces(
    system: ContactSystem,
    before: Float[Array, "c n"],
    gap: Float[Array, "g n"],
    push: tuple[Vec, Float[Array, "b n"]],
    closed: Bool[Array, "c n"],
    h: Float[Array, " n"],
) -> tuple[Float[Array, "c n"], Float[Array, " n"]]:
    """Return the separation speed of every contact that closed in this substep.

    The approach speed is that of the moment of touching, wherever in the substep it lies, so that
    the energy after the bounce does not depend on it.

    Returns:
        The speeds, and the speed below which contacts do not bounce [m/s].
    """
    count = system.friction.shape[0]
    linear, angular = push
    closing = -speeds(system.gaps, Velocity(linear=linear, angular=angular))[:count]
    free_fall = jnp.maximum(closing, 0)
    speed = jnp.sqrt(jnp.maximum(0, before**2 + 2 * free_fall * jnp.maximum(gap[:count], 0)))
    hardest = jnp.sqrt(dot(linear, linear)).max(axis=0)
    threshold = jnp.maximum(2 * h * hardest, constants.LEAST_BOUNCE)
    hit = closed & (speed > threshold) & (before < 0)
    return jnp.where(hit, system.restitution * speed, 0), threshold


def knocks(
    block: AbstractBlock,
    system: ContactSystem,
    offset: Impulses,
    bounce: Float[Array, "c n"],
    cone: Cone,
    threshold: Float[Array, " n"],
    passes: int,
) -> tuple[Impulses, Impulses]:
    """Pass blows on, one after the other: what a blow sets in motion hits in the next pass.

    Args:
        block: Who solves.
        system: Contacts and limits.
        offset: Speeds of all rows without the contacts' impulses.
        bounce: Speeds with which the contacts leave that hit by themselves; 0 for the rest.
        cone: Which contacts are closed.
        threshold: Contacts that close more slowly do not bounce [m/s].
        passes: At most.

    Returns:
        The rows' speeds after all blows, and the impulses of the blows.
    """
    count = system.friction.shape[0]

    def going(carry: tuple) -> Bool[Array, ""]:
        _, _, bounce, number = carry
        return jnp.any(bounce > 0) & (number < passes)

    def blow(carry: tuple) -> tuple:
        offset, knock, bounce, number = carry
        # A world without a blow stays as it is, whatever happens in the others of its tile.
        struck = jnp.any(bounce > 0, axis=0)
        hit = dataclasses.replace(cone, closed=bounce > 0, limited=cone.limited & struck)
        wanted = offset.at[:count].add(-bounce)
        impulse = block.solve(system.prepared, system.responses, wanted, jnp.zeros_like(knock), hit)
        change = system.responses.speeds(impulse)
        share = _share_without_gain(impulse, offset, change)
        impulse, offset = impulse * share, offset + change * share
        closing = -offset[:count]
        again = cone.closed & (closing > threshold)
        bounce = jnp.where(again, system.restitution * closing, 0)
        return offset, knock + impulse, bounce, number + 1

    carry = (offset, jnp.zeros_like(offset), bounce, jnp.zeros((), jnp.int32))
    return jax.lax.while_loop(going, blow, carry)[:2]


def _share_without_gain(
    impulse: Impulses, speeds: Impulses, change: Impulses
) -> Float[Array, " n"]:
    """Return the share of impulses up to which they give a world no energy.

    Newton's restitution gives some where friction or a wedge turns a blow (Kane and Levinson,
    1985, "Dynamics: Theory and Applications").
    """
    first = jnp.sum(impulse * speeds, axis=0)
    second = 0.5 * jnp.sum(impulse * change, axis=0)
    gains = first + second > 1e-3 * jnp.abs(first)
    return jnp.where(gains, jnp.clip(-first / nonzero(second), 0, 1), 1)


@pytree
class Carried:
    """Impulses of contacts that hold a body until an impact, and the speeds that they leave."""

    share: Impulses
    """Given in this substep, up to the first impact on one of a contact's bodies [N·s]."""
    speeds: Impulses
    """Of all rows after it [m/s]."""
    struck: Bool[Array, "m n"]
    """True for rows of contacts on whose bodies an impact came."""
    impact: Bool[Array, " n"]
    """True for worlds in which one came."""


def until_the_impact(
    system: ContactSystem,
    force: Impulses,
    offset: Impulses,
    closed: Bool[Array, "c n"],
    before: Float[Array, "c n"],
    gap: Float[Array, "g n"],
    h: Float[Array, " n"],
) -> Carried:
    """Apply the resting impulses up to the first impact within the substep.

    A contact that an impact opens has carried the body up to then. Without that share a block that
    rocks lost half as much energy again at each impact as it should, and a ball at each corner of a
    valley.

    Args:
        system: Contacts and limits.
        force: Impulses that the last substep kept: see `kept`.
        offset: Speeds of all rows.
        closed: Which contacts are closed at the end of this substep.
        before: Speeds of the contacts at its start.
        gap: Gaps at its start.
        h: The substep [s].
    """
    count = before.shape[0]
    open_before = gap[:count] > constants.CLOSED_DISTANCE
    hits = closed & open_before & (before < 0)

    def given() -> Carried:
        time = jnp.clip(gap[:count] / nonzero(-before * h), 0, 1)
        left = _left_to_bodies(system, jnp.where(hits, jnp.maximum(1 - time, 1e-6), 0))
        share = jnp.where((left > 0) & ~hits, 1 - left, 0)
        limits = jnp.zeros_like(gap[count:])
        impulse = jnp.concatenate([share, share, limits], axis=0) * force
        return Carried(
            share=impulse,
            speeds=offset + system.responses.speeds(impulse),
            struck=jnp.concatenate([left > 0, left > 0, limits > 0], axis=0),
            impact=jnp.any(hits, axis=0),
        )

    def all_of_it() -> Carried:
        nothing = jnp.zeros_like(offset)
        return Carried(share=nothing, speeds=offset, struck=nothing > 0, impact=h < 0)

    return jax.lax.cond(jnp.any(hits), given, all_of_it)


def kept(
    carried: Carried, force: Impulses, bias: Impulses, relax: Impulses
) -> tuple[Impulses, Impulses]:
    """Return the impulses of both solves with which the next substep begins, without blows.

    On bodies that were struck the force from before goes on, half in each. Elsewhere nothing tells
    a load from a blow that ran through a row of bodies, so no force grows in such a substep:
    given once more, the blow would shoot the row off.

    Args:
        carried: What was given until the impact.
        force: Impulses that the last substep kept, both solves together.
        bias: Of this substep's first solve.
        relax: Of its second.
    """
    as_before = jnp.clip(force / nonzero(bias + relax), 0, 1)
    part = jnp.where(carried.impact, as_before, 1)
    return (
        jnp.where(carried.struck, force / 2, bias * part),
        jnp.where(carried.struck, force / 2, relax * part),
    )


def _left_to_bodies(system: ContactSystem, left: Float[Array, "c n"]) -> Float[Array, "c n"]:
    """Return the largest value of all contacts that share a free body with each contact."""
    links = system.rows.links
    left = jnp.concatenate([left, jnp.zeros_like(links.body_a[len(left) :], left.dtype)], axis=0)
    numbers = np.arange(system.free.shape[0])[:, None]

    def add(k: Int[Array, ""], most: Float[Array, "b n"]) -> Float[Array, "b n"]:
        here = (numbers == row(links.body_a, k)) | (numbers == row(links.body_b, k))
        return jnp.where(here & system.free, jnp.maximum(most, row(left, k)), most)

    nobody = jnp.zeros(system.free.shape, left.dtype)
    left_a, left_b = links.look_up(links.in_use.each_link(add, nobody))
    return jnp.maximum(left_a, left_b)[: system.friction.shape[0]]
