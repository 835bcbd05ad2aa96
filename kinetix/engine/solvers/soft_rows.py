"""Contacts and joints as soft constraints, and what one of them does to its two bodies.

A soft constraint is a damped spring that is integrated implicitly: `Spring.at` turns frequency and
damping into the three numbers of `Softness`. `push_normal` and its like hold for one slot in
many worlds and for many slots alike. Every row has one accumulated impulse; a later solve without
bias (*relax*) takes out of it what an earlier one put in to correct positions.

Worlds are on the last axis.
Source: Catto (2011), "Soft Constraints", and (2024), "Solver2D"; the formulas are written out in
docs/physics.md.
"""

import dataclasses
import math

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine import actuators, constants
from kinetix.engine.collision import Points
from kinetix.engine.joints import joint_acts, nearer_limit
from kinetix.engine.lookup import take
from kinetix.engine.maths import Vec, cross, dot, nonzero, rotate, vec
from kinetix.engine.solvers.visit import Targets, Twist, at_bodies
from kinetix.engine.spec import Features
from kinetix.engine.types import Control, Parameters, World
from kinetix.pytree import pytree


@pytree
class Softness:
    """Share of a constraint's error that one visit corrects."""

    rate: Float[Array, "*k n"]
    """Share of the position error to take away per second [1/s]."""
    mass: Float[Array, "*k n"]
    """Scale of the effective mass; 1: rigid."""
    keep: Float[Array, "*k n"]
    """Share of the accumulated impulse that is given back; 0: rigid."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Spring:
    """Frequency and damping of a soft constraint."""

    hertz: float
    """Natural frequency [1/s]. Higher: stiffer, until the step cannot follow."""
    damping: float
    """Damping ratio. Above 1 an error fades without swinging."""
    share: float
    """The frequency is at most this share of the rate of (sub)steps."""

    def at(
        self,
        h: Float[Array, " n"],
        stiffer: Float[Array, "*k n"],
        copied: Float[Array, "*k n"],
    ) -> Softness:
        """The three numbers, a slot.

        Args:
            h: Duration of a substep [s].
            stiffer: Multiplies the frequency.
            copied: By how much the resistance of the copies exceeds that of the bodies: they must
                not make the spring softer.
        """
        omega = 2 * math.pi * jnp.minimum(self.hertz, self.share / h) * stiffer
        first = 2 * self.damping + h * omega
        second = h * omega * first * copied
        keep = 1 / (1 + second)
        return Softness(rate=omega / first, mass=second * keep, keep=keep)


@pytree
class Lever:
    """Two bodies and the places where they act on each other."""

    arm_a: Vec
    arm_b: Vec
    mass_a: Float[Array, "*k n"]
    """Inverse masses; of the copies where bodies are split (`visit.together`)."""
    mass_b: Float[Array, "*k n"]
    inertia_a: Float[Array, "*k n"]
    inertia_b: Float[Array, "*k n"]
    copied: Float[Array, "*k n"]
    """Factor by which copies are lighter than their bodies, both of a slot together; 1: whole."""

    def speed(self, a: Twist, b: Twist) -> Vec:
        """Velocity of b relative to a where they meet."""
        return Vec(
            x=b.x - a.x - b.turn * self.arm_b.y + a.turn * self.arm_a.y,
            y=b.y - a.y + b.turn * self.arm_b.x - a.turn * self.arm_a.x,
        )

    def resistance(self, direction: Vec) -> Float[Array, "*k n"]:
        """Change of the relative speed along a direction per unit of impulse; never 0."""
        return nonzero(
            self.mass_a
            + self.mass_b
            + self.inertia_a * cross(self.arm_a, direction) ** 2
            + self.inertia_b * cross(self.arm_b, direction) ** 2
        )

    def push(self, impulse: Vec, twist: Float[Array, "*k n"] | float = 0.0) -> tuple[Twist, Twist]:
        """Return the changes by an impulse on b and its opposite on a; `twist` only turns."""
        return (
            Twist(
                x=-self.mass_a * impulse.x,
                y=-self.mass_a * impulse.y,
                turn=-self.inertia_a * (cross(self.arm_a, impulse) + twist),
            ),
            Twist(
                x=self.mass_b * impulse.x,
                y=self.mass_b * impulse.y,
                turn=self.inertia_b * (cross(self.arm_b, impulse) + twist),
            ),
        )


@pytree
class SplitMasses:
    """Inverse masses of all bodies, and in how many copies each is solved."""

    linear: Float[Array, "b n"]
    angular: Float[Array, "b n"]
    copies: Float[Array, "b n"]

    def lever(self, targets: Targets, arm_a: Vec, arm_b: Vec) -> Lever:
        """Arms together with the masses of the copies that they move."""
        a, b = targets.body_a, targets.body_b
        whole_a, whole_b = take(self.linear, a), take(self.linear, b)
        mass_a, mass_b = whole_a * targets.share_a, whole_b * targets.share_b
        return Lever(
            arm_a=arm_a,
            arm_b=arm_b,
            mass_a=mass_a,
            mass_b=mass_b,
            inertia_a=take(self.angular, a) * targets.share_a,
            inertia_b=take(self.angular, b) * targets.share_b,
            copied=jnp.maximum((mass_a + mass_b) / nonzero(whole_a + whole_b), 1),
        )

    def targets(self, body_a: Array, body_b: Array) -> Targets:
        """Slots on these bodies."""
        return Targets(
            body_a=body_a,
            body_b=body_b,
            share_a=take(self.copies, body_a),
            share_b=take(self.copies, body_b),
        )


@pytree
class SoftContacts:
    """Contact points as solvers see them: fixed for the whole step."""

    lever: Lever
    normal: Vec
    friction: Float[Array, "*k n"]
    restitution: Float[Array, "*k n"]
    used: Bool[Array, "*k n"]


@pytree
class ContactDrive:
    """Targets of a solve for the contacts: change with the gap and with the kind of solve."""

    bias: Float[Array, "*k n"]
    """Closing speed that is left (open gaps) or separating speed that is asked for (negative)."""
    mass: Float[Array, "*k n"]
    keep: Float[Array, "*k n"]


@pytree
class ContactImpulse:
    """Accumulated impulses of contact points [N s]."""

    normal: Float[Array, "*k n"]
    tangent: Float[Array, "*k n"]


def contact_rows(
    world: World, points: Points, targets: Targets, masses: SplitMasses, parameters: Parameters
) -> SoftContacts:
    """The rows of a step's contact points."""
    bodies = world.bodies
    a, b = points.body_a, points.body_b
    friction = jnp.sqrt(take(bodies.friction, a) ** 2 + take(bodies.friction, b) ** 2)
    return SoftContacts(
        lever=masses.lever(targets, points.arm_a, points.arm_b),
        normal=points.normal,
        friction=parameters.base_friction * friction,
        restitution=jnp.minimum(take(bodies.restitution, a), take(bodies.restitution, b)),
        used=points.key >= 0,
    )


