"""Substeps with soft constraints: what `pgs_soft`, `soft_step` and `jacobi` have in common.

A substep is kick – warm start – soft sweeps – drift – relaxing sweeps. The soft sweeps also correct
positions; the relaxing ones demand nothing of positions, so that they take the speed of the
correction out again. Bounces come last, once a step.

Worlds are on the last axis.
Source: Catto (2024), "Solver2D".
"""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.collision import FEATURES, Found, Slots, find_contacts
from kinetix.engine.joints import joint_acts
from kinetix.engine.lookup import marked, onto
from kinetix.engine.maths import dot, unvec, vec
from kinetix.engine.solvers.rows import match
from kinetix.engine.solvers.soft_rows import (
    ContactDrive,
    ContactImpulse,
    JointImpulse,
    MovingBodies,
    Setting,
    SoftContacts,
    SoftJoints,
    Softness,
    SplitMasses,
    Spring,
    bounce_contact,
    contact_push,
    contact_rows,
    drifted,
    joint_push,
    joint_rows,
    kicked,
    moved_gap,
    push_joint,
    push_normal,
    push_tangent,
    relaxed_contacts,
    relaxed_joints,
    soft_contacts,
    soft_joints,
)
from kinetix.engine.solvers.visit import (
    Targets,
    Twist,
    Visit,
    add_changes,
    at_bodies,
    in_turn,
    together,
)
from kinetix.engine.spec import SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


@dataclasses.dataclass(frozen=True, kw_only=True)
class Scheme:
    """Numbers of substeps, sweeps and relax sweeps."""

    substeps: int
    sweeps: int
    """Soft sweeps over all joints and contacts in a substep."""
    relax: int
    """Sweeps without position correction after each drift."""
    bounce: int
    """Sweeps over the bouncing contacts at the end of the step."""
    contact: Spring
    joint: Spring
    split: bool
    """Solve everything at once on split bodies, instead of one after the other."""
    threshold: float
    """Contacts that close slower than this do not bounce [m/s]."""


@pytree
class SoftCache:
    """Accumulated impulses: contacts by key, joints by slot."""

    key: Int[Array, "c n"]
    contacts: ContactImpulse
    joints: JointImpulse


@pytree
class Parts:
    """The contacts of a step, and what contacts and joints act on."""

    contacts: SoftContacts
    contact_targets: Targets
    joint_targets: Targets
    gap: Float[Array, "c n"]
    """At the start of the step [m]."""
    start: Twist
    """Displacement of all bodies at the start of the step."""
    approach: Float[Array, "c n"]
    """Normal speed of the contacts at the start of the step [m/s], negative when closing."""


@pytree
class Drives:
    """Targets of a solve for contacts and joints."""

    contacts: ContactDrive
    joints: Softness


@pytree
class SoftPhase:
    """State that a substep passes to the next."""

    moving: MovingBodies
    joints: SoftJoints
    gap: Float[Array, "c n"]
    contact_impulse: ContactImpulse
    joint_impulse: JointImpulse
    hit: Bool[Array, "c n"]
    """True for contacts that have pushed in any substep."""


def empty_cache(spec: SceneSpec, room: Slots) -> Any:
    """No impulses."""
    points, joints = room.points, spec.capacity.joints

    def zeros(count: int) -> Any:
        return np.zeros(count, np.float32)

    keys: Any = np.full(points, -1, np.int32)
    return SoftCache(
        key=keys,
        contacts=ContactImpulse(normal=zeros(points), tangent=zeros(points)),
        joints=JointImpulse(
            x=zeros(joints), y=zeros(joints), turn=zeros(joints), stop=zeros(joints)
        ),
    )


