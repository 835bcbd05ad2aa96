"""All joints of a world as one linear system, motors included. Worlds on the last axis.

Each joint has three rows: the two coordinates of its anchors' gap, and the relative angle. The
third row holds the angle of a weld; for a running motor it is a soft row whose compliance makes the
torque follow the motor's law *after* all impulses of the phase; otherwise it is switched off.
"""

import dataclasses

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants
from kinetix.engine.active_rows import InUse
from kinetix.engine.joints import joint_acts
from kinetix.engine.maths import Vec, rotate, vec
from kinetix.engine.solvers.direct.motor_rows import MotorRows
from kinetix.engine.solvers.rows import (
    Links,
    Masses,
    Rows,
    Velocity,
    apply,
    coupling,
    diagonal,
    make_rows,
    minus_inverse,
    one_row,
    put_coupling,
    speeds,
    through_points,
    turning,
)
from kinetix.engine.spec import Features
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, World
from kinetix.pytree import pytree, static


@pytree
class JointSystem:
    """The joints at one pose, `k` = 3 rows a joint: all x rows, all y rows, all angle rows.

    Where a scene has neither welds nor motors the angle rows are left out.
    """

    rows: Rows
    answers: Float[Array, "k k n"]
    """Impulses that answer the rows' speeds: minus the inverse of the rows' coupling."""
    error: Float[Array, "k n"]
    """Errors that the rows should bring to zero: gap [m], angle [rad]; 0 for motors."""
    compliance: Float[Array, "k n"]
    """Of motor rows: relative speed error left per unit of impulse; 0 for the rest."""
    arm_a: Vec
    arm_b: Vec


@pytree
class Held:
    """The joints of a step, poses and velocities aside."""

    acts: Bool[Array, "j n"]
    rows: Rows
    """Without the arms, which change with the pose."""
    live: Bool[Array, "k n"]
    wanted: Float[Array, "k n"]
    """Speed that a motor wants [rad/s]; 0 for the rest."""
    motors: MotorRows | None
    """None in scenes without any."""
    loose: Float[Array, "j n"]
    """The smaller value of its two bodies (`Step.loose`)."""
    turn: Float[Array, "j n"]
    """Rate at which the joint's force turned in the last step [rad/s]."""

    @property
    def links(self) -> Links:
        """The joints' bodies."""
        return self.rows.links


@pytree
class Step:
    """Constants of a whole step."""

    world: World
    control: Control
    parameters: Parameters
    masses: Masses
    """Inverse masses that the solver uses."""
    held: Held
    loose: Float[Array, "b n"]
    """1 for a body that swings slowly for the substep, 0 for one under great tension."""
    pivoted: Float[Array, "b n"]
    """1 if all joints lead to fixed bodies, negative if one leads to a moving body."""
    store: Store
    """Keeps intermediate results."""
    features: Features = static()
    """Features that the scene uses; the rest is left out."""


def joint_links(world: World, features: Features) -> Links:
    """Return the bodies of the joints."""
    joints = world.joints
    rows = 3 if features.welds or features.motors else 2
    in_use = InUse.of((joints.active, rows))
    return Links(body_a=joints.body_a, body_b=joints.body_b, in_use=in_use)


def held(
    world: World,
    links: Links,
    masses: Masses,
    loose: Float[Array, "b n"],
    turn: Float[Array, "j n"],
    motors: MotorRows | None,
    store: Store,
) -> Held:
    """Return the parts of a step's joints that do not change within it.

    Args:
        world: The worlds.
        links: The joints' bodies, from `joint_links`.
        masses: Inverse masses that the solver uses.
        loose: See `Step`.
        turn: See `Held`.
        motors: From `motor_rows`.
        store: Keeps intermediate results.
    """
    joints = world.joints
    zero = jnp.zeros_like(joints.reference_angle)
    here, along_x = Vec(x=zero, y=zero), Vec(x=zero + 1, y=zero)
    directions = [
        through_points(along_x, here, here),
        through_points(Vec(x=zero, y=zero + 1), here, here),
        turning(zero + 1),
    ]
    ((_, each),) = links.in_use.groups

    def column(x: Array, y: Array, turn: Array) -> Array:
        return store(jnp.concatenate([x, y, turn][:each], axis=0))

    acts = joint_acts(world)
    turns, wanted = acts & joints.fixed, zero
    if motors is not None:
        turns, wanted = turns | (acts & (motors.compliance > 0)), motors.wanted
    return Held(
        acts=acts,
        rows=make_rows(links, links.look_up(masses), directions[:each], store),
        live=column(acts, acts, turns),
        wanted=column(zero, zero, wanted),
        motors=motors,
        loose=jnp.minimum(*links.look_up(loose)),
        turn=turn,
    )