def soft_contacts(
    rows: SoftContacts, gap: Float[Array, "c n"], spring: Spring, h: Float[Array, " n"]
) -> ContactDrive:
    """Overlaps are pushed apart softly; open gaps may close in this substep but not overlap.

    A fixed body is twice as stiff, so that what lies on it does not sink under a stack.
    """
    fixed = (rows.lever.mass_a == 0) | (rows.lever.mass_b == 0)
    soft = spring.at(h, jnp.where(fixed, 2.0, 1.0).astype(gap.dtype), rows.lever.copied)
    overlap = jnp.minimum(gap + constants.SLOP, 0)
    push = jnp.maximum(soft.mass * soft.rate * overlap, -constants.PUSH_SPEED)
    is_open = gap > 0
    return ContactDrive(
        bias=jnp.where(is_open, gap / h, push),
        mass=jnp.where(is_open, 1, soft.mass),
        keep=jnp.where(is_open, 0, soft.keep),
    )


def relaxed_contacts(gap: Float[Array, "c n"], h: Float[Array, " n"]) -> ContactDrive:
    """Overlaps are left alone: only what the velocities demand."""
    return ContactDrive(
        bias=jnp.where(gap > 0, gap / h, 0), mass=jnp.ones_like(gap), keep=jnp.zeros_like(gap)
    )


