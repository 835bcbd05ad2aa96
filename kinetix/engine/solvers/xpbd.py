"""Extended position-based dynamics: positions are corrected, velocities follow from them.

A substep predicts where everything would go, moves bodies one constraint after the other until they
fit, takes the velocities from the way that was gone, and only then lets contacts bounce and slide.
Nothing is kept from step to step. Displacements are counted from the start of a substep, since the
difference of two positions far from the origin would be mostly rounding.

Worlds are on the last axis.
Source: Müller, Macklin, Chentanez, Jeschke & Kim (2020), "Detailed Rigid Body Simulation with
Extended Position Based Dynamics".
"""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine.collision import Slots, find_contacts
from kinetix.engine.lookup import take
from kinetix.engine.maths import Vec, dot, length, nonzero, rotate, vec
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import usual_room
from kinetix.engine.solvers.soft.contacts import ContactImpulse, SoftContacts, contact_rows
from kinetix.engine.solvers.soft.joints import SoftJoints, joint_rows
from kinetix.engine.solvers.soft.levers import Lever, SplitMasses
from kinetix.engine.solvers.soft.motion import MovingBodies, Setting, finish, kicked
from kinetix.engine.solvers.visit import Targets, Twist, add_changes, at_bodies, in_turn
from kinetix.engine.spec import SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


@pytree
class PositionContacts:
    """Contacts at the start of a substep."""

    rows: SoftContacts
    gap: Float[Array, "*k n"]
    goal: Float[Array, "*k n"]
    """Gap that the substep aims at [m]; negative where an overlap is too deep for one substep."""