def joint_system(
    step: Step, position: Vec, rotation: Float[Array, "b n"], spin: Float[Array, "b n"] | None
) -> JointSystem:
    """Return the joints at a pose, ready to be solved.

    Args:
        step: The worlds, what drives them, and the masses.
        position: Of all bodies [m].
        rotation: Of all bodies [rad].
        spin: Angular velocity of all bodies [rad/s]; None at the start of the step.
    """
    held, store, joints = step.held, step.store, step.world.joints
    in_use = held.links.in_use
    ((_, each),) = in_use.groups
    (place_a, angle_a), (place_b, angle_b) = held.links.look_up((position, rotation))
    arm_a = rotate(jnp.cos(angle_a), jnp.sin(angle_a), vec(joints.anchor_a))
    arm_b = rotate(jnp.cos(angle_b), jnp.sin(angle_b), vec(joints.anchor_b))
    gap = place_b - place_a + arm_b - arm_a
    angle = angle_b - angle_a - joints.reference_angle
    zero, one = jnp.zeros_like(angle), jnp.ones_like(angle)
    compliance = zero if held.motors is None else held.motors.compliance
    if held.motors is not None and spin is not None:
        spin_a, spin_b = held.links.look_up(spin)
        compliance = held.motors.later(angle, spin_b - spin_a)
    angle = jnp.where(joints.fixed, angle, 0)

    def column(x: Array, y: Array, turn: Array) -> Array:
        return jnp.concatenate([x, y, turn][:each], axis=0)

    turn_a, turn_b = column(-arm_a.y, arm_a.x, one), column(-arm_b.y, arm_b.x, one)
    arm_a, arm_b, gap, angle, turn_a, turn_b = store((arm_a, arm_b, gap, angle, turn_a, turn_b))
    rows = dataclasses.replace(held.rows, turn_a=turn_a, turn_b=turn_b)
    error = store(jnp.where(held.live, column(gap.x, gap.y, angle), 0))
    compliance = store(column(zero, zero, compliance))
    mobility = diagonal(rows)
    yielding = mobility * constants.JOINT_REGULARISATION + compliance
    own = store(jnp.where(held.live, mobility + yielding, 1))

    def fill(k: Int[Array, ""], matrix: Float[Array, "k k n"]) -> Float[Array, "k k n"]:
        return put_coupling(matrix, k, coupling(one_row(rows, k), rows), held.live, own, store)

    nothing = jnp.zeros((held.live.shape[0], *held.live.shape), own.dtype)
    answers = minus_inverse(
        in_use.each(fill, nothing),
        store(constants.LEAST_PIVOT * (mobility + compliance)),
        in_use,
    )
    return JointSystem(
        rows=rows,
        answers=answers,
        error=error,
        compliance=compliance,
        arm_a=arm_a,
        arm_b=arm_b,
    )


def project(
    step: Step,
    system: JointSystem,
    velocity: Velocity,
    impulse: Float[Array, "k n"],
    bias: Float[Array, "k n"],
) -> tuple[Velocity, Float[Array, "k n"]]:
    """Return the nearest velocities that satisfy all joints exactly.

    Args:
        step: The worlds and their masses.
        system: The joints.
        velocity: Before.
        impulse: What the rows have given in this phase so far (a soft row needs its total).
        bias: Speeds to add to what the rows see, to correct positions.

    Returns:
        Velocities after, and the rows' total impulses.
    """
    held = step.held
    if held.live.shape[0] == 0:
        return velocity, impulse
    residual = speeds(system.rows, velocity) - held.wanted + bias + system.compliance * impulse
    residual = jnp.where(held.live, residual, 0)
    in_use = held.links.in_use
    gained = jnp.where(held.live, in_use.product(system.answers, residual), 0)
    return apply(system.rows, gained, velocity, step.masses), impulse + gained