def push_normal(
    known: tuple[SoftContacts, ContactDrive], a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """The impulse that keeps two bodies apart."""
    rows, drive = known
    lever, normal = rows.lever, rows.normal
    closing = dot(normal, lever.speed(a, b))
    wanted = (drive.mass * closing + drive.bias) / lever.resistance(normal)
    total = jnp.maximum(impulse.normal * (1 - drive.keep) - wanted, 0)
    total = jnp.where(rows.used, total, 0)
    pushed = lever.push(normal * (total - impulse.normal))
    return *pushed, ContactImpulse(normal=total, tangent=impulse.tangent)


def push_tangent(
    rows: SoftContacts, a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Friction, within the cone that the normal impulse allows.

    It comes after all normal impulses. Before them it would be bounded by what the soft sweep has
    weakened: a block on a slope slides 4 % too far. Point by point it would answer to the tilt of a
    body whose other corner has not pushed yet: stacks wander sideways.
    """
    lever, normal = rows.lever, rows.normal
    across = Vec(x=normal.y, y=-normal.x)
    slip = dot(across, lever.speed(a, b))
    bound = rows.friction * impulse.normal
    tangent = jnp.clip(impulse.tangent - slip / lever.resistance(across), -bound, bound)
    pushed = lever.push(across * (tangent - impulse.tangent))
    return *pushed, ContactImpulse(normal=impulse.normal, tangent=tangent)


def bounce_contact(
    known: tuple[SoftContacts, Float[Array, "*k n"]], a: Twist, b: Twist, impulse: ContactImpulse
) -> tuple[Twist, Twist, ContactImpulse]:
    """Separate at least as fast as `known[1]` says where it is positive."""
    rows, wanted = known
    lever, normal = rows.lever, rows.normal
    closing = dot(normal, lever.speed(a, b)) - wanted
    total = jnp.maximum(impulse.normal - closing / lever.resistance(normal), 0)
    total = jnp.where(wanted > 0, total, impulse.normal)
    pushed = lever.push(normal * (total - impulse.normal))
    return *pushed, ContactImpulse(normal=total, tangent=impulse.tangent)


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
    """+1 when the lower limit is the nearer, −1 when the upper one is."""
    stops: Float[Array, "*k n"]
    """1/(resistance to turning) of the limit's row; 0 without one."""
    left: Float[Array, "*k n"]
    """Angle left to the nearer limit [rad]."""


@pytree
class JointImpulse:
    """Accumulated impulses of joints [N s, N m s]."""

    x: Float[Array, "*k n"]
    y: Float[Array, "*k n"]
    turn: Float[Array, "*k n"]
    """Of a weld or motor."""
    stop: Float[Array, "*k n"]
    """Of the nearer limit, positive away from it."""


@pytree
class MovingBodies:
    """The bodies while they are being solved."""

    position: Vec
    rotation: Float[Array, "b n"]
    velocity: Twist


@pytree
class Setting:
    """Constants of a whole step."""

    world: World
    control: Control
    parameters: Parameters
    masses: SplitMasses
    h: Float[Array, " n"]
    """Duration of a substep [s]."""


def joint_rows(
    setting: Setting, targets: Targets, features: Features, moving: MovingBodies
) -> SoftJoints:
    """The joints at a pose; what the scene does not use is not computed."""
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
    if features.motors:
        action = setting.control.motor
        wanted, compliance = actuators.motor_row(
            setting.world,
            actuators.motors(setting.world, action),
            angle,
            take(moving.velocity.turn, b) - take(moving.velocity.turn, a),
            action,
            setting.parameters,
            setting.h,
        )
        driven = turns & (compliance > 0)
    if features.limits:
        side, left = nearer_limit(setting.world, angle)
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
    """Angle of a weld or speed of a motor, then the limit, then the anchors."""
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


def contact_push(rows: SoftContacts, impulse: ContactImpulse) -> tuple[Twist, Twist]:
    """Return the velocity changes of accumulated impulses."""
    across = Vec(x=rows.normal.y, y=-rows.normal.x)
    return rows.lever.push(rows.normal * impulse.normal + across * impulse.tangent)


def joint_push(rows: SoftJoints, impulse: JointImpulse) -> tuple[Twist, Twist]:
    """Return the velocity changes of accumulated impulses."""
    return rows.lever.push(Vec(x=impulse.x, y=impulse.y), impulse.turn + rows.side * impulse.stop)


def moved_gap(
    rows: SoftContacts, targets: Targets, gap: Float[Array, "c n"], moved: Twist
) -> Float[Array, "c n"]:
    """The gap at the step's contact points after the bodies have moved and turned since its start.

    Args:
        rows: The contacts.
        targets: Their bodies.
        gap: At the start of the step [m].
        moved: Displacement of all bodies since then [m, rad].
    """
    way = []
    for arm, body in ((rows.lever.arm_a, targets.body_a), (rows.lever.arm_b, targets.body_b)):
        by = at_bodies(moved, body)
        cos, sin = jnp.cos(by.turn), jnp.sin(by.turn)
        way.append(Vec(x=by.x, y=by.y) + rotate(cos, sin, arm) - arm)
    return gap + dot(rows.normal, way[1] - way[0])


def kicked(setting: Setting, moving: MovingBodies) -> MovingBodies:
    """Velocities after gravity and thrust have acted for a substep."""
    world, h = setting.world, setting.h
    linear, angular = actuators.thrust(world, moving.rotation, setting.control, setting.parameters)
    moves = (world.bodies.inverse_mass > 0).astype(moving.rotation.dtype)
    push = Twist(
        x=linear.x + world.gravity[0] * moves, y=linear.y + world.gravity[1] * moves, turn=angular
    )
    return dataclasses.replace(moving, velocity=moving.velocity + push * h)


def drifted(moving: MovingBodies, h: Float[Array, " n"]) -> MovingBodies:
    """Poses after a substep at these velocities."""
    velocity = moving.velocity
    return dataclasses.replace(
        moving,
        position=moving.position + Vec(x=velocity.x, y=velocity.y) * h,
        rotation=moving.rotation + velocity.turn * h,
    )
