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
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import actuators, constants
from kinetix.engine.collision import FEATURES, Found, Slots, find_contacts, share_of_way
from kinetix.engine.lookup import marked, onto
from kinetix.engine.maths import Vec, cross, dot, nonzero, rotate, unvec, vec
from kinetix.engine.solvers import impacts
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.blocks import AbstractBlock, Cone, Pgs
from kinetix.engine.solvers.contact_system import ContactSystem, contact_system, pushed
from kinetix.engine.solvers.joint_system import (
    JointSystem,
    Step,
    curvature,
    held,
    joint_links,
    joint_system,
    project,
    settle,
)
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.solvers.rows import Links, Masses, Velocity, match, speeds
from kinetix.engine.spec import ARENA_BODIES, SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree

DEFAULT_BLOCK = Pgs()


@pytree
class DirectCache:
    """Kept for the next step: impulses by contact key, the joints' last forces, what was hard."""

    key: Int[Array, "c n"]
    bias_normal: Float[Array, "c n"]
    bias_tangent: Float[Array, "c n"]
    relax_normal: Float[Array, "c n"]
    relax_tangent: Float[Array, "c n"]
    bias_limit: Float[Array, "j n"]
    relax_limit: Float[Array, "j n"]
    joint_force_x: Float[Array, "j n"]
    joint_force_y: Float[Array, "j n"]
    joint_turn: Float[Array, "j n"]
    """Rate at which a joint's force turned in the last step [rad/s]."""
    contrast: Float[Array, " n"]
    """As the contacts of the last step had it (`ContactSystem.contrast`)."""


