"""Real numbers for all bindings at once."""

import dataclasses
from typing import ClassVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.actions.base import AbstractAction
from kinetix.environment.spaces import Box


@dataclasses.dataclass(frozen=True, kw_only=True)
class ContinuousActions(AbstractAction):
    """The unified action itself; what lies outside its bounds is clipped."""

    name: ClassVar[str] = "continuous"

    @property
    def action_space(self) -> Box:
        """−1 … 1 for motors, 0 … 1 for thrusters."""
        bindings = self.motor_bindings + self.thruster_bindings
        return Box(
            low=(-1.0,) * self.motor_bindings + (0.0,) * self.thruster_bindings,
            high=(1.0,) * bindings,
            shape=(bindings,),
        )

    def unified(self, action: Float[Array, " u"]) -> Float[Array, " u"]:
        """Return the action, clipped to the space."""
        space = self.action_space
        return jnp.clip(
            jnp.asarray(action, jnp.float32), jnp.array(space.low), jnp.array(space.high)
        )

    def noop_action(self) -> Float[Array, " u"]:
        """Return an action of zeros."""
        return jnp.zeros(self.action_space.shape, jnp.float32)

    def random_action(self, key: Array) -> Float[Array, " u"]:
        """Return a number uniform in −1 … 1, the absolute value for thrusters."""
        uniform = jax.random.uniform(key, self.action_space.shape, minval=-1.0, maxval=1.0)
        is_motor = jnp.arange(uniform.shape[0]) < self.motor_bindings
        return jnp.where(is_motor, uniform, jnp.abs(uniform))
