"""One class per binding: motors off, forward, backward; thrusters off, on."""

import dataclasses
from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from kinetix.environment.actions.base import AbstractAction
from kinetix.environment.spaces import MultiDiscrete


@dataclasses.dataclass(frozen=True, kw_only=True)
class MultiDiscreteActions(AbstractAction):
    """Integers: for a motor 0, 1, 2 mean 0, +1, −1; for a thruster 0, 1 mean off, on."""

    name: ClassVar[str] = "multi_discrete"

    @property
    def action_space(self) -> MultiDiscrete:
        """Three classes a motor binding, two a thruster binding."""
        return MultiDiscrete(
            number_of_dims_per_distribution=(3,) * self.motor_bindings
            + (2,) * self.thruster_bindings
        )

    def unified(self, action: Int[Array, " u"]) -> Float[Array, " u"]:
        """Classes to numbers; whatever is no class counts as 0."""
        action = jnp.asarray(action)
        is_motor = jnp.arange(action.shape[0]) < self.motor_bindings
        forward = (action == 1).astype(jnp.float32)
        backward = ((action == 2) & is_motor).astype(jnp.float32)
        return forward - backward

    def noop_action(self) -> Int[Array, " u"]:
        """Return an action of zeros."""
        return jnp.zeros(self.action_space.shape, jnp.int32)

    def random_action(self, key: Array) -> Int[Array, " u"]:
        """Return a random action, uniform over the classes of every entry."""
        return self.action_space.sample(key)
