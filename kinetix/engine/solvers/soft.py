"""Substeps with soft constraints: one solver, and the three settings `SOFT` of it.

The solve also corrects positions; `relax` demands nothing of positions, so that it takes the speed
of the correction out again. Restitution comes last, once per step.

Worlds are on the last axis.
Source: Catto (2011), "Soft Constraints"; Catto (2024), "Solver2D".
"""

import dataclasses
import functools
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.collision import FEATURES, Found, Slots, find_contacts
from kinetix.engine.joints import joint_acts
from kinetix.engine.lookup import marked, onto
from kinetix.engine.maths import dot, unvec, vec
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import usual_room
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
from kinetix.engine.spec import Features, SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


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


@dataclasses.dataclass(frozen=True, kw_only=True)
class Soft(AbstractSolver):
    """Soft constraints: projected Gauss–Seidel or mass splitting, in substeps or sweeps.

    Soft constraints take their share of a position error away without the energy that Baumgarte's
    bias leaves behind.
    """

    substeps: int = 1
    sweeps: int = 1
    """Soft sweeps over all joints and contacts in a substep."""
    relax: int = 1
    """Sweeps without position correction after the positions of a substep."""
    bounce: int = 1
    """Sweeps over the bouncing contacts at the end of the step."""
    contact: Spring
    joint: Spring
    split: bool = False
    """Solve everything at once on split bodies, instead of one after the other."""
    threshold: float = 1.0
    """Contacts that close slower than this do not bounce [m/s]."""
    slots: Slots | None = None
    """Room for contacts; None: by the capacity."""

    def slots_for(self, spec: SceneSpec) -> Slots:
        """Return the room for contacts in scenes of this capacity."""
        return self.slots or usual_room(spec)

    def empty_cache(self, spec: SceneSpec) -> Any:
        """Return a cache without impulses."""
        points, joints = self.slots_for(spec).points, spec.capacity.joints

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

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """See the contract."""
        store = Store.beside(state.rotation)
        found = find_contacts(world, state, parameters, spec, self.slots_for(spec), store)
        step, start = _prepared(self, world, state, control, parameters, spec, found, store)

        def substep(phase: SoftPhase, _: None) -> tuple[SoftPhase, None]:
            phase = step.integrate_velocities(phase)
            phase = step.warm_start(phase)
            phase = step.solve(phase)
            phase = step.integrate_positions(phase)
            return step.relax(phase), None

        end, _ = jax.lax.scan(substep, start, None, length=self.substeps)
        if spec.features.restitution:
            end = step.restitution(end)
        return finish(
            state,
            end.moving,
            found,
            end.hit,
            parameters,
            SoftCache(key=found.points.key, contacts=end.contact_impulse, joints=end.joint_impulse),
        )


SOFT: Final = {
    # One kick, soft sweeps, one drift, relaxing sweeps. What Gauss–Seidel cannot do: heavy loads on
    # light bodies, long chains and welds; and a single explicit step is of first order.
    "pgs_soft": Soft(
        sweeps=8,
        relax=4,
        contact=Spring(hertz=30.0, damping=10.0, share=0.5),
        joint=Spring(hertz=60.0, damping=2.0, share=0.5),
    ),
    # The method "TGS soft" of Box2D 3 with its published settings. A substep is as good as many
    # sweeps, since its errors shrink with the square of its length. Loads of a thousand times a
    # link's mass still tear chains, long welds sag, a box sinks under a hundred times its mass, and
    # an elastic ball loses up to 8 % of its energy per bounce: it leaves with the speed of the
    # start of the step, not with that of the impact.
    "soft_step": Soft(
        substeps=4,
        contact=Spring(hertz=30.0, damping=10.0, share=0.25),
        joint=Spring(hertz=60.0, damping=2.0, share=0.25),
    ),
    # A body with k contacts and joints is split into k bodies of a k-th of its mass; every contact
    # is solved on its own copies, then the copies are averaged. That converges where plain Jacobi
    # overshoots, and is wide instead of deep; but it takes four to five times the iterations of
    # Gauss–Seidel, so stacks, chains and welds are soft. Source: Tonge, Benevolenski & Voroshilov
    # (2012), "Mass Splitting for Jitter-Free Parallel Rigid Body Simulation".
    "jacobi": Soft(
        sweeps=24,
        relax=12,
        bounce=4,
        split=True,
        contact=Spring(hertz=30.0, damping=10.0, share=0.5),
        joint=Spring(hertz=60.0, damping=2.0, share=0.5),
    ),
}
"""The settings by name."""