@pytree
class Phase:
    """State that a substep passes to the next."""

    position: Vec
    rotation: Float[Array, "b n"]
    velocity: Velocity
    gap: Float[Array, "g n"]
    """Of the contacts, then of the limits."""
    bias_impulse: Float[Array, "m n"]
    relax_impulse: Float[Array, "m n"]
    joints: JointSystem
    joint_impulse: Float[Array, "k n"]
    """Of the last substep, both solves together."""
    hit: Bool[Array, "c n"]
    """True for contacts that have pushed in any substep."""


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
        """No impulses."""
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
        """The block's rounds, then the joints, then the contact points of the last step."""
        cache = state.cache
        points = jnp.sum(cache.key >= 0, axis=0, dtype=jnp.int32)
        joints = jnp.sum(world.joints.active, axis=0, dtype=jnp.int32)
        rounds = self.block.rounds(cache.contrast) * (len(world.joints.active) + 1) + joints
        return rounds * (len(cache.key) + 1) + points

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """See the contract."""
        control = jax.tree.map(jnp.nan_to_num, control)
        h = parameters.dt / self.substeps
        store = Store.beside(state.rotation)
        links = joint_links(world, spec.features)
        masses, loose = store(_effective_masses(world, state, links, h))
        found = find_contacts(world, state, parameters, spec, self.slots_for(spec), store)
        this = Step(
            world=world,
            control=control,
            parameters=parameters,
            masses=masses,
            held=held(world, control, links, masses, loose, state.cache.joint_turn, store),
            loose=loose,
            pivoted=store(_pivoted(world, links)),
            store=store,
            features=spec.features,
        )
        velocity = Velocity(linear=vec(state.velocity), angular=state.angular_velocity)
        position = vec(state.position)
        joints = joint_system(this, position, state.rotation, velocity, h / 2)
        bias_impulse, relax_impulse = store(_warm_start(state.cache, found))
        force = (bias_impulse + relax_impulse)[: found.points.key.shape[0]] / h
        system, gap = contact_system(this, state, found, joints, self.block, force)
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
        end = _before_walls(world, state, found, store(end))
        return _finish(state, end, found, system.contrast, h, parameters)

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
        # How arms bend hangs on how bodies turn once joints have answered to the contacts.
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
        joints = joint_system(step, position, rotation, velocity, h / 2)
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
        more = total - bias_impulse + knock
        velocity, answer = pushed(step, system, more, velocity)
        velocity, relaxed = project(step, joints, velocity, relaxed + answer, nothing)
        return Phase(
            position=position,
            rotation=rotation,
            velocity=velocity,
            gap=gap,
            # An impact does not come again: what is kept is the force from before, half in each.
            bias_impulse=jnp.where(carried.struck, force / 2, bias_impulse),
            relax_impulse=jnp.where(carried.struck, force / 2, total - bias_impulse),
            joints=joints,
            joint_impulse=joint_impulse + relaxed,
            hit=phase.hit | (bias_impulse[:count] > 0),
        )

    def _gap_bias(
        self, system: ContactSystem, gap: Float[Array, "g n"], h: Float[Array, " n"]
    ) -> Float[Array, "m n"]:
        """Closing speeds that are allowed (open gaps) or wanted away (overlaps).

        What lies on taut joints is pressed into them anew whenever they are drawn straight, so all
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


def _effective_masses(
    world: World, state: State, links: Links, h: Float[Array, " n"]
) -> tuple[Masses, Float[Array, "b n"]]:
    """Inverse masses with the stiffness of taut joints added to the inertia, and what is loose.

    A force f at an arm r turns with the body: a spring of stiffness r·f that linearised joints do
    not see. As inertia h²·r·f it keeps heavy hanging loads stable; ordinary scenes do not notice.
    h²·r·f over the body's own inertia is (h·swing rate)², which tells taut joints from loose ones.
    """
    joints, bodies, cache = world.joints, world.bodies, state.cache
    inverse_inertia = bodies.inverse_inertia
    count = inverse_inertia.shape[0]
    force = Vec(x=cache.joint_force_x, y=cache.joint_force_y)
    stiffness = jnp.zeros_like(inverse_inertia)
    ends = links.look_up((state.rotation, bodies.inverse_mass, inverse_inertia))
    (angle_a, mass_a, inertia_a), (angle_b, mass_b, inertia_b) = ends
    for body, angle, anchor, sign, mass, inertia, other in (
        (joints.body_a, angle_a, joints.anchor_a, -1, mass_a, inertia_a, mass_b),
        (joints.body_b, angle_b, joints.anchor_b, 1, mass_b, inertia_b, mass_a),
    ):
        arm = rotate(jnp.cos(angle), jnp.sin(angle), vec(anchor))
        # On a pivot that stands still a body turns about it, not about its own centre.
        about = jnp.where(other > 0, 1, mass / nonzero(mass + dot(arm, arm) * inertia))
        stiffness += sign * onto(dot(arm, force) * about, body, count)
    swing = h**2 * jnp.maximum(stiffness, 0) * inverse_inertia
    masses = Masses(linear=bodies.inverse_mass, angular=inverse_inertia / jnp.maximum(1, swing))
    return masses, jnp.clip((constants.TAUT - swing) / (0.8 * constants.TAUT), 0, 1)


def _pivoted(world: World, links: Links) -> Float[Array, "b n"]:
    """1 for bodies that hang on what stands still alone, negative where one hangs on what moves.

    What is welded to a fixed body stands still too.
    """
    joints, inverse_mass = world.joints, world.bodies.inverse_mass
    count = inverse_mass.shape[0]

    def of_joints(found: Float[Array, "b n"]) -> tuple[tuple[Array, Array], ...]:
        of_a, of_b = links.look_up(found)
        return (joints.body_a, of_b), (joints.body_b, of_a)

    moves = inverse_mass
    for body, other in of_joints(moves):
        welded = joints.active & joints.fixed & (other == 0)
        moves = jnp.where(onto(welded.astype(moves.dtype), body, count) > 0, 0, moves)
    hangs = jnp.zeros_like(inverse_mass)
    for body, other in of_joints(moves):
        weight = jnp.where(other > 0, -float(count), jnp.ones_like(other))
        hangs += onto(jnp.where(joints.active, weight, 0), body, count)
    return jnp.where(inverse_mass > 0, jnp.minimum(hangs, 1), 0)


def _acceleration(step: Step, rotation: Float[Array, "b n"]) -> tuple[Vec, Float[Array, "b n"]]:
    """Gravity and thrust at a pose."""
    world = step.world
    linear, angular = actuators.thrust(world, rotation, step.control, step.parameters)
    moves = (world.bodies.inverse_mass > 0).astype(rotation.dtype)
    return Vec(
        x=linear.x + world.gravity[0] * moves, y=linear.y + world.gravity[1] * moves
    ), angular


def _kick(
    velocity: Velocity, push: tuple[Vec, Float[Array, "b n"]], duration: Float[Array, " n"]
) -> Velocity:
    linear, angular = push
    return Velocity(
        linear=velocity.linear + linear * duration, angular=velocity.angular + angular * duration
    )


def _warm_start(
    cache: DirectCache, found: Found
) -> tuple[Float[Array, "m n"], Float[Array, "m n"]]:
    """Last step's impulses of the contacts that are still there, for both solves."""
    normal, tangent, relax_normal, relax_tangent = match(
        found.points.key,
        cache.key,
        cache.bias_normal,
        cache.bias_tangent,
        cache.relax_normal,
        cache.relax_tangent,
    )
    return (
        jnp.concatenate([normal, tangent, cache.bias_limit], axis=0),
        jnp.concatenate([relax_normal, relax_tangent, cache.relax_limit], axis=0),
    )


