"""Hinges, welds, motors and limits as soft constraints.

Every row has one accumulated impulse, as those of `contacts`. Worlds are on the last axis.
Source: Catto (2011), "Soft Constraints"; the formulas are written out in docs/physics.md.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine import actuators
from kinetix.engine.joints import joint_acts, next_limit
from kinetix.engine.lookup import take
from kinetix.engine.maths import Vec, nonzero, rotate, vec
from kinetix.engine.solvers.soft.levers import Lever
from kinetix.engine.solvers.soft.motion import MovingBodies, Setting
from kinetix.engine.solvers.soft.springs import Softness, Spring
from kinetix.engine.solvers.visit import Targets, Twist
from kinetix.engine.spec import Features
from kinetix.pytree import pytree


@pytree
class SoftJoints:
    """Joints at one pose."""

    lever: Lever
    error: Vec
    """Gap of the anchors [m]."""
    inverse_xx: Float[Array, "*k n"]
    """Inverse of the 2×2 effective mass of the anchors; all 0 where the joint does not act."""
    inverse_xy: Float[Array, "*k n"]
    inverse_yy: Float[Array, "*k n"]
    turns: Float[Array, "*k n"]
    """1/(resistance to turning + compliance) of a weld's or motor's angle row; 0 without one."""
    compliance: Float[Array, "*k n"]
    """Of motors: speed error left per unit of impulse [rad/s / (N m s)]; 0 for welds."""
    wanted: Float[Array, "*k n"]
    """Speed that a motor wants [rad/s]; 0 for welds."""
    angle_error: Float[Array, "*k n"]
    """Of welds [rad]; 0 for motors."""
    weld: Float[Array, "*k n"]
    """1 for a weld, 0 for a motor."""
    side: Float[Array, "*k n"]
    """+1 when the lower limit is the next, −1 when the upper one is."""
    stops: Float[Array, "*k n"]
    """1/(resistance to turning) of the limit's row; 0 without one."""
    left: Float[Array, "*k n"]
    """Angle left to that limit [rad]."""


@pytree
class JointImpulse:
    """Accumulated impulses of joints [N s, N m s]."""

    x: Float[Array, "*k n"]
    y: Float[Array, "*k n"]
    turn: Float[Array, "*k n"]
    """Angular impulse of a weld or motor."""
    stop: Float[Array, "*k n"]
    """Impulse of the next limit, positive away from it."""


def joint_rows(
    setting: Setting, targets: Targets, features: Features, moving: MovingBodies
) -> SoftJoints:
    """Return the joints at a pose; what the scene does not use is not computed."""
    joints = setting.world.joints
    a, b = targets.body_a, targets.body_b
    angle_a, angle_b = take(moving.rotation, a), take(moving.rotation, b)
    arm_a = rotate(jnp.cos(angle_a), jnp.sin(angle_a), vec(joints.anchor_a))
    arm_b = rotate(jnp.cos(angle_b), jnp.sin(angle_b), vec(joints.anchor_b))
    lever = setting.masses.lever(targets, arm_a, arm_b)
    angle = angle_b - angle_a - joints.reference_angle
    acts = joint_acts(setting.world)

    straight = lever.mass_a + lever.mass_b
    xx = straight + lever.inertia_a * arm_a.y**2 + lever.inertia_b * arm_b.y**2
    yy = straight + lever.inertia_a * arm_a.x**2 + lever.inertia_b * arm_b.x**2
    xy = -(lever.inertia_a * arm_a.x * arm_a.y + lever.inertia_b * arm_b.x * arm_b.y)
    scale = jnp.where(acts, 1 / nonzero(xx * yy - xy**2), 0)

    resistance = lever.inertia_a + lever.inertia_b
    turns = acts & (resistance > 0)
    weld = turns & joints.fixed if features.welds else jnp.zeros(turns.shape, bool)
    wanted = compliance = side = left = jnp.zeros_like(angle)
    driven = limited = jnp.zeros(turns.shape, bool)
    spin = take(moving.velocity.turn, b) - take(moving.velocity.turn, a)
    if features.motors:
        action = setting.control.motor
        wanted, compliance = actuators.motor_row(
            setting.world,
            actuators.motors(setting.world, action),
            angle,
            spin,
            action,
            setting.parameters,
            setting.h,
        )
        driven = turns & (compliance > 0)
    if features.limits:
        side, left = next_limit(setting.world, angle, spin * setting.h)
        limited = turns & joints.limited & ~joints.fixed
    return SoftJoints(
        lever=lever,
        error=take(moving.position, b) - take(moving.position, a) + arm_b - arm_a,
        inverse_xx=yy * scale,
        inverse_xy=-xy * scale,
        inverse_yy=xx * scale,
        turns=jnp.where(weld | driven, 1 / nonzero(resistance + compliance), 0),
        compliance=compliance,
        wanted=wanted,
        angle_error=jnp.where(weld, angle, 0),
        weld=weld.astype(angle.dtype),
        side=side,
        stops=jnp.where(limited, 1 / nonzero(resistance), 0),
        left=left,
    )


