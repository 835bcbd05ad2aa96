"""Contacts and joint limits of a step as one system, the joints eliminated. Worlds last.

Only rows that a world of the tile uses are computed: a scene of size l has room for 20 points and
mostly meets four.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants
from kinetix.engine.active_rows import InUse
from kinetix.engine.collision import Found
from kinetix.engine.joints import next_limit
from kinetix.engine.lookup import put, row
from kinetix.engine.maths import Vec, nonzero
from kinetix.engine.solvers.direct.blocks import AbstractBlock
from kinetix.engine.solvers.direct.joint_system import JointSystem, Step
from kinetix.engine.solvers.direct.masses import masses_of
from kinetix.engine.solvers.direct.response import Responses, speed_of_row
from kinetix.engine.solvers.rows import (
    Directions,
    Links,
    Rows,
    Velocity,
    apply,
    coupling,
    diagonal,
    first_of_links,
    make_rows,
    one_row,
    through_points,
    turning,
)
from kinetix.engine.spec import ARENA_BODIES
from kinetix.engine.types import State, World
from kinetix.pytree import pytree


@pytree
class ContactSystem:
    """The rows of a step that push one way: contacts and joint limits. Fixed for the whole step."""

    rows: Rows
    live: Bool[Array, "m n"]
    responses: Responses
    """Responses of all bodies to the impulses, with the joints eliminated."""
    answers: Float[Array, "m k n"]
    """Impulses of the joints that answer to one on a row, as they stand when the step begins."""
    contrast: Float[Array, " n"]
    """Sum of the ratios of unlike loads, and of what the most burdened body bears."""
    prepared: Any
    gaps: Rows
    """Those of the rows that have a gap: the contacts' normals and the limits."""
    most_push: Float[Array, "c n"]
    """Speed at which an overlap is resolved at most [m/s]."""
    friction: Float[Array, "c n"]
    restitution: Float[Array, "c n"]
    loose: Float[Array, "c n"]
    """The smaller value of its two bodies (`Step.loose`)."""
    pivoted: Float[Array, "c n"]
    """1 if a body turns on a fixed pivot and neither is joined to a moving body, else 0."""
    free: Bool[Array, "b n"]
    """True for bodies that are not fixed."""


def contact_system(
    step: Step,
    state: State,
    found: Found,
    joints: JointSystem,
    block: AbstractBlock,
    bears: Float[Array, "b n"],
) -> tuple[ContactSystem, Float[Array, "g n"]]:
    """Return the contacts and limits at the start of a step.

    Args:
        step: The worlds, what drives them, and the masses.
        state: At the start.
        found: The contacts.
        joints: The joints at the same pose.
        block: Who will solve the system.
        bears: What each body bears [kg].

    Returns:
        The system, and the gaps of the contacts [m] and limits [rad].
    """
    store = step.store
    points, bodies = found.points, step.world.bodies
    normal = points.normal
    tangent = Vec(x=normal.y, y=-normal.x)
    used = points.key >= 0
    touching = Links(body_a=points.body_a, body_b=points.body_b, in_use=InUse.of((used, 2)))
    limited, limits, limit_live, limit_gap = _limit_directions(step, state)
    links = Links.joined(touching, limited)
    rows = make_rows(
        links,
        links.look_up(step.masses),
        [
            *(through_points(way, points.arm_a, points.arm_b) for way in (normal, tangent)),
            limits,
        ],
        store,
    )
    live = jnp.concatenate([used, used, limit_live], axis=0)
    mobility = store(diagonal(rows))
    of_rows, answers, answered, by_other = _responses(rows, used.shape[0], joints, step)
    own = mobility + answered
    live = store(live & (own > constants.LEAST_PIVOT * mobility))
    # Bodies that joints hold may overlap beyond remedy; yielding bounds what pushes them apart.
    deep = jnp.concatenate(
        [points.separation < -constants.DEEP, jnp.zeros_like(used), jnp.zeros_like(limit_live)]
    )
    yields = deep & (own < constants.HELD * mobility)
    compliance = jnp.where(yields, constants.DEEP_COMPLIANCE * mobility, 0)
    responses = Responses(
        rows=rows,
        of_rows=of_rows,
        compliance=compliance,
        normal_by_tangent=by_other[used.shape[0] : 2 * used.shape[0]],
        inverse_own=jnp.where(live, 1 / nonzero(own + compliance), 0),
    )
    responses = dataclasses.replace(
        responses,
        compliance=store(responses.compliance),
        inverse_own=store(responses.inverse_own),
    )
    loads = _loads(step.world)
    of_a, of_b = touching.look_up(
        (bodies.friction, bodies.restitution, loads, step.loose, step.pivoted)
    )
    friction_a, restitution_a, load_a, loose_a, pivoted_a = of_a
    friction_b, restitution_b, load_b, loose_b, pivoted_b = of_b
    friction = jnp.sqrt(friction_a**2 + friction_b**2)
    contrast = _contrast(load_a, load_b, used) + _burden(bears, loads)
    system = ContactSystem(
        rows=rows,
        gaps=first_of_links(rows),
        live=live,
        responses=responses,
        answers=answers,
        contrast=contrast,
        prepared=block.prepare(responses, contrast),
        # A body that turns on a pivot right behind the contact has to turn far to part by little.
        most_push=store(
            constants.PUSH_SPEED * jnp.sqrt(jnp.clip(own / nonzero(mobility), 0, 1)[: len(used)])
        ),
        friction=store(step.parameters.base_friction * friction),
        restitution=store(jnp.minimum(restitution_a, restitution_b)),
        loose=store(jnp.minimum(loose_a, loose_b)),
        pivoted=store(jnp.clip(pivoted_a + pivoted_b, 0, 1)),
        free=bodies.inverse_mass > 0,
    )
    return system, jnp.concatenate([points.separation, limit_gap], axis=0)


