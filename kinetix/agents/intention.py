"""An agent's intention: its policy's mean action as one number per binding, for overlays."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.actions import AbstractAction, DiscreteActions, MultiDiscreteActions


def intention(actions: AbstractAction, logits: Float[Array, " k"]) -> Float[Array, " u"]:
    """The expected unified action of a policy.

    Args:
        actions: The kind of action.
        logits: The policy's raw output for one environment (for a normal distribution its mean).

    Returns:
        A number −1 … 1 per motor binding (probability of forward minus that of backward), then one
        0 … 1 per thruster binding.
    """
    kind: Any = actions
    if isinstance(actions, MultiDiscreteActions):
        split = 3 * kind.motor_bindings
        motors = jax.nn.softmax(logits[:split].reshape(kind.motor_bindings, 3), axis=-1)
        thrusters = jax.nn.softmax(logits[split:].reshape(kind.thruster_bindings, 2), axis=-1)
        return jnp.concatenate([motors[:, 1] - motors[:, 2], thrusters[:, 1]])
    if isinstance(actions, DiscreteActions):
        each = jax.vmap(actions.unified)(jnp.arange(logits.shape[0]))
        return jax.nn.softmax(logits) @ each
    return actions.unified(logits)
