"""The stages of a substep.

The solve also corrects positions; `relax` demands nothing of positions, so that it takes the speed
of the correction out again. Restitution comes last, once per step.

Worlds are on the last axis.
Source: Catto (2024), "Solver2D".
"""

import dataclasses
import functools
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine.solvers.soft.contacts import (
    ContactDrive,
    ContactImpulse,
    SoftContacts,
    bounce_contact,
    contact_push,
    moved_gap,
    push_normal,
    push_tangent,
    relaxed_contacts,
    soft_contacts,
)
from kinetix.engine.solvers.soft.joints import (
    JointImpulse,
    SoftJoints,
    joint_push,
    joint_rows,
    push_joint,
    relaxed_joints,
    soft_joints,
)
from kinetix.engine.solvers.soft.motion import MovingBodies, Setting, drifted, kicked
from kinetix.engine.solvers.soft.springs import Softness
from kinetix.engine.solvers.visit import Targets, Twist, Visit, add_changes, in_turn, together
from kinetix.engine.spec import Features
from kinetix.engine.store import Store
from kinetix.pytree import pytree

if TYPE_CHECKING:
    from kinetix.engine.solvers.soft.solver import Soft


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
class Substep:
    """The stages of a substep, with all that stays the same in a step."""

    solver: "Soft"
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
