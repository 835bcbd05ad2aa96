"""Motors as soft rows that never let go within a step. Worlds on the last axis."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.engine.actuators import Motors, motor_row, motors
from kinetix.engine.solvers.rows import Links
from kinetix.engine.store import Store
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


@pytree
class MotorRows:
    """The motors of a step.

    Contacts and limits are prepared for joints with the motors of the step's start. A motor that
    let go later would leave the limit that stops its arm too strong: the arm would be thrown back.
    So a motor may become stiffer within a step, but not softer.
    """

    world: World
    motors: Motors
    action: Float[Array, "j n"]
    parameters: Parameters
    duration: Float[Array, " n"]
    """For how long the motors act in one solve [s]."""
    wanted: Float[Array, "j n"]
    """Speed that a motor wants [rad/s]; 0 for the rest."""
    compliance: Float[Array, "j n"]
    """Of a motor at the start of the step, as `motor_row` has it; 0 where none runs."""

    def later(self, angle: Float[Array, "j n"], spin: Float[Array, "j n"]) -> Float[Array, "j n"]:
        """Return the compliance at a later moment of the step: what it was, or less.

        Args:
            angle: Of the joints, from their reference angle [rad].
            spin: Speed of body b relative to a [rad/s].
        """
        _, now = motor_row(
            self.world, self.motors, angle, spin, self.action, self.parameters, self.duration
        )
        return jnp.where(now > 0, jnp.minimum(now, self.compliance), self.compliance)


def motor_rows(
    world: World,
    links: Links,
    state: State,
    control: Control,
    parameters: Parameters,
    duration: Float[Array, " n"],
    store: Store,
) -> MotorRows:
    """Return the motors at the start of a step.

    Args:
        world: The worlds.
        links: The joints' bodies.
        state: At the start of the step.
        control: What drives the motors.
        parameters: The constants of their law.
        duration: For how long they act in one solve [s].
        store: Keeps intermediate results.
    """
    action = control.motor
    found = store(motors(world, action))
    (angle_a, spin_a), (angle_b, spin_b) = links.look_up((state.rotation, state.angular_velocity))
    angle = angle_b - angle_a - world.joints.reference_angle
    wanted, compliance = motor_row(
        world, found, angle, spin_b - spin_a, action, parameters, duration
    )
    return MotorRows(
        world=world,
        motors=found,
        action=action,
        parameters=parameters,
        duration=duration,
        wanted=wanted,
        compliance=store(compliance),
    )