def _before_walls(world: World, state: State, found: Found, end: Phase) -> Phase:
    """The end of a step in which no body's centre has entered a fixed polygon."""
    share = share_of_way(world, state, found.polygons, end.position)
    start = vec(state.position)
    return dataclasses.replace(
        end,
        position=start + (end.position - start) * share,
        rotation=state.rotation + (end.rotation - state.rotation) * share,
    )


def _finish(
    state: State,
    end: Phase,
    found: Found,
    contrast: Float[Array, " n"],
    h: Float[Array, " n"],
    parameters: Parameters,
) -> State:
    """The new state: clipped, with the impulses kept by their keys."""
    bound = parameters.clip_position
    speed, spin = parameters.clip_velocity, parameters.clip_angular_velocity
    count = found.points.key.shape[0]
    joints = state.cache.joint_force_x.shape[0]
    force = Vec(x=end.joint_impulse[:joints], y=end.joint_impulse[joints : 2 * joints]) * (1 / h)
    last = Vec(x=state.cache.joint_force_x, y=state.cache.joint_force_y)
    pair = jnp.where(end.hit, found.points.key // FEATURES, -1)
    return dataclasses.replace(
        state,
        position=jnp.clip(unvec(end.position), -bound, bound),
        rotation=end.rotation,
        velocity=jnp.clip(unvec(end.velocity.linear), -speed, speed),
        angular_velocity=jnp.clip(end.velocity.angular, -spin, spin),
        touching=found.touching | marked(pair, found.touching.shape[0]),
        overflow=found.overflow,
        cache=DirectCache(
            key=found.points.key,
            bias_normal=end.bias_impulse[:count],
            bias_tangent=end.bias_impulse[count : 2 * count],
            relax_normal=end.relax_impulse[:count],
            relax_tangent=end.relax_impulse[count : 2 * count],
            bias_limit=end.bias_impulse[2 * count :],
            relax_limit=end.relax_impulse[2 * count :],
            joint_force_x=force.x,
            joint_force_y=force.y,
            joint_turn=_turn(last, force) / parameters.dt,
            contrast=contrast,
        ),
    )


def _turn(last: Vec, now: Vec) -> Float[Array, "j n"]:
    """Return the angle from one force to the next [rad]; down to 0 where their sizes differ."""
    least = jnp.minimum(dot(last, last), dot(now, now))
    most = jnp.maximum(dot(last, last), dot(now, now))
    # A force that changes by a third does not go on turning as it did.
    steady = jnp.clip(2 * least / nonzero(most) - 1, 0, 1)
    return jnp.arctan2(cross(last, now), dot(last, now)) * steady
