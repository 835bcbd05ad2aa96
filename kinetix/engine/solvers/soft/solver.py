"""Substeps with soft constraints: the solver, and what it keeps from step to step.

Worlds are on the last axis.
Source: Catto (2011), "Soft Constraints"; Catto (2024), "Solver2D".
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from kinetix.engine.collision import Found, Slots, find_contacts
from kinetix.engine.joints import joint_acts
from kinetix.engine.lookup import onto
from kinetix.engine.maths import dot, vec
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.solvers.rows import match
from kinetix.engine.solvers.soft.contacts import ContactImpulse, contact_rows
from kinetix.engine.solvers.soft.joints import JointImpulse, joint_rows
from kinetix.engine.solvers.soft.levers import SplitMasses
from kinetix.engine.solvers.soft.motion import MovingBodies, Setting, finish
from kinetix.engine.solvers.soft.springs import Spring
from kinetix.engine.solvers.soft.substep import Parts, SoftPhase, Substep
from kinetix.engine.solvers.visit import Twist, at_bodies
from kinetix.engine.spec import SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


@pytree
class SoftCache:
    """Accumulated impulses: contacts by key, joints by slot."""

    key: Int[Array, "c n"]
    contacts: ContactImpulse
    joints: JointImpulse


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
        """Advance the worlds by one time step."""
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


def _prepared(  # noqa: PLR0913 (everything that a step depends on)
    solver: Soft,
    world: World,
    state: State,
    control: Control,
    parameters: Parameters,
    spec: SceneSpec,
    found: Found,
    store: Store,
) -> tuple[Substep, SoftPhase]:
    """Return the constants of a step, and the state in which its first substep begins."""
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
    step = Substep(solver=solver, setting=setting, parts=parts, features=spec.features, store=store)
    return step, start


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
