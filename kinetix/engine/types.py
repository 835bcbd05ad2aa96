"""The engine's pytrees: what a level fixes, what a step changes, what drives it.

Shapes are written for one world. Inside the engine every array carries the worlds `n` on a further,
last axis (see README.md beside this file). Bodies are listed polygons first, then circles; a body's
index in that list is its *global index*.

Axis letters: `b` bodies, `p` polygons, `r` circles, `v` vertices, `j` joints, `t` thrusters,
`q` candidate pairs, `n` worlds.
"""

from typing import Any

from jaxtyping import Array, Bool, Float, Int

from kinetix.pytree import pytree


@pytree
class Bodies:
    """Constants of a level's bodies."""

    inverse_mass: Float[Array, " b"]
    """1/mass [1/kg]; 0 for a fixed body (which still moves if it has a velocity)."""
    inverse_inertia: Float[Array, " b"]
    """1/moment of inertia about the centre of mass [1/(kg m²)]; 0 for a fixed body."""
    friction: Float[Array, " b"]
    """Friction value f; a pair has the coefficient base_friction·sqrt(f_a² + f_b²)."""
    restitution: Float[Array, " b"]
    """Restitution e; a pair has the smaller of the two."""
    collision_mode: Int[Array, " b"]
    """0 ghost, 1 normal, 2 always: a pair may touch when a = 2 or b = 2 or a·b > 0."""
    active: Bool[Array, " b"]
    """True where the slot holds a body."""
    vertices: Float[Array, "p v 2"]
    """Corners of the polygons in their own frame [m], clockwise; padding beyond the count."""
    vertex_count: Int[Array, " p"]
    """Number of corners that count: 3 or 4."""
    radius: Float[Array, " r"]
    """Radius of the circles [m]."""


@pytree
class Joints:
    """Constants of a level's joints. All angles are of body b relative to body a [rad]."""

    body_a: Int[Array, " j"]
    """Global index of the first body."""
    body_b: Int[Array, " j"]
    """Global index of the second body."""
    anchor_a: Float[Array, "j 2"]
    """Attachment in the frame of body a [m]."""
    anchor_b: Float[Array, "j 2"]
    """Attachment in the frame of body b [m]."""
    active: Bool[Array, " j"]
    """True where the slot holds a joint."""
    fixed: Bool[Array, " j"]
    """True: a weld, which also holds the angle; False: revolute."""
    reference_angle: Float[Array, " j"]
    """The relative angle that counts as zero [rad]."""
    motor_on: Bool[Array, " j"]
    """True where the joint answers to a control."""
    motor_speed: Float[Array, " j"]
    """Target speed in units of `Parameters.base_motor_speed`."""
    motor_power: Float[Array, " j"]
    """Strength in units of `Parameters.base_motor_power`."""
    limited: Bool[Array, " j"]
    """True where the two limits hold."""
    limit_min: Float[Array, " j"]
    """Least angle, measured from the reference angle [rad]."""
    limit_max: Float[Array, " j"]
    """Greatest angle, measured from the reference angle [rad]."""


@pytree
class Thrusters:
    """Constants of a level's thrusters."""

    body: Int[Array, " t"]
    """Global index of the body that is pushed."""
    position: Float[Array, "t 2"]
    """Attachment in the body's frame [m]."""
    angle: Float[Array, " t"]
    """Direction of the push, relative to the body [rad]."""
    power: Float[Array, " t"]
    """Strength in units of `Parameters.base_thruster_power`."""
    active: Bool[Array, " t"]
    """True where the slot holds a thruster."""


@pytree
class World:
    """Everything that a level fixes and no step changes."""

    bodies: Bodies
    joints: Joints
    thrusters: Thrusters
    gravity: Float[Array, "2"]
    """Acceleration of gravity [m/s²]."""
    collides: Bool[Array, "b b"]
    """False between bodies of one jointed component and on the diagonal. Derived: written by
    `kinetix.engine.pairs.collision_matrix` alone."""


