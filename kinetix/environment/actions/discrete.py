"""One actuator at a time, or none."""

import dataclasses
from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.environment.actions.base import AbstractAction
from kinetix.environment.spaces import Discrete


@dataclasses.dataclass(frozen=True, kw_only=True)
class DiscreteActions(AbstractAction):
    """One integer: 2m and 2m + 1 drive motor binding m by −1 and +1, then no-op, then thrusters."""

    name: ClassVar[str] = "discrete"

    @property
    def action_space(self) -> Discrete:
        """Two values a motor binding, the no-op, one a thruster binding."""
        return Discrete(n=2 * self.motor_bindings + 1 + self.thruster_bindings)

    def unified(self, action: Int[Array, ""]) -> Float[Array, " u"]:
        """The chosen actuator's entry is −1 or +1, all others are 0."""
        action = jnp.asarray(action)
        motors = jnp.arange(self.motor_bindings)
        forward = (action == 2 * motors + 1).astype(jnp.float32)
        backward = (action == 2 * motors).astype(jnp.float32)
        first_thruster = 2 * self.motor_bindings + 1
        thrusters = action == first_thruster + jnp.arange(self.thruster_bindings)
        return jnp.concatenate([forward - backward, thrusters.astype(jnp.float32)])

    def noop_action(self) -> Int[Array, ""]:
        """Return the integer after those of the motors."""
        return jnp.asarray(2 * self.motor_bindings, jnp.int32)

    def random_action(self, key: Array) -> Int[Array, ""]:
        """Return a random action, uniform over all values."""
        return self.action_space.sample(key)