@pytree
class VelocityContacts:
    """Target velocities of contacts after the positions fit."""

    rows: SoftContacts
    approach: Float[Array, "*k n"]
    """Normal speed before the positions were corrected [m/s], negative when closing."""
    pushed: Bool[Array, "*k n"]
    """True where the correction pushed."""
    least: Float[Array, "*k n"]
    """Contacts that close slower than this do not bounce [m/s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Passes:
    """Numbers of substeps and iterations, and their softness."""

    positions: int
    velocities: int
    softness: float


@dataclasses.dataclass(frozen=True, kw_only=True)
class Xpbd(AbstractSolver):
    """Positions first: one Gauss–Seidel pass over joints and contacts in each of many substeps.

    Hardly ever explodes, because no impulse is carried over; but neither is what the last step
    found out. So a load is held by as much as a few passes can do, sag grows with the length of
    chains and welds, and energy fades. Joints are rigid (no compliance); motors act as torques
    before the positions are corrected. Friction is bounded by Coulomb's cone in every pass and once
    more, on the total, when velocities are corrected.

    Source: Müller et al. (2020), see above; with their all-or-nothing static friction a block
    crept 4 cm in 4 s where it should stick, and slid 5 % too far.
    """

    substeps: int = 10
    iterations: int = 4
    """Passes over joints and contacts in a substep. With one, stacks rock until they fall."""
    velocity_iterations: int = 1
    """Passes over the velocities of contacts in a substep."""
    softness: float = 2.0
    """Compliance of contacts, relative to their resistance: α/h² = softness·w. Rigid ones (0) feed
    energy into stacks; at 2 a box of .2 m sinks by .3 mm under five, and they stand."""
    deepest: float = 0.01
    """Of an overlap that a substep starts with, it resolves so much [m]. More: overlapping bodies
    are blown apart; less: contacts under load, which are soft, lose their hold."""
    slots: Slots | None = None
    """Room for contacts; None: by the capacity."""

    def slots_for(self, spec: SceneSpec) -> Slots:
        """Room for contacts in scenes of this capacity."""
        return self.slots or usual_room(spec)

    def empty_cache(self, spec: SceneSpec) -> Any:
        """Return an empty cache: nothing is kept."""
        del spec
        return ()

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """Advance the world by one time step."""
        store = Store.beside(state.rotation)
        room = self.slots_for(spec)
        found = find_contacts(world, state, parameters, spec, room, store)
        bodies = world.bodies
        masses = SplitMasses(
            linear=bodies.inverse_mass,
            angular=bodies.inverse_inertia,
            copies=jnp.ones_like(bodies.inverse_mass),
        )
        setting = Setting(
            world=world,
            control=jax.tree.map(jnp.nan_to_num, control),
            parameters=parameters,
            masses=masses,
            h=parameters.dt / self.substeps,
        )
        moving = MovingBodies(
            position=vec(state.position),
            rotation=state.rotation,
            velocity=Twist(
                x=state.velocity[:, 0], y=state.velocity[:, 1], turn=state.angular_velocity
            ),
        )
        targets = masses.targets(found.points.body_a, found.points.body_b)
        rows = store(contact_rows(world, found.points, targets, masses, parameters))
        start = _pose(moving)
        passes = Passes(
            positions=self.iterations,
            velocities=self.velocity_iterations,
            softness=self.softness,
        )

        def substep(carry: tuple, _: None) -> tuple[tuple, None]:
            moving, hit = carry
            moved = store(_pose(moving) - start)
            gap = store(_advanced(rows, targets, found.points.separation, moved))
            contacts = store(
                PositionContacts(
                    rows=rows,
                    gap=gap,
                    goal=jnp.minimum(gap + self.deepest, 0),
                )
            )
            moving, pushes = _substep(setting, moving, targets, contacts, spec, passes)
            return (moving, hit | pushes), None

        (moving, hit), _ = jax.lax.scan(
            substep,
            (moving, jnp.zeros(rows.used.shape, bool)),
            None,
            length=self.substeps,
        )
        return finish(state, moving, found, hit, parameters, ())


def _pose(moving: MovingBodies) -> Twist:
    return Twist(x=moving.position.x, y=moving.position.y, turn=moving.rotation)


def _advanced(
    rows: SoftContacts, targets: Targets, gap: Float[Array, "c n"], moved: Twist
) -> Float[Array, "c n"]:
    """The gap after the bodies have moved; arms stay: a rolling disc does not lift its contact."""
    way = rows.lever.speed(at_bodies(moved, targets.body_a), at_bodies(moved, targets.body_b))
    return gap + dot(rows.normal, way)


def _substep(
    setting: Setting,
    moving: MovingBodies,
    targets: Targets,
    contacts: PositionContacts,
    spec: SceneSpec,
    passes: Passes,
) -> tuple[MovingBodies, Bool[Array, "c n"]]:
    """Predict, correct positions, take velocities from them, correct those."""
    h, world = setting.h, setting.world
    store = Store.beside(moving.rotation)
    joint_targets = setting.masses.targets(world.joints.body_a, world.joints.body_b)
    joints = store(joint_rows(setting, joint_targets, spec.features, moving))
    moving = kicked(setting, moving)
    if spec.features.motors:
        moving = dataclasses.replace(
            moving, velocity=_driven(joints, joint_targets, moving.velocity)
        )
    predicted = store(moving.velocity)
    approach = dot(
        contacts.rows.normal,
        contacts.rows.lever.speed(
            at_bodies(predicted, targets.body_a), at_bodies(predicted, targets.body_b)
        ),
    )
    none = jnp.zeros_like(contacts.gap)
    correct_contact = functools.partial(_correct_contact, passes.softness)

    def correct(_: Any, carry: tuple) -> tuple:
        way, _ = in_turn(carry[0], joint_targets, joints, None, _correct_joint)
        return in_turn(way, targets, contacts, carry[1], correct_contact)

    way, impulse = jax.lax.fori_loop(
        0,
        passes.positions,
        correct,
        (store(predicted * h), ContactImpulse(normal=none, tangent=none)),
    )
    gravity = Vec(x=world.gravity[0], y=world.gravity[1])
    pushes = impulse.normal > 0
    after = store(
        VelocityContacts(
            rows=contacts.rows,
            approach=approach,
            pushed=pushes,
            least=jnp.broadcast_to(2 * h * length(gravity), none.shape),
        )
    )
    impulse = ContactImpulse(normal=impulse.normal / h, tangent=impulse.tangent / h)
    velocity, _ = jax.lax.fori_loop(
        0,
        passes.velocities,
        lambda _, carry: in_turn(carry[0], targets, after, carry[1], _correct_velocity),
        (store(way * (1 / h)), store(impulse)),
    )
    return MovingBodies(
        position=moving.position + Vec(x=way.x, y=way.y),
        rotation=moving.rotation + way.turn,
        velocity=velocity,
    ), pushes


def _driven(joints: SoftJoints, targets: Targets, velocity: Twist) -> Twist:
    """Velocities after the motors' torques, which never turn a free axle past its target."""
    lever = joints.lever
    spin = take(velocity.turn, targets.body_b) - take(velocity.turn, targets.body_a)
    resistance = lever.inertia_a + lever.inertia_b
    runs = (joints.turns > 0) & (joints.weld == 0)
    give = nonzero(jnp.maximum(joints.compliance, resistance))
    twist = jnp.where(runs, (joints.wanted - spin) / give, 0)
    none = Vec(x=jnp.zeros_like(twist), y=jnp.zeros_like(twist))
    return add_changes(velocity, targets.body_a, targets.body_b, *lever.push(none, twist))


