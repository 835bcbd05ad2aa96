"""Motors, thrusters and joints of kinetix-env's scheme."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from kinetix.engine import actuators, maths
from kinetix.engine.lookup import onto, take
from kinetix.engine.maths import Vec, cross, nonzero, rotate, spin
from kinetix.engine.solvers.pgs_baumgarte.moving import Moving
from kinetix.engine.types import Control, Parameters, World


def drive(world: World, moving: Moving, control: Control, parameters: Parameters) -> Moving:
    """Motors and thrusters, each one explicit impulse from the same velocities."""
    joints, bodies = world.joints, world.bodies
    count = bodies.inverse_mass.shape[0]
    inertia = take(bodies.inverse_inertia, joints.body_a) + take(
        bodies.inverse_inertia, joints.body_b
    )
    angle = (
        take(moving.rotation, joints.body_b)
        - take(moving.rotation, joints.body_a)
        - joints.reference_angle
    )
    action = control.motor
    # As kinetix-env does: of limits that are close together the upper end counts.
    band = parameters.motor_joint_limit
    free = joints.limit_min + band, joints.limit_max - band
    target = parameters.base_motor_speed * joints.motor_speed * action
    error = take(moving.omega, joints.body_b) - take(moving.omega, joints.body_a) - target
    strength = (
        parameters.base_motor_power
        * joints.motor_power
        * parameters.dt
        * actuators.motor_fade(world, angle, action, free, parameters)
    )
    twist = strength / nonzero(inertia) * jnp.tanh(parameters.motor_decay_coefficient * error)
    twist = jnp.where(actuators.motor_runs(world, action), twist, 0)
    turned = onto(twist, joints.body_a, count) - onto(twist, joints.body_b, count)
    push, turn = actuators.thrust(world, moving.rotation, control, parameters)
    return dataclasses.replace(
        moving,
        velocity=moving.velocity + push * parameters.dt,
        omega=moving.omega + turned * bodies.inverse_inertia + turn * parameters.dt,
    )


def solve_joints(
    world: World,
    moving: Moving,
    impulses: tuple[Float[Array, "j n"], ...],
    parameters: Parameters,
) -> tuple[Moving, tuple[Float[Array, "j n"], ...]]:
    """Do one sweep over the joints, one after the other."""
    count = world.joints.body_a.shape[0]
    if count == 0:
        return moving, impulses

    def one(moving: Moving, joint: tuple) -> tuple[Moving, tuple]:
        return _solve_joint(world, moving, joint[0], joint[1], parameters)

    moving, impulses = jax.lax.scan(one, moving, (world.joints, impulses))
    return moving, impulses


def _solve_joint(
    world: World,
    moving: Moving,
    joint: Any,
    impulse: tuple[Float[Array, " n"], ...],
    parameters: Parameters,
) -> tuple[Moving, tuple[Float[Array, " n"], ...]]:
    """Solve one joint in all worlds; every quantity is taken from the state at its start."""
    bodies = world.bodies
    index = np.arange(bodies.inverse_mass.shape[0])[:, None]
    is_a, is_b = index == joint.body_a, index == joint.body_b

    def at(values: Float[Array, "b n"], mask: Bool[Array, "b n"]) -> Float[Array, " n"]:
        return jnp.sum(jnp.where(mask, values, 0), axis=0)

    def at_vec(values: Vec, mask: Bool[Array, "b n"]) -> Vec:
        return Vec(x=at(values.x, mask), y=at(values.y, mask))

    mass_a, mass_b = at(bodies.inverse_mass, is_a), at(bodies.inverse_mass, is_b)
    inertia_a, inertia_b = at(bodies.inverse_inertia, is_a), at(bodies.inverse_inertia, is_b)
    position_a, position_b = at_vec(moving.position, is_a), at_vec(moving.position, is_b)
    rotation_a, rotation_b = at(moving.rotation, is_a), at(moving.rotation, is_b)
    omega_a, omega_b = at(moving.omega, is_a), at(moving.omega, is_b)
    arm_a = rotate(
        jnp.cos(rotation_a), jnp.sin(rotation_a), Vec(x=joint.anchor_a[0], y=joint.anchor_a[1])
    )
    arm_b = rotate(
        jnp.cos(rotation_b), jnp.sin(rotation_b), Vec(x=joint.anchor_b[0], y=joint.anchor_b[1])
    )
    anchor_a, anchor_b = position_a + arm_a, position_b + arm_b

    weight_a, weight_b = 1 / nonzero(mass_a), 1 / nonzero(mass_b)
    middle = (anchor_a * weight_a + anchor_b * weight_b) / (weight_a + weight_b)
    middle = maths.where(mass_a == 0, anchor_a, maths.where(mass_b == 0, anchor_b, middle))
    relative = (
        at_vec(moving.velocity, is_b)
        + spin(omega_b, middle - position_b)
        - at_vec(moving.velocity, is_a)
        - spin(omega_a, middle - position_a)
    )
    direction = relative / nonzero(maths.length(relative))
    gap = anchor_b - anchor_a
    mass = (
        mass_a
        + mass_b
        + inertia_a * cross(arm_a, direction) ** 2
        + inertia_b * cross(arm_b, direction) ** 2
    )
    push = (relative + gap * parameters.baumgarte_joint_velocity) * (
        parameters.joint_stiffness / nonzero(mass)
    )
    share = parameters.baumgarte_joint_position / nonzero(mass_a + mass_b)

    spin_a = inertia_a * cross(arm_a, push)
    spin_b = -inertia_b * cross(arm_b, push)
    turning = (omega_b + spin_b) - (omega_a + spin_a)
    angle = rotation_b - rotation_a - joint.reference_angle
    twist, kept = _angular_impulse(
        joint, turning, angle, nonzero(inertia_a + inertia_b), parameters
    )

    both_active = (at(bodies.active.astype(mass_a.dtype), is_a) > 0) & (
        at(bodies.active.astype(mass_a.dtype), is_b) > 0
    )
    acts = joint.active & both_active & ((mass_a != 0) | (mass_b != 0))
    on = acts.astype(mass_a.dtype)
    velocity = (push * (on * mass_a), push * (-on * mass_b))
    nudge = (gap * (on * share * mass_a), gap * (-on * share * mass_b))
    moving = dataclasses.replace(
        moving,
        position=_add(moving.position, is_a, nudge[0], is_b, nudge[1]),
        velocity=_add(moving.velocity, is_a, velocity[0], is_b, velocity[1]),
        omega=moving.omega
        + jnp.where(is_a, on * (spin_a + inertia_a * twist), 0)
        + jnp.where(is_b, on * (spin_b - inertia_b * twist), 0),
    )
    x, y, angular = impulse
    return moving, (
        jnp.where(acts, x + push.x, 0),
        jnp.where(acts, y + push.y, 0),
        jnp.where(acts, kept * (angular + twist), 0),
    )


def _angular_impulse(
    joint: Any,
    turning: Float[Array, " n"],
    angle: Float[Array, " n"],
    inertia: Float[Array, " n"],
    parameters: Parameters,
) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """Angular impulse of a weld or of a violated limit, and whether it is accumulated (1 or 0)."""
    weld = (turning + parameters.baumgarte_fixed_joint * angle) / inertia
    beyond = angle - jnp.clip(angle, joint.limit_min, joint.limit_max)
    back = parameters.baumgarte_limit * beyond
    same = jnp.sign(turning) == jnp.sign(back)
    limit = jnp.where(same, (turning + back) / inertia, 0)
    limit = jnp.where(joint.limited & (beyond != 0), limit, 0)
    return jnp.where(joint.fixed, weld, limit), joint.fixed.astype(turning.dtype)


def _add(
    values: Vec, is_a: Bool[Array, "b n"], to_a: Vec, is_b: Bool[Array, "b n"], to_b: Vec
) -> Vec:
    return Vec(
        x=values.x + jnp.where(is_a, to_a.x, 0) + jnp.where(is_b, to_b.x, 0),
        y=values.y + jnp.where(is_a, to_a.y, 0) + jnp.where(is_b, to_b.y, 0),
    )