def soft_step(
    world: World,
    state: State,
    control: Control,
    parameters: Parameters,
    spec: SceneSpec,
    scheme: Scheme,
    room: Slots,
) -> State:
    """One time step, see `AbstractSolver.step`."""
    store = Store.beside(state.rotation)
    found = find_contacts(world, state, parameters, spec, room, store)
    setting = Setting(
        world=world,
        control=jax.tree.map(jnp.nan_to_num, control),
        parameters=parameters,
        masses=store(_masses(world, found, scheme)),
        h=parameters.dt / scheme.substeps,
    )
    moving = MovingBodies(
        position=vec(state.position),
        rotation=state.rotation,
        velocity=Twist(x=state.velocity[:, 0], y=state.velocity[:, 1], turn=state.angular_velocity),
    )
    parts = store(_parts(setting, found, moving))
    cache: SoftCache = state.cache
    normal, tangent = store(
        match(found.points.key, cache.key, cache.contacts.normal, cache.contacts.tangent)
    )
    start = SoftPhase(
        moving=moving,
        joints=store(joint_rows(setting, parts.joint_targets, spec.features, moving)),
        gap=found.points.separation,
        contact_impulse=ContactImpulse(normal=normal, tangent=tangent),
        joint_impulse=cache.joints,
        hit=jnp.zeros(normal.shape, bool),
    )

    def substep(phase: SoftPhase, _: None) -> tuple[SoftPhase, None]:
        return _substep(setting, parts, scheme, spec, store, phase), None

    end, _ = jax.lax.scan(substep, start, None, length=scheme.substeps)
    if spec.features.restitution:
        end = _bounced(parts, end, scheme)
    return finish(
        state,
        end.moving,
        found,
        end.hit,
        parameters,
        SoftCache(key=found.points.key, contacts=end.contact_impulse, joints=end.joint_impulse),
    )