def _prepared(  # noqa: PLR0913 (everything that a step depends on)
    solver: Soft,
    world: World,
    state: State,
    control: Control,
    parameters: Parameters,
    spec: SceneSpec,
    found: Found,
    store: Store,
) -> tuple["_Step", SoftPhase]:
    """The constants of a step, and the state in which its first substep begins."""
    setting = Setting(
        world=world,
        control=jax.tree.map(jnp.nan_to_num, control),
        parameters=parameters,
        masses=store(_masses(world, found, split=solver.split)),
        h=parameters.dt / solver.substeps,
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
    step = _Step(solver=solver, setting=setting, parts=parts, features=spec.features, store=store)
    return step, start


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


def _masses(world: World, found: Found, *, split: bool) -> SplitMasses:
    """Inverse masses, and into how many copies each body is split."""
    bodies, joints = world.bodies, world.joints
    linear, angular = bodies.inverse_mass, bodies.inverse_inertia
    copies = jnp.ones_like(linear)
    if split:
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


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Step:
    """The stages of a substep, with all that stays the same in a step."""

    solver: Soft
    setting: Setting
    parts: Parts
    features: Features
    store: Store

    def integrate_velocities(self, phase: SoftPhase) -> SoftPhase:
        """Apply gravity, thrusters and motors."""
        return dataclasses.replace(phase, moving=kicked(self.setting, phase.moving))

    def warm_start(self, phase: SoftPhase) -> SoftPhase:
        """Apply all accumulated impulses."""
        velocity = phase.moving.velocity
        for targets, (push_a, push_b) in (
            (self.parts.joint_targets, joint_push(phase.joints, phase.joint_impulse)),
            (self.parts.contact_targets, contact_push(self.parts.contacts, phase.contact_impulse)),
        ):
            velocity = add_changes(
                velocity,
                targets.body_a,
                targets.body_b,
                push_a * (1 / targets.share_a),
                push_b * (1 / targets.share_b),
            )
        return _with_velocity(phase, self.store(velocity))

    def solve(self, phase: SoftPhase) -> SoftPhase:
        """Solve velocities, with position correction."""
        solver, h = self.solver, self.setting.h
        drives = Drives(
            contacts=soft_contacts(self.parts.contacts, phase.gap, solver.contact, h),
            joints=soft_joints(phase.joints, solver.joint, h),
        )
        return self._swept(phase, self.store(drives), solver.sweeps)

    def integrate_positions(self, phase: SoftPhase) -> SoftPhase:
        """Move the bodies; joints and gaps follow."""
        parts, store = self.parts, self.store
        moving = store(drifted(phase.moving, self.setting.h))
        moved = Twist(x=moving.position.x, y=moving.position.y, turn=moving.rotation) - parts.start
        return dataclasses.replace(
            phase,
            moving=moving,
            joints=store(joint_rows(self.setting, parts.joint_targets, self.features, moving)),
            gap=store(moved_gap(parts.contacts, parts.contact_targets, parts.gap, moved)),
            hit=phase.hit | (phase.contact_impulse.normal > 0),
        )

    def relax(self, phase: SoftPhase) -> SoftPhase:
        """Solve velocities without position correction, whose speed goes again."""
        drives = Drives(
            contacts=relaxed_contacts(phase.gap, self.setting.h),
            joints=relaxed_joints(phase.joints),
        )
        phase = self._swept(phase, self.store(drives), self.solver.relax)
        # A gap that closed exactly at the end of the drift pushes for the first time here.
        return dataclasses.replace(phase, hit=phase.hit | (phase.contact_impulse.normal > 0))

    def restitution(self, phase: SoftPhase) -> SoftPhase:
        """Give contacts that came in fast and pushed their share of the speed of approach."""
        parts, solver = self.parts, self.solver
        bounces = phase.hit & (parts.approach < -solver.threshold)
        wanted = jnp.where(bounces, -parts.contacts.restitution * parts.approach, 0)

        def sweep(_: Any, carry: tuple) -> tuple:
            given = (parts.contacts, wanted)
            return self._visit(carry[0], parts.contact_targets, given, carry[1], bounce_contact)

        velocity, impulse = jax.lax.fori_loop(
            0, solver.bounce, sweep, (phase.moving.velocity, phase.contact_impulse)
        )
        return dataclasses.replace(_with_velocity(phase, velocity), contact_impulse=impulse)

    @property
    def _visit(self) -> Visit:
        return together if self.solver.split else in_turn

    def _swept(self, phase: SoftPhase, drives: Drives, sweeps: int) -> SoftPhase:
        """Visit all joints, then all contacts, then the friction of all contacts, many times."""
        visit, parts = self._visit, self.parts
        solve_joint = functools.partial(push_joint, self.setting.h)

        def sweep(_: Any, carry: tuple) -> tuple:
            velocity, contact_impulse, joint_impulse = carry
            velocity, joint_impulse = visit(
                velocity,
                parts.joint_targets,
                (phase.joints, drives.joints),
                joint_impulse,
                solve_joint,
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
            _with_velocity(phase, velocity),
            contact_impulse=contact_impulse,
            joint_impulse=joint_impulse,
        )


def _with_velocity(phase: SoftPhase, velocity: Twist) -> SoftPhase:
    return dataclasses.replace(phase, moving=dataclasses.replace(phase.moving, velocity=velocity))