def _correct_joint(rows: SoftJoints, a: Twist, b: Twist, memory: None) -> tuple[Twist, Twist, None]:
    """Move two bodies so that their weld's angle, their limit, and then their anchors fit."""
    lever = rows.lever
    turn = b.turn - a.turn
    resistance = nonzero(lever.inertia_a + lever.inertia_b)
    twist = -rows.weld * (rows.angle_error + turn) / resistance
    over = jnp.minimum(rows.left + rows.side * turn, 0)
    twist -= jnp.where(rows.stops > 0, rows.side * over / resistance, 0)
    none = Vec(x=jnp.zeros_like(twist), y=jnp.zeros_like(twist))
    turned_a, turned_b = lever.push(none, twist)

    now, way = _moved(lever, a + turned_a, b + turned_b)
    error = rows.error + way
    size = length(error)
    direction = error / nonzero(size)
    push = jnp.where(rows.inverse_xx > 0, -size / now.resistance(direction), 0)
    pushed_a, pushed_b = now.push(direction * push)
    return turned_a + pushed_a, turned_b + pushed_b, memory


def _correct_contact(
    softness: float, known: PositionContacts, a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Move two bodies apart; and back to where they touched as far as friction allows."""
    rows, normal = known.rows, known.rows.normal
    lever = rows.lever
    gap = known.gap + dot(normal, lever.speed(a, b)) - known.goal
    resistance = lever.resistance(normal)
    give = softness * resistance
    total = impulse.normal - (gap + give * impulse.normal) / (resistance + give)
    total = jnp.maximum(total, 0)
    total = jnp.where(rows.used, total, 0)
    change_a, change_b = lever.push(normal * (total - impulse.normal))

    across = Vec(x=normal.y, y=-normal.x)
    slip = dot(across, lever.speed(a + change_a, b + change_b))
    bound = rows.friction * total
    hold = jnp.clip(impulse.tangent - slip / lever.resistance(across), -bound, bound)
    held_a, held_b = lever.push(across * (hold - impulse.tangent))
    return change_a + held_a, change_b + held_b, ContactImpulse(normal=total, tangent=hold)


def _correct_velocity(
    known: VelocityContacts, a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Bounce, without the speed of the correction; then slide."""
    rows, lever, normal = known.rows, known.rows.lever, known.rows.normal
    bounces = known.approach < -known.least
    wanted = jnp.where(bounces, -rows.restitution * known.approach, 0)
    wrong = dot(normal, lever.speed(a, b)) - wanted
    total = jnp.maximum(impulse.normal - wrong / lever.resistance(normal), 0)
    total = jnp.where(known.pushed, total, 0)
    push = normal * (total - impulse.normal)
    change_a, change_b = lever.push(push)

    across = Vec(x=normal.y, y=-normal.x)
    slip = dot(across, lever.speed(a + change_a, b + change_b))
    bound = rows.friction * total
    drag = jnp.clip(impulse.tangent - slip / lever.resistance(across), -bound, bound)
    dragged = lever.push(push + across * (drag - impulse.tangent))
    return *dragged, ContactImpulse(normal=total, tangent=drag)


def _moved(lever: Lever, a: Twist, b: Twist) -> tuple[Lever, Vec]:
    """The lever after its bodies have moved, and how far b's end has moved from a's."""
    arm_a = rotate(jnp.cos(a.turn), jnp.sin(a.turn), lever.arm_a)
    arm_b = rotate(jnp.cos(b.turn), jnp.sin(b.turn), lever.arm_b)
    way = Vec(x=b.x - a.x, y=b.y - a.y) + (arm_b - lever.arm_b) - (arm_a - lever.arm_a)
    return dataclasses.replace(lever, arm_a=arm_a, arm_b=arm_b), way