def finish(
    state: State,
    moving: MovingBodies,
    found: Found,
    hit: Bool[Array, "c n"],
    parameters: Parameters,
    cache: Any,
) -> State:
    """The new state, clipped; pairs that pushed each other in the step count as touching."""
    bound, speed = parameters.clip_position, parameters.clip_velocity
    spin = parameters.clip_angular_velocity
    pair = jnp.where(hit, found.points.key // FEATURES, -1)
    velocity = jnp.stack([moving.velocity.x, moving.velocity.y], axis=1)
    return dataclasses.replace(
        state,
        position=jnp.clip(unvec(moving.position), -bound, bound),
        rotation=moving.rotation,
        velocity=jnp.clip(velocity, -speed, speed),
        angular_velocity=jnp.clip(moving.velocity.turn, -spin, spin),
        touching=found.touching | marked(pair, found.touching.shape[0]),
        overflow=found.overflow,
        cache=cache,
    )


def _masses(world: World, found: Found, scheme: Scheme) -> SplitMasses:
    """Inverse masses, and into how many copies each body is split."""
    bodies, joints = world.bodies, world.joints
    linear, angular = bodies.inverse_mass, bodies.inverse_inertia
    copies = jnp.ones_like(linear)
    if scheme.split:
        used = (found.points.key >= 0).astype(linear.dtype)
        acts = joint_acts(world).astype(linear.dtype)
        slots = jnp.zeros_like(linear)
        for counted, body in (
            (used, found.points.body_a),
            (used, found.points.body_b),
            (acts, joints.body_a),
            (acts, joints.body_b),
        ):
            slots += onto(counted, body, linear.shape[0])
        copies = jnp.maximum(slots, 1)
    return SplitMasses(linear=linear, angular=angular, copies=copies)


def _parts(setting: Setting, found: Found, moving: MovingBodies) -> Parts:
    masses, world, points = setting.masses, setting.world, found.points
    targets = masses.targets(points.body_a, points.body_b)
    rows = contact_rows(world, points, targets, masses, setting.parameters)
    velocity = moving.velocity
    approach = dot(
        rows.normal,
        rows.lever.speed(at_bodies(velocity, points.body_a), at_bodies(velocity, points.body_b)),
    )
    return Parts(
        contacts=rows,
        contact_targets=targets,
        joint_targets=masses.targets(world.joints.body_a, world.joints.body_b),
        gap=points.separation,
        start=Twist(x=moving.position.x, y=moving.position.y, turn=moving.rotation),
        approach=approach,
    )


def _substep(
    setting: Setting, parts: Parts, scheme: Scheme, spec: SceneSpec, store: Store, phase: SoftPhase
) -> SoftPhase:
    h, contacts = setting.h, parts.contacts
    moving = kicked(setting, phase.moving)
    moving = dataclasses.replace(
        moving, velocity=store(_warm_started(parts, moving.velocity, phase))
    )
    soft = store(
        Drives(
            contacts=soft_contacts(contacts, phase.gap, scheme.contact, h),
            joints=soft_joints(phase.joints, scheme.joint, h),
        )
    )
    phase = _swept(
        parts, dataclasses.replace(phase, moving=moving), soft, h, scheme.split, scheme.sweeps
    )
    moving = store(drifted(phase.moving, h))
    moved = Twist(x=moving.position.x, y=moving.position.y, turn=moving.rotation) - parts.start
    phase = dataclasses.replace(
        phase,
        moving=moving,
        joints=store(joint_rows(setting, parts.joint_targets, spec.features, moving)),
        gap=store(moved_gap(contacts, parts.contact_targets, parts.gap, moved)),
        hit=phase.hit | (phase.contact_impulse.normal > 0),
    )
    relaxed = store(
        Drives(contacts=relaxed_contacts(phase.gap, h), joints=relaxed_joints(phase.joints))
    )
    phase = _swept(parts, phase, relaxed, h, scheme.split, scheme.relax)
    # A gap that closed exactly at the end of the drift pushes for the first time here.
    return dataclasses.replace(phase, hit=phase.hit | (phase.contact_impulse.normal > 0))


def _warm_started(parts: Parts, velocity: Twist, phase: SoftPhase) -> Twist:
    """Velocities with all accumulated impulses applied."""
    for targets, (push_a, push_b) in (
        (parts.joint_targets, joint_push(phase.joints, phase.joint_impulse)),
        (parts.contact_targets, contact_push(parts.contacts, phase.contact_impulse)),
    ):
        velocity = add_changes(
            velocity,
            targets.body_a,
            targets.body_b,
            push_a * (1 / targets.share_a),
            push_b * (1 / targets.share_b),
        )
    return velocity


def _swept(
    parts: Parts,
    phase: SoftPhase,
    drives: Drives,
    h: Float[Array, " n"],
    split: bool,
    sweeps: int,
) -> SoftPhase:
    """So many visits of all joints, then all contacts, then the friction of all contacts."""
    visit: Visit = together if split else in_turn
    solve_joint = functools.partial(push_joint, h)

    def sweep(_: Any, carry: tuple) -> tuple:
        velocity, contact_impulse, joint_impulse = carry
        velocity, joint_impulse = visit(
            velocity, parts.joint_targets, (phase.joints, drives.joints), joint_impulse, solve_joint
        )
        velocity, contact_impulse = visit(
            velocity,
            parts.contact_targets,
            (parts.contacts, drives.contacts),
            contact_impulse,
            push_normal,
        )
        velocity, contact_impulse = visit(
            velocity, parts.contact_targets, parts.contacts, contact_impulse, push_tangent
        )
        return velocity, contact_impulse, joint_impulse

    velocity, contact_impulse, joint_impulse = jax.lax.fori_loop(
        0, sweeps, sweep, (phase.moving.velocity, phase.contact_impulse, phase.joint_impulse)
    )
    return dataclasses.replace(
        phase,
        moving=dataclasses.replace(phase.moving, velocity=velocity),
        contact_impulse=contact_impulse,
        joint_impulse=joint_impulse,
    )


def _bounced(parts: Parts, phase: SoftPhase, scheme: Scheme) -> SoftPhase:
    """Contacts that came in fast and pushed leave with their share of the speed of approach."""
    bounces = phase.hit & (parts.approach < -scheme.threshold)
    wanted = jnp.where(bounces, -parts.contacts.restitution * parts.approach, 0)
    visit: Visit = together if scheme.split else in_turn

    def sweep(_: Any, carry: tuple) -> tuple:
        return visit(
            carry[0], parts.contact_targets, (parts.contacts, wanted), carry[1], bounce_contact
        )

    velocity, impulse = jax.lax.fori_loop(
        0, scheme.bounce, sweep, (phase.moving.velocity, phase.contact_impulse)
    )
    return dataclasses.replace(
        phase, moving=dataclasses.replace(phase.moving, velocity=velocity), contact_impulse=impulse
    )
