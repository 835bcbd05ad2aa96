"""The pieces of PPO's objective: pure functions; axes time `k` and environments `n`."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.training.devices import average

ADVANTAGE_EPSILON = 1e-8
"""Keeps the normalisation of equal advantages finite."""


def generalised_advantages(
    reward: Float[Array, "k n"],
    value: Float[Array, "k n"],
    done: Bool[Array, "k n"],
    last_value: Float[Array, " n"],
    *,
    gamma: float,
    gae_lambda: float,
) -> tuple[Float[Array, "k n"], Float[Array, "k n"]]:
    """Advantages and value targets, from the end backwards.

    Args:
        reward: Reward of each step.
        value: The critic's value before each step.
        done: Whether the episode ended in each step; nothing is carried over that.
        last_value: The critic's value after the last step.
        gamma: Discount.
        gae_lambda: Decay of the estimate.

    Returns:
        Advantages, and targets = advantages + values.

    Source: Schulman et al., "High-Dimensional Continuous Control Using Generalized Advantage
    Estimation" (2015), eq. 16.
    """
    goes_on = 1.0 - done.astype(value.dtype)

    def back(
        carry: tuple[Array, Array], step: tuple[Array, Array, Array]
    ) -> tuple[tuple[Array, Array], Array]:
        advantage, next_value = carry
        reward, value, goes_on = step
        error = reward + gamma * next_value * goes_on - value
        advantage = error + gamma * gae_lambda * goes_on * advantage
        return (advantage, value), advantage

    start = (jnp.zeros_like(last_value), last_value)
    _, advantages = jax.lax.scan(back, start, (reward, value, goes_on), reverse=True)
    return advantages, advantages + value


def normalised(advantage: Float[Array, "k n"]) -> Float[Array, "k n"]:
    """Advantages with mean 0 and deviation 1 over a minibatch of all devices.

    Args:
        advantage: This device's part of them.
    """
    centred = advantage - average(jnp.mean(advantage))
    return centred / (jnp.sqrt(average(jnp.mean(centred**2))) + ADVANTAGE_EPSILON)


def policy_loss(
    log_prob: Float[Array, "k n"],
    old_log_prob: Float[Array, "k n"],
    advantage: Float[Array, "k n"],
    *,
    clip_eps: float,
) -> Float[Array, ""]:
    """Return the clipped surrogate, to be minimised.

    Args:
        log_prob: Of what was done, under the present policy.
        old_log_prob: The same under the policy that did it.
        advantage: `normalised`.
        clip_eps: How far the ratio of the two may be from 1 before it counts no more.

    Source: Schulman et al., "Proximal Policy Optimization Algorithms" (2017), eq. 7.
    """
    ratio = jnp.exp(log_prob - old_log_prob)
    clipped = jnp.clip(ratio, 1.0 - clip_eps, 1.0 + clip_eps)
    return -jnp.mean(jnp.minimum(ratio * advantage, clipped * advantage))


def value_loss(
    value: Float[Array, "k n"],
    old_value: Float[Array, "k n"],
    target: Float[Array, "k n"],
    *,
    clip_eps: float,
) -> Float[Array, ""]:
    """Half the mean squared error, whichever is worse of the value and the clipped value."""
    clipped = old_value + jnp.clip(value - old_value, -clip_eps, clip_eps)
    return 0.5 * jnp.mean(jnp.maximum((value - target) ** 2, (clipped - target) ** 2))
