"""Our own method, the direct soft step: joints exactly, contacts by a pluggable block.

A step has `substeps`; each is kick – solve – drift – kick – solve. The first solve (*bias*) also
corrects positions; what it adds for that moves the bodies but is taken out of the velocities by the
second (*relax*), so corrections cost no energy. Free flight is exact, jointed motion second order.

Worlds are on the last axis.
Source: Andersen (1983), RATTLE, for the split kick with a projection at both ends; Andrews,
Teichmann & Kry (2017), "Geometric Stiffness for Real-time Constrained Multibody Dynamics", for the
stiffness of taut joints as inertia; Catto (2024), Solver2D, for biased and relaxed solves.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from kinetix.engine import actuators, constants
from kinetix.engine.collision import Slots, find_contacts
from kinetix.engine.maths import Vec, vec
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.direct import impacts
from kinetix.engine.solvers.direct.blocks import AbstractBlock, Cone, Pgs
from kinetix.engine.solvers.direct.cache import DirectCache, finish, warm_start
from kinetix.engine.solvers.direct.contact_system import ContactSystem, contact_system, pushed
from kinetix.engine.solvers.direct.joint_system import (
    Step,
    curvature,
    held,
    joint_links,
    joint_system,
    project,
    settle,
)
from kinetix.engine.solvers.direct.masses import borne, effective_masses, pivoted
from kinetix.engine.solvers.direct.motor_rows import motor_rows
from kinetix.engine.solvers.direct.phase import Phase, before_walls
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.solvers.rows import Velocity, speeds
from kinetix.engine.spec import ARENA_BODIES, SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World

DEFAULT_BLOCK = Pgs()


@dataclasses.dataclass(frozen=True, kw_only=True)
class Direct(AbstractSolver):
    """Joints by a direct solve, contacts by a block (`direct+pgs`, `direct+admm`)."""

    substeps: int = 2
    block: AbstractBlock = DEFAULT_BLOCK
    joint_bias: float = 0.5
    """Share of a joint's position error that one substep takes away."""
    contact_bias: float = 0.2
    """The same for overlaps."""
    passes: int = 8
    """Most blows that are passed on within a substep."""
    slots: Slots | None = None
    """Room for contacts; None: by the capacity."""

    def slots_for(self, spec: SceneSpec) -> Slots:
        """Room for contacts in scenes of this capacity."""
        return self.slots or usual_room(spec)

    def empty_cache(self, spec: SceneSpec) -> Any:
        """Return a cache without impulses."""
        points, joints = self.slots_for(spec).points, spec.capacity.joints

        limits = joints if spec.features.limits else 0

        def zeros(count: int) -> Any:
            return np.zeros(count, np.float32)

        empty_keys: Any = np.full(points, -1, np.int32)
        no_contrast: Any = np.zeros((), np.float32)
        return DirectCache(
            key=empty_keys,
            bias_normal=zeros(points),
            bias_tangent=zeros(points),
            relax_normal=zeros(points),
            relax_tangent=zeros(points),
            bias_limit=zeros(limits),
            relax_limit=zeros(limits),
            joint_force_x=zeros(joints),
            joint_force_y=zeros(joints),
            joint_turn=zeros(joints),
            contrast=no_contrast,
        )

    def effort(self, world: World, state: State) -> Int[Array, " n"]:
        """Return the block's rounds, then the joints, then the contact points of the last step."""
        cache = state.cache
        points = jnp.sum(cache.key >= 0, axis=0, dtype=jnp.int32)
        joints = jnp.sum(world.joints.active, axis=0, dtype=jnp.int32)
        rounds = self.block.rounds(cache.contrast) * (len(world.joints.active) + 1) + joints
        return rounds * (len(cache.key) + 1) + points

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """Advance the worlds by one time step."""
        control = jax.tree.map(jnp.nan_to_num, control)
        h = parameters.dt / self.substeps
        store = Store.beside(state.rotation)
        links = joint_links(world, spec.features)
        found = find_contacts(world, state, parameters, spec, self.slots_for(spec), store)
        bias_impulse, relax_impulse = store(warm_start(state.cache, found))
        force = (bias_impulse + relax_impulse)[: found.points.key.shape[0]] / h
        bears = store(borne(world, found, force))
        masses, loose = store(effective_masses(world, state, links, bears, h, self.substeps))
        driven = None
        if spec.features.motors:
            driven = motor_rows(world, links, state, control, parameters, h / 2, store)
        this = Step(
            world=world,
            control=control,
            parameters=parameters,
            masses=masses,
            held=held(world, links, masses, loose, state.cache.joint_turn, driven, store),
            loose=loose,
            pivoted=store(pivoted(world, links)),
            store=store,
            features=spec.features,
        )
        velocity = Velocity(linear=vec(state.velocity), angular=state.angular_velocity)
        position = vec(state.position)
        joints = joint_system(this, position, state.rotation, None)
        system, gap = contact_system(this, state, found, joints, self.block, bears)
        start = Phase(
            position=position,
            rotation=state.rotation,
            velocity=velocity,
            gap=gap,
            bias_impulse=bias_impulse,
            relax_impulse=relax_impulse,
            joints=joints,
            joint_impulse=jnp.zeros_like(joints.error),
            hit=jnp.zeros(system.friction.shape, bool),
        )

        def substep(phase: Phase, _: None) -> tuple[Phase, None]:
            return self._substep(this, phase, system, spec), None

        end, _ = jax.lax.scan(substep, start, None, length=self.substeps)
        end = before_walls(world, state, found, store(end), parameters.dt)
        return finish(state, end, found, system.contrast, h, parameters)

    def _substep(self, step: Step, phase: Phase, system: ContactSystem, spec: SceneSpec) -> Phase:
        h = step.parameters.dt / self.substeps
        count = system.friction.shape[0]
        live, limit_live = system.live[:count], system.live[2 * count :]

        # Bias: half a kick, then velocities that also bring positions where they belong.
        push = _acceleration(step, phase.rotation)
        before = speeds(system.gaps, phase.velocity)[:count]
        velocity = _kick(phase.velocity, push, h / 2)
        bias = phase.joints.error * (self.joint_bias / h)
        nothing = jnp.zeros_like(phase.joint_impulse)
        velocity, joint_impulse = project(step, phase.joints, velocity, nothing, bias)
        offset = speeds(system.rows, velocity) + self._gap_bias(system, phase.gap, h)
        cone = Cone(friction=system.friction, closed=live, limited=limit_live)
        bias_impulse = self.block.solve(
            system.prepared, system.responses, offset, phase.bias_impulse, cone
        )
        # The curvature term needs angular velocities after the joints have reacted to the contacts.
        pushed_motion = system.responses.moved(bias_impulse)
        turning = velocity.angular.at[ARENA_BODIES:].add(pushed_motion[2])
        velocity, answer = pushed(step, system, bias_impulse, velocity)
        joint_impulse += answer
        bias += curvature(step, phase.joints, turning, h)
        velocity, joint_impulse = project(step, phase.joints, velocity, joint_impulse, bias)

        # Drift.
        move = velocity * h
        position = phase.position + move.linear
        rotation = phase.rotation + move.angular

        # Relax: the other half, then velocities that satisfy everything as it stands.
        velocity = _kick(velocity, _acceleration(step, rotation), h / 2)
        joints = joint_system(step, position, rotation, velocity.angular)
        joints, mend = settle(step, joints)
        position, rotation = position + mend.linear, rotation + mend.angular
        gap = phase.gap + speeds(system.gaps, move + mend)
        velocity, relaxed = project(step, joints, velocity, nothing, nothing)
        pressed = jnp.concatenate([bias_impulse[:count], bias_impulse[2 * count :]], axis=0) > 0
        closed = pressed | (gap <= constants.CLOSED_DISTANCE)
        cone = dataclasses.replace(
            cone, closed=live & closed[:count], limited=limit_live & closed[count:]
        )
        offset = speeds(system.rows, velocity)
        offset -= system.responses.speeds_in(pushed_motion, bias_impulse)
        force = phase.bias_impulse + phase.relax_impulse
        carried = impacts.until_the_impact(system, force, offset, cone.closed, before, phase.gap, h)
        own, offset = carried.share, carried.speeds
        knock = jnp.zeros_like(bias_impulse)
        if spec.features.restitution:
            bounce, least = impacts.bounces(system, before, phase.gap, push, closed[:count], h)
            offset, knock = impacts.knocks(
                self.block, system, offset, bounce, cone, least, self.passes
            )
        start = bias_impulse + phase.relax_impulse - own
        total = own + self.block.solve(system.prepared, system.responses, offset, start, cone)
        relax_impulse = total - bias_impulse
        more = relax_impulse + knock
        kept_bias, kept_relax = impacts.kept(carried, force, bias_impulse, relax_impulse)
        velocity, answer = pushed(step, system, more, velocity)
        velocity, relaxed = project(step, joints, velocity, relaxed + answer, nothing)
        return Phase(
            position=position,
            rotation=rotation,
            velocity=velocity,
            gap=gap,
            bias_impulse=kept_bias,
            relax_impulse=kept_relax,
            joints=joints,
            joint_impulse=joint_impulse + relaxed,
            hit=phase.hit | (bias_impulse[:count] > 0),
        )

    def _gap_bias(
        self, system: ContactSystem, gap: Float[Array, "g n"], h: Float[Array, " n"]
    ) -> Float[Array, "m n"]:
        """Closing speeds that are allowed (open gaps) or wanted away (overlaps).

        What lies on taut joints is pressed into them again whenever they are drawn straight, so all
        of its overlap is taken away at once.
        """
        count = system.friction.shape[0]
        share = self.contact_bias + (1 - self.contact_bias) * (1 - system.loose)
        share = jnp.concatenate([share, jnp.full_like(gap[count:], self.contact_bias)], axis=0)
        overlap = jnp.minimum(gap + constants.SLOP, 0) * (share / h)
        most = jnp.concatenate(
            [system.most_push, jnp.full_like(gap[count:], constants.PUSH_SPEED)], axis=0
        )
        bias = jnp.where(gap > 0, gap / h, jnp.maximum(overlap, -most))
        tangents = jnp.zeros_like(bias[:count])
        return jnp.concatenate([bias[:count], tangents, bias[count:]], axis=0)


def _acceleration(step: Step, rotation: Float[Array, "b n"]) -> tuple[Vec, Float[Array, "b n"]]:
    return actuators.acceleration(step.world, rotation, step.control, step.parameters)


def _kick(
    velocity: Velocity, push: tuple[Vec, Float[Array, "b n"]], duration: Float[Array, " n"]
) -> Velocity:
    linear, angular = push
    return Velocity(
        linear=velocity.linear + linear * duration, angular=velocity.angular + angular * duration
    )