def soft_joints(rows: SoftJoints, spring: Spring, h: Float[Array, " n"]) -> Softness:
    """Errors are taken away softly."""
    copied = rows.lever.copied
    return spring.at(h, jnp.ones_like(copied), copied)


def relaxed_joints(rows: SoftJoints) -> Softness:
    """Errors are left alone: only what the velocities demand."""
    none = jnp.zeros_like(rows.left)
    return Softness(rate=none, mass=jnp.ones_like(none), keep=none)


def push_joint(
    h: Float[Array, " n"],
    known: tuple[SoftJoints, Softness],
    a: Twist,
    b: Twist,
    impulse: JointImpulse,
) -> tuple[Twist, Twist, JointImpulse]:
    """Return the angle of a weld or speed of a motor, then the limit, then the anchors."""
    rows, soft = known
    lever = rows.lever
    spin = b.turn - a.turn
    is_weld = rows.weld > 0
    wrong = spin - rows.wanted + soft.rate * rows.angle_error
    wrong = jnp.where(is_weld, soft.mass, 1) * wrong + rows.compliance * impulse.turn
    turn = impulse.turn * (1 - rows.weld * soft.keep) - rows.turns * wrong
    turn = jnp.where(rows.turns > 0, turn, 0)

    resistance = lever.inertia_a + lever.inertia_b
    opening = rows.side * (spin + resistance * (turn - impulse.turn))
    is_open = rows.left > 0
    bias = jnp.where(is_open, rows.left / h, soft.mass * soft.rate * rows.left)
    wrong = jnp.where(is_open, 1, soft.mass) * opening + bias
    stop = impulse.stop * (1 - jnp.where(is_open, 0, soft.keep)) - rows.stops * wrong
    stop = jnp.where(rows.stops > 0, jnp.maximum(stop, 0), 0)

    twist = turn - impulse.turn + rows.side * (stop - impulse.stop)
    none = Vec(x=jnp.zeros_like(twist), y=jnp.zeros_like(twist))
    turned_a, turned_b = lever.push(none, twist)
    wrong = (lever.speed(a + turned_a, b + turned_b) + rows.error * soft.rate) * soft.mass
    acts = rows.inverse_xx > 0
    x = impulse.x * (1 - soft.keep) - rows.inverse_xx * wrong.x - rows.inverse_xy * wrong.y
    y = impulse.y * (1 - soft.keep) - rows.inverse_xy * wrong.x - rows.inverse_yy * wrong.y
    x, y = jnp.where(acts, x, 0), jnp.where(acts, y, 0)
    pushed = lever.push(Vec(x=x - impulse.x, y=y - impulse.y), twist)
    return *pushed, JointImpulse(x=x, y=y, turn=turn, stop=stop)


def joint_push(rows: SoftJoints, impulse: JointImpulse) -> tuple[Twist, Twist]:
    """Return the velocity changes of accumulated impulses."""
    return rows.lever.push(Vec(x=impulse.x, y=impulse.y), impulse.turn + rows.side * impulse.stop)