@pytree
class State:
    """Everything that a step changes."""

    position: Float[Array, "b 2"]
    """Centres of mass [m] (fixed bodies: the origin of their frame)."""
    rotation: Float[Array, " b"]
    """Angles [rad], counter-clockwise, never wrapped."""
    velocity: Float[Array, "b 2"]
    """Velocities of the centres of mass [m/s]."""
    angular_velocity: Float[Array, " b"]
    """Angular velocities [rad/s]."""
    touching: Bool[Array, " q"]
    """Candidate pairs that touched in the last step, in the order of `pairs.candidate_pairs`; all
    false before the first step. Pairs that never push each other are included."""
    overflow: Bool[Array, ""]
    """True where the last step met more contacts than the solver has room for."""
    cache: Any
    """Solver memory from step to step, such as impulses; a pytree of its own."""


@pytree
class Control:
    """Controls of one step."""

    motor: Float[Array, " j"]
    """Per joint, −1 … 1; +1 turns body b counter-clockwise relative to body a; 0 is no torque."""
    thruster: Float[Array, " t"]
    """Per thruster, 0 … 1."""


@pytree
class Parameters:
    """Numbers that may change without recompiling."""

    dt: Float[Array, ""]
    """Time step [s]."""
    base_friction: Float[Array, ""]
    """Factor of the friction mixing rule."""
    base_motor_speed: Float[Array, ""]
    """[rad/s] for a motor speed of 1."""
    base_motor_power: Float[Array, ""]
    """[rad/s²] of relative angular acceleration for a motor power of 1."""
    base_thruster_power: Float[Array, ""]
    """[N] for a thruster power of 1."""
    motor_decay_coefficient: Float[Array, ""]
    """k in the motor's tanh(k·speed error) [s/rad]."""
    motor_joint_limit: Float[Array, ""]
    """Band before a limit in which a motor fades out [rad]."""
    clip_position: Float[Array, ""]
    """Bound of each coordinate [m]."""
    clip_velocity: Float[Array, ""]
    """Bound of each velocity component [m/s]."""
    clip_angular_velocity: Float[Array, ""]
    """Bound of the angular velocity [rad/s]."""
    slop: Float[Array, ""]
    """Overlap that the `jax2d` preset leaves alone [m]."""
    baumgarte_collision: Float[Array, ""]
    """Share of the overlap that the `jax2d` preset resolves in a step."""
    baumgarte_joint_velocity: Float[Array, ""]
    """Joint error fed into the velocity, `jax2d` preset [1/s]."""
    baumgarte_joint_position: Float[Array, ""]
    """Share of the joint error moved directly, `jax2d` preset."""
    baumgarte_fixed_joint: Float[Array, ""]
    """Angle error of a weld fed into the angular velocity, `jax2d` preset [1/s]."""
    baumgarte_limit: Float[Array, ""]
    """Limit violation fed into the angular velocity, `jax2d` preset [1/s]."""
    joint_stiffness: Float[Array, ""]
    """Relaxation of the joint impulses, `jax2d` preset."""


def default_parameters(**changes: float) -> Parameters:
    """Parameters of every published level, as Python floats (weakly typed: any precision works)."""
    values: dict[str, Any] = {
        "dt": 1 / 60,
        "base_friction": 0.4,
        "base_motor_speed": 6.0,
        "base_motor_power": 900.0,
        "base_thruster_power": 10.0,
        "motor_decay_coefficient": 0.1,
        "motor_joint_limit": 0.1,
        "clip_position": 15.0,
        "clip_velocity": 100.0,
        "clip_angular_velocity": 50.0,
        "slop": 0.01,
        "baumgarte_collision": 0.2,
        "baumgarte_joint_velocity": 2.0,
        "baumgarte_joint_position": 0.7,
        "baumgarte_fixed_joint": 2.0,
        "baumgarte_limit": 5.0,
        "joint_stiffness": 0.6,
    }
    values.update(changes)
    return Parameters(**values)
