"""Motors and thrusters: a control becomes impulses. Worlds on the last axis."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.engine.lookup import onto, take, take_pair
from kinetix.engine.maths import Vec, cross, nonzero, rotate, vec
from kinetix.engine.types import Control, Parameters, World
from kinetix.pytree import pytree


def motor_fade(
    world: World,
    angle: Float[Array, "j n"],
    drive: Float[Array, "j n"],
    free: tuple[Float[Array, "j n"], Float[Array, "j n"]],
    parameters: Parameters,
) -> Float[Array, "j n"]:
    """Return a motor's share of strength near a limit: 1 away from it, or when leaving it.

    Args:
        world: The worlds.
        angle: Of the joints, from their reference angle [rad].
        drive: Only its sign counts: which way the motor wants to turn the joint.
        free: Lowest and highest angle at which the motor has its full strength [rad].
        parameters: The constants of the law.
    """
    joints = world.joints
    band = parameters.motor_joint_limit
    beyond = angle - jnp.clip(angle, *free)
    faded = jnp.where(
        ~joints.limited | (beyond == 0), 1, jnp.maximum(0, 1 - jnp.abs(beyond) / band)
    )
    return jnp.maximum(faded, (jnp.sign(beyond) != jnp.sign(drive)).astype(faded.dtype))


def _free_range(
    world: World, parameters: Parameters
) -> tuple[Float[Array, "j n"], Float[Array, "j n"]]:
    """Lowest and highest angle at which a motor has its full strength [rad].

    Where the limits are closer together than two bands, both are the middle: neither direction is
    stronger than the other.
    """
    joints, band = world.joints, parameters.motor_joint_limit
    middle = (joints.limit_min + joints.limit_max) / 2
    low = jnp.minimum(joints.limit_min + band, middle)
    return low, jnp.maximum(joints.limit_max - band, middle)


def motor_runs(world: World, action: Float[Array, "j n"]) -> Bool[Array, "j n"]:
    """Mark the motors that act: on, revolute, driven, between bodies not both fixed."""
    joints, bodies = world.joints, world.bodies
    (active_a, mass_a), (active_b, mass_b) = take_pair(
        (bodies.active, bodies.inverse_mass), joints.body_a, joints.body_b
    )
    acts = joints.active & joints.motor_on & ~joints.fixed & (action != 0)
    return acts & active_a & active_b & (mass_a + mass_b > 0)


@pytree
class Motors:
    """Inputs of the motor law, poses and velocities aside."""

    runs: Bool[Array, "j n"]
    inverse_inertia: Float[Array, "j n"]
    """Of both bodies together [1/(kg m²)]."""


def motors(world: World, action: Float[Array, "j n"]) -> Motors:
    """Return the motors under a control of −1 … 1."""
    joints = world.joints
    inertia_a, inertia_b = take_pair(world.bodies.inverse_inertia, joints.body_a, joints.body_b)
    return Motors(runs=motor_runs(world, action), inverse_inertia=inertia_a + inertia_b)


def motor_row(
    world: World,
    motors: Motors,
    angle: Float[Array, "j n"],
    spin: Float[Array, "j n"],
    action: Float[Array, "j n"],
    parameters: Parameters,
    duration: Float[Array, " n"],
) -> tuple[Float[Array, "j n"], Float[Array, "j n"]]:
    """Each motor as a soft constraint: the speed it wants, and its compliance (0: it is off).

    The law is torque = −(strength/inertia)·tanh(k·error). For a while it is replaced by its secant
    through the present error, taken at the error that *remains*: impulse = −error/compliance. That
    is exact at rest, at stall and at full speed, first order in between, stable at any strength.

    Args:
        world: The worlds.
        motors: Theirs.
        angle: Of the joints, from their reference angle [rad].
        spin: Speed of body b relative to a [rad/s].
        action: −1 … 1.
        parameters: The constants of the law.
        duration: For how long the motors act [s].

    Returns:
        Speed [rad/s], and speed error left per unit of impulse [rad/s / (N m s)].
    """
    joints = world.joints
    target = parameters.base_motor_speed * joints.motor_speed * action
    strength = (
        parameters.base_motor_power
        * joints.motor_power
        * motor_fade(world, angle, target, _free_range(world, parameters), parameters)
        / nonzero(motors.inverse_inertia)
    )
    k = parameters.motor_decay_coefficient
    # tanh(x)/x is 1 to rounding below 1e-4, where dividing would lose digits.
    x = jnp.maximum(k * jnp.abs(spin - target), 1e-4)
    slope = duration * strength * k * jnp.tanh(x) / x
    runs = motors.runs & (slope > 0)
    return jnp.where(runs, target, 0), jnp.where(runs, 1 / nonzero(slope), 0)


def thrust(
    world: World, rotation: Float[Array, "b n"], control: Control, parameters: Parameters
) -> tuple[Vec, Float[Array, "b n"]]:
    """Acceleration [m/s²] and angular acceleration [rad/s²] of all bodies under their thrusters."""
    thrusters, bodies = world.thrusters, world.bodies
    angle = take(rotation, thrusters.body)
    cos, sin = jnp.cos(angle), jnp.sin(angle)
    direction = rotate(cos, sin, Vec(x=jnp.cos(thrusters.angle), y=jnp.sin(thrusters.angle)))
    force = parameters.base_thruster_power * thrusters.power * control.thruster * thrusters.active
    push = direction * force
    arm = rotate(cos, sin, vec(thrusters.position))
    linear, angular = onto((push, cross(arm, push)), thrusters.body, bodies.inverse_mass.shape[0])
    return linear * bodies.inverse_mass, angular * bodies.inverse_inertia


def acceleration(
    world: World, rotation: Float[Array, "b n"], control: Control, parameters: Parameters
) -> tuple[Vec, Float[Array, "b n"]]:
    """Acceleration [m/s²] and angular acceleration [rad/s²] of all bodies by gravity and thrust."""
    linear, angular = thrust(world, rotation, control, parameters)
    moves = (world.bodies.inverse_mass > 0).astype(rotation.dtype)
    return Vec(
        x=linear.x + world.gravity[0] * moves, y=linear.y + world.gravity[1] * moves
    ), angular
