"""Learning rates over a training, and the optimiser."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import optax
from jaxtyping import Array, Bool

from kinetix.training.config import PpoConfig

ADAM_EPSILON = 1e-5
"""As published; larger than Adam's usual 1e-8, because gradients of PPO are small and noisy."""


def learning_rate(config: PpoConfig, gradient_steps: int) -> Callable[[Any], Any]:
    """Return the learning rate as a function of the number of gradient steps done.

    Args:
        config: The configuration.
        gradient_steps: Gradient steps of the whole training.
    """
    if config.anneal_lr:
        # By updates, not by gradient steps: one rollout is learnt from at one rate.
        per_update = config.num_minibatches * config.update_epochs
        updates = max(gradient_steps // per_update, 1)
        return lambda count: (
            config.learning_rate * jnp.maximum(1.0 - (count // per_update) / updates, 0.0)
        )
    if config.warmup_lr:
        return optax.warmup_cosine_decay_schedule(
            init_value=config.initial_lr,
            peak_value=config.peak_lr,
            # Optax wants a step in which the rate falls.
            warmup_steps=min(int(gradient_steps * config.warmup_frac), gradient_steps - 1),
            decay_steps=gradient_steps,
        )
    return optax.constant_schedule(config.learning_rate)


def adam_anew(state: Any, now: Bool[Array, ""]) -> Any:
    """Let Adam's averages count as begun at this moment.

    What had no gradient until now has averages of 0, and Adam would divide by the root of a second
    one that is far too small: its first steps would be four times the learning rate.

    Args:
        state: Of an optimiser of `make_optimiser`.
        now: Whether this is the moment; the state stays as it is otherwise.
    """

    def is_adam(part: Any) -> bool:
        return isinstance(part, optax.ScaleByAdamState)

    def begun(part: Any) -> Any:
        return part._replace(count=jnp.where(now, 0, part.count)) if is_adam(part) else part

    return jax.tree.map(begun, state, is_leaf=is_adam)


def make_optimiser(config: PpoConfig, gradient_steps: int) -> optax.GradientTransformation:
    """Gradients clipped by their norm, then Adam.

    Args:
        config: The configuration.
        gradient_steps: Gradient steps of the whole training.
    """
    return optax.chain(
        optax.clip_by_global_norm(config.max_grad_norm),
        optax.adam(learning_rate(config, gradient_steps), eps=ADAM_EPSILON),
    )