def pushed(
    step: Step, system: ContactSystem, impulse: Float[Array, "m n"], velocity: Velocity
) -> tuple[Velocity, Float[Array, "k n"]]:
    """The velocities after impulses on the rows, for joints that have turned since the step began.

    Joints on fixed pivots respond as at the start of the step, as was assumed when the impulses
    were chosen. With the present response, an arm that has swung past the lowest point would be
    flung by the force that supported it. Joints between moving bodies respond as they are now;
    otherwise the earlier tension of a taut chain would add energy.

    Args:
        step: The masses.
        system: The contacts and limits.
        impulse: On its rows.
        velocity: Before.

    Returns:
        The velocities after, and what joints have answered; present answers are still to come.
    """
    if system.answers.shape[1] == 0:
        return apply(system.rows, impulse, velocity, step.masses), jnp.zeros_like(impulse[:0])
    limits = jnp.zeros_like(impulse[2 * len(system.pivoted) :])
    foreseen = impulse * jnp.concatenate([system.pivoted, system.pivoted, limits], axis=0)
    motion = system.responses.moved(foreseen)
    x, y, turn = (jnp.pad(part, ((ARENA_BODIES, 0), (0, 0))) for part in motion)
    velocity += Velocity(linear=Vec(x=x, y=y), angular=turn)

    def add(k: Int[Array, ""], total: Float[Array, "k n"]) -> Float[Array, "k n"]:
        return total + row(system.answers, k)[0] * row(foreseen, k)[0]

    nothing = jnp.zeros(system.answers.shape[1:], impulse.dtype)
    answer = system.rows.links.in_use.each(add, nothing)
    return apply(system.rows, impulse - foreseen, velocity, step.masses), answer