def curvature(
    step: Step,
    system: JointSystem,
    turning: Float[Array, "b n"],
    duration: Float[Array, " n"],
) -> Float[Array, "k n"]:
    """Speeds that arms which turn, instead of moving straight on, add to the gaps' in a drift.

    As a bias of the solve before the drift they make the gaps vanish at its end: the force that
    bends the path acts in time, and the energy of what swings is kept (RATTLE). Light bodies that
    pull far heavier ones swing faster than a substep can follow; there it would feed them energy,
    so taut hinges get none of it and are mended by `settle`; welds do not swing and get all of it.
    Nor do bodies that spin too fast for a substep, such as those that are wedged and thrown about.
    What turns together with the joint's force does not swing, however fast it is; that part of the
    bend is foreseen always.

    Args:
        step: The worlds.
        system: The joints at the pose before the drift.
        turning: Angular velocities with which the bodies will drift [rad/s].
        duration: Of the drift [s].
    """
    spin_a, spin_b = step.held.links.look_up(turning)

    def bend(spin: Float[Array, "j n"], arm: Vec) -> Vec:
        angle = spin * duration
        inward = -2 * jnp.sin(0.5 * angle) ** 2
        onward = jnp.sin(angle) - angle
        return Vec(x=inward * arm.x - onward * arm.y, y=inward * arm.y + onward * arm.x)

    def bent(spin_a: Float[Array, "j n"], spin_b: Float[Array, "j n"]) -> Vec:
        return bend(spin_b, system.arm_b) - bend(spin_a, system.arm_a)

    turn = step.held.turn
    loose = jnp.where(step.world.joints.fixed, 1, step.held.loose)
    own = bent(spin_a, spin_b)
    carried = bent(_common(spin_a, turn), _common(spin_b, turn))
    spin = jnp.maximum(jnp.abs(spin_a), jnp.abs(spin_b))
    calm = jnp.clip(2 - spin * duration / constants.CALM_TURN, 0, 1)
    foreseen = (carried + (own - carried) * (loose * calm)) * (1 / duration)
    turns = jnp.zeros_like(system.error[2 * foreseen.x.shape[0] :])
    rows = jnp.concatenate([foreseen.x, foreseen.y, turns], axis=0)
    return jnp.where(step.held.live, rows, 0)


def _common(a: Float[Array, "j n"], b: Float[Array, "j n"]) -> Float[Array, "j n"]:
    """Return the slower of two rates that have the same sense, else 0."""
    return jnp.where(a * b > 0, jnp.sign(a) * jnp.minimum(jnp.abs(a), jnp.abs(b)), 0)


def settle(step: Step, system: JointSystem) -> tuple[JointSystem, Velocity]:
    """Take the error of taut joints, and of any that gape, out of the positions alone.

    Links that would turn far are moved only part of the way: beyond it the line that they are
    moved along is not their path, and a chain that snapped tight would be torn for good.

    Args:
        step: The worlds.
        system: The joints at the pose after a drift.

    Returns:
        The system with the errors that are left, and how far all bodies move [m, rad].
    """
    nowhere = jnp.zeros_like(step.masses.angular)
    still = Velocity(linear=Vec(x=nowhere, y=nowhere), angular=nowhere)
    if step.held.loose.shape[0] == 0:
        return system, still
    in_use = step.held.links.in_use
    ((_, each),) = in_use.groups
    # As soon as arms are not foreseen to bend, gaps open with every substep: all of them go.
    kept = jnp.clip(1 - (1 - step.held.loose) / constants.SETTLED, 0, 1)
    left = system.error * jnp.concatenate([kept] * each, axis=0)
    left = jnp.clip(left, -constants.JOINT_SLIP, constants.JOINT_SLIP)
    gained = jnp.where(step.held.live, in_use.product(system.answers, system.error - left), 0)
    move = apply(system.rows, gained, still, step.masses)
    most = jnp.max(jnp.abs(move.angular), axis=0)
    move = move * jnp.minimum(1, constants.MOST_MENDING_TURN / jnp.maximum(most, 1e-9))
    return dataclasses.replace(system, error=left), move
