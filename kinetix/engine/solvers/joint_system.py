"""All joints of a world as one linear system, motors included. Worlds on the last axis.

Each joint has three rows: the two coordinates of its anchors' gap, and the relative angle. The
third row holds the angle of a weld; for a running motor it is a soft row whose compliance makes the
torque follow the motor's law *after* all impulses of the phase; otherwise it is switched off.
"""

import dataclasses

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from kinetix.engine import actuators, constants
from kinetix.engine.lookup import take_pair
from kinetix.engine.maths import Vec, rotate, vec
from kinetix.engine.solvers.rows import (
    Links,
    Masses,
    Rows,
    Velocity,
    apply,
    coupling,
    diagonal,
    inverse,
    make_rows,
    matvec,
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
    solve: Float[Array, "k k n"]
    """Inverse of the coupling of the rows among themselves."""
    live: Bool[Array, "k n"]
    error: Float[Array, "k n"]
    """What the rows should bring to zero: gap [m], angle [rad]; 0 for motors."""
    wanted: Float[Array, "k n"]
    """Speed that a motor wants [rad/s]; 0 for the rest."""
    compliance: Float[Array, "k n"]
    """Of motor rows: relative speed error left per unit of impulse; 0 for the rest."""
    arm_a: Vec
    arm_b: Vec


@pytree
class Step:
    """What stays the same for a whole step."""

    world: World
    control: Control
    parameters: Parameters
    masses: Masses
    """Inverse masses that the solver uses."""
    loose: Float[Array, "j n"]
    """1 for a joint whose bodies swing slowly for the substep, 0 for one under great tension."""
    store: Store
    """Keeps intermediate results."""
    features: Features = static()
    """What the scene uses; the rest is left out."""


def joint_system(
    step: Step,
    position: Vec,
    rotation: Float[Array, "b n"],
    velocity: Velocity,
    duration: Float[Array, " n"],
) -> JointSystem:
    """The joints at a pose.

    Args:
        step: The worlds, what drives them, and the masses.
        position: Of all bodies [m].
        rotation: Of all bodies [rad].
        velocity: Of all bodies; tells how far the motors are from their target.
        duration: For how long the motors act in one solve [s].

    Returns:
        The system, ready to be solved.
    """
    world, masses, store = step.world, step.masses, step.store
    joints = world.joints
    a, b = joints.body_a, joints.body_b
    (place_a, angle_a, spin_a), (place_b, angle_b, spin_b) = take_pair(
        (position, rotation, velocity.angular), a, b
    )
    (mass_a, active_a), (mass_b, active_b) = take_pair((masses.linear, world.bodies.active), a, b)
    arm_a = rotate(jnp.cos(angle_a), jnp.sin(angle_a), vec(joints.anchor_a))
    arm_b = rotate(jnp.cos(angle_b), jnp.sin(angle_b), vec(joints.anchor_b))
    gap = place_b - place_a + arm_b - arm_a
    angle = angle_b - angle_a - joints.reference_angle

    zero, one = jnp.zeros_like(angle), jnp.ones_like(angle)
    arm_a, arm_b, gap, angle = store((arm_a, arm_b, gap, angle))
    has_angles = step.features.welds or step.features.motors
    parts = [
        through_points(Vec(x=one, y=zero), arm_a, arm_b),
        through_points(Vec(x=zero, y=one), arm_a, arm_b),
    ]
    if has_angles:
        parts.append(turning(one))
    rows = make_rows(masses, store, (Links(body_a=a, body_b=b), parts))
    acts = joints.active & (mass_a + mass_b > 0) & active_a & active_b & (a != b)
    wanted, compliance = zero, zero
    if step.features.motors:
        wanted, compliance = store(
            actuators.motor_row(
                world, angle, spin_b - spin_a, step.control.motor, step.parameters, duration
            )
        )
    turns = acts & (joints.fixed | (compliance > 0))

    def column(x: Array, y: Array, turn: Array) -> Array:
        return jnp.concatenate([x, y, turn] if has_angles else [x, y], axis=0)

    live, compliance = store((column(acts, acts, turns), column(zero, zero, compliance)))

    matrix = jnp.where(live[:, None] & live[None], coupling(rows, rows), 0)
    mobility = diagonal(rows)
    own = mobility * constants.JOINT_REGULARISATION + compliance
    eye = np.eye(live.shape[0], dtype=bool)[:, :, None]
    return JointSystem(
        rows=rows,
        solve=inverse(
            matrix + jnp.where(eye, jnp.where(live, own, 1)[:, None], 0),
            constants.LEAST_PIVOT * (mobility + compliance),
        ),
        live=live,
        error=store(jnp.where(live, column(gap.x, gap.y, jnp.where(joints.fixed, angle, 0)), 0)),
        wanted=store(column(zero, zero, wanted)),
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
    """The nearest velocities that satisfy all joints exactly.

    Args:
        step: The worlds and their masses.
        system: The joints.
        velocity: Before.
        impulse: What the rows have given in this phase so far (a soft row needs its total).
        bias: Speeds to add to what the rows see, to correct positions.

    Returns:
        Velocities after, and the rows' total impulses.
    """
    if system.live.shape[0] == 0:
        return velocity, impulse
    residual = speeds(system.rows, velocity) - system.wanted + bias + system.compliance * impulse
    residual = jnp.where(system.live, residual, 0)
    gained = jnp.where(system.live, -matvec(system.solve, residual), 0)
    return apply(system.rows, gained, velocity, step.masses), impulse + gained


def curvature(
    step: Step, system: JointSystem, velocity: Velocity, duration: Float[Array, " n"]
) -> Float[Array, "k n"]:
    """Speeds that arms which turn, instead of moving straight on, add to the gaps' in a drift.

    As a bias of the solve before the drift they make the gaps vanish at its end: the force that
    bends the path acts in time, and the energy of what swings is kept (RATTLE). Light bodies that
    pull far heavier ones swing faster than a substep can follow; there it would feed them energy,
    so taut joints get none of it and are mended by `settle`. Nor do bodies that spin too fast for a
    substep, such as those that are wedged and thrown about.

    Args:
        step: The worlds.
        system: The joints at the pose before the drift.
        velocity: With which the bodies will drift.
        duration: Of the drift [s].
    """
    joints = step.world.joints

    spin_a, spin_b = take_pair(velocity.angular, joints.body_a, joints.body_b)

    def bend(spin: Float[Array, "j n"], arm: Vec) -> Vec:
        angle = spin * duration
        inward = -2 * jnp.sin(0.5 * angle) ** 2
        onward = jnp.sin(angle) - angle
        return Vec(x=inward * arm.x - onward * arm.y, y=inward * arm.y + onward * arm.x)

    bent = bend(spin_b, system.arm_b) - bend(spin_a, system.arm_a)
    spin = jnp.maximum(jnp.abs(spin_a), jnp.abs(spin_b))
    calm = jnp.clip(2 - spin * duration / constants.CALM_TURN, 0, 1)
    bent = bent * (step.loose * calm / duration)
    turns = jnp.zeros_like(system.error[2 * bent.x.shape[0] :])
    rows = jnp.concatenate([bent.x, bent.y, turns], axis=0)
    return jnp.where(system.live, rows, 0)


def settle(step: Step, system: JointSystem) -> tuple[JointSystem, Velocity]:
    """Take the error of taut joints out of the positions alone.

    Args:
        step: The worlds.
        system: The joints at the pose after a drift.

    Returns:
        The system with the errors that are left, and how far all bodies move [m, rad].
    """
    nowhere = jnp.zeros_like(step.masses.angular)
    still = Velocity(linear=Vec(x=nowhere, y=nowhere), angular=nowhere)
    joints = step.loose.shape[0]
    if joints == 0:
        return system, still
    loose = jnp.concatenate([step.loose] * (system.error.shape[0] // joints), axis=0)
    left = system.error * loose
    gained = jnp.where(system.live, matvec(system.solve, left - system.error), 0)
    move = apply(system.rows, gained, still, step.masses)
    return dataclasses.replace(system, error=left), move