def _responses(
    rows: Rows, count: int, joints: JointSystem, step: Step
) -> tuple[
    Float[Array, "m 3 b n"], Float[Array, "m k n"], Float[Array, "m n"], Float[Array, "m n"]
]:
    """Compute what each row in use does.

    Args:
        rows: Normals of `count` contacts, their tangents, then limits.
        count: How many contacts there are.
        joints: They answer to each row.
        step: Masses, and what keeps intermediate results.

    Returns:
        The change of all velocities, the joints' answers, what these do to the row itself, and
        what a tangent row does to its normal row.
    """
    store, masses, live = step.store, step.masses, step.held.live
    worlds, bodies = rows.turn_a.shape[-1], masses.angular.shape[0]
    nothing = jnp.zeros((len(rows.turn_a), 3, bodies - ARENA_BODIES, worlds), rows.turn_a.dtype)
    still = jnp.zeros_like(masses.angular)
    at_rest = Velocity(linear=Vec(x=still, y=still), angular=still)
    answering = joints.rows.links.in_use
    unit = jnp.ones((1, worlds), rows.turn_a.dtype)

    def visit(k: Int[Array, ""], carry: tuple[Array, ...]) -> tuple[Array, ...]:
        responses, answers, answered, by_other = carry
        one = one_row(rows, k)
        moved = apply(one, unit, at_rest, masses)
        if live.shape[0]:
            pull = store(jnp.where(live, coupling(joints.rows, one)[:, 0], 0))
            given = store(jnp.where(live, answering.product(joints.answers, pull), 0))
            moved = apply(joints.rows, given, moved, masses)
            answers = put(answers, given[None], k, 0)
            answered = put(answered, answering.inner(pull, given)[None], k, 0)
        motion = jnp.stack([moved.linear.x, moved.linear.y, moved.angular])[:, ARENA_BODIES:]
        motion = store(motion)
        on_normal = speed_of_row(rows, jnp.maximum(k - count, 0), motion)
        return (
            put(responses, motion[None], k, 0),
            answers,
            answered,
            put(by_other, on_normal[None], k, 0),
        )

    none = jnp.zeros_like(rows.turn_a)
    unanswered = jnp.zeros((len(none), *live.shape), none.dtype)
    start = (nothing, unanswered, none, none)
    of_rows, answers, answered, by_other = rows.links.in_use.each(visit, start)
    return of_rows, answers, answered, by_other


def _loads(world: World) -> Float[Array, "b n"]:
    """The mass that goes with each body: its own and that of all it is jointed to; 0 if fixed."""
    mass = masses_of(world)

    def add(k: Int[Array, ""], total: Float[Array, "b n"]) -> Float[Array, "b n"]:
        together = ~row(world.collides, k)[0] & (mass > 0)
        return total + jnp.where(together, row(mass, k), 0)

    return jax.lax.fori_loop(0, mass.shape[0], add, jnp.zeros_like(mass))


def _contrast(
    load_a: Float[Array, "c n"], load_b: Float[Array, "c n"], used: Bool[Array, "c n"]
) -> Float[Array, " n"]:
    """Return how unlike the loads of touching bodies are: their ratios beyond the usual ones.

    Several pairs that are a little unlike slow sweeps down as much as a pair that is very unlike.
    """
    ratio = jnp.maximum(load_a, load_b) / nonzero(jnp.minimum(load_a, load_b))
    unlike = used & (load_a > 0) & (load_b > 0) & (ratio > constants.USUAL_CONTRAST)
    return jnp.sum(jnp.where(unlike, ratio, 0), axis=0)


def _burden(bears: Float[Array, "b n"], loads: Float[Array, "b n"]) -> Float[Array, " n"]:
    """Return the largest load that lies on any body, in weights of that body, times a factor.

    It is 0 up to the usual. What lies on a body slows sweeps down, though no two neighbours need be
    unlike.
    """
    burden = jnp.where(loads > 0, bears / nonzero(loads), 0)
    most = jnp.max(burden, axis=0)
    return jnp.where(most > constants.USUAL_BURDEN, constants.WEIGHT_OF_BURDEN * most, 0)


def _limit_directions(
    step: Step, state: State
) -> tuple[Links, Directions, Bool[Array, "j n"], Float[Array, "j n"]]:
    """Return one row a joint with limits: the next of its two; its gap is the angle left [rad].

    No row at all in a scene without limits.
    """
    world, held = step.world, step.held
    joints, of_rows = world.joints, held.rows
    nothing = jnp.zeros_like(joints.reference_angle[:0])
    if not step.features.limits:
        nobody = nothing.astype(jnp.int32)
        none = nothing.astype(bool)
        links = Links(body_a=nobody, body_b=nobody, in_use=InUse.of((none, 1)))
        return links, turning(nothing), none, nothing
    (angle_a, spin_a), (angle_b, spin_b) = held.links.look_up(
        (state.rotation, state.angular_velocity)
    )
    angle, turn = angle_b - angle_a - joints.reference_angle, (spin_b - spin_a) * step.parameters.dt
    side, left = next_limit(world, angle, turn)
    count = side.shape[0]
    acts = held.acts & joints.limited & ~joints.fixed
    acts &= of_rows.inertia_a[:count] + of_rows.inertia_b[:count] > 0
    links = dataclasses.replace(held.links, in_use=InUse.of((acts, 1)))
    return links, turning(side), acts, left
