"""Scores of rollouts, by which levels are replayed; axes time `k` and environments `n`."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.training.config import ScoreFunction
from kinetix.training.curricula.tally import Tally, learnability
from kinetix.training.ppo.losses import generalised_advantages
from kinetix.training.ppo.rollout import Rollout


def best_return(rollout: Rollout, *, gamma: float = 1.0) -> Float[Array, " n"]:
    """Return the largest return of the finished episodes; −∞ where none finished.

    Args:
        rollout: What was played; the first step of each environment begins an episode.
        gamma: Discount per step, from an episode's start. Values are discounted, so what they are
            subtracted from should be.
    """
    trajectory = rollout.trajectory

    def step(
        carry: tuple[Array, Array, Array], inputs: tuple[Array, Array]
    ) -> tuple[tuple[Array, Array, Array], Array]:
        before, discounted, factor = carry
        total, done = inputs
        discounted = discounted + factor * (total - before)
        over = jnp.where(done, discounted, -jnp.inf)
        goes_on = 1.0 - done
        following = (total * goes_on, discounted * goes_on, jnp.where(done, 1.0, factor * gamma))
        return following, over

    zero = jnp.zeros_like(rollout.last_value)
    start = (zero, zero, jnp.ones_like(zero))
    _, returns = jax.lax.scan(step, start, (trajectory.episode_return, trajectory.done))
    return jnp.max(returns, axis=0)


def level_scores(
    name: ScoreFunction,
    rollout: Rollout,
    max_return: Float[Array, " n"],
    *,
    gamma: float,
    gae_lambda: float,
) -> Float[Array, " n"]:
    """Score each environment's level; −∞ (learnability: 0) where no episode finished.

    Args:
        name: MaxMC (how far values lie below the best return), pvl (mean positive advantage) or
            learnability.
        rollout: What was played on the levels.
        max_return: Best return of all visits.
        gamma: Discount, for pvl.
        gae_lambda: Decay, for pvl.

    Source: Jiang et al., "Replay-Guided Adversarial Environment Design" (2021).
    """
    trajectory = rollout.trajectory
    if name == "learnability":
        tally = Tally(
            episodes=jnp.sum(trajectory.done, axis=0),
            solved=jnp.sum(trajectory.done & trajectory.solved, axis=0),
        )
        return learnability(tally, correction=False)
    if name == "MaxMC":
        # Where nothing finished there is no best return, and the score is −∞ anyway.
        best = jnp.where(jnp.isfinite(max_return), max_return, 0.0)
        return episode_mean(best - trajectory.value, trajectory.done)
    advantage, _ = generalised_advantages(
        trajectory.reward,
        trajectory.value,
        trajectory.done,
        rollout.last_value,
        gamma=gamma,
        gae_lambda=gae_lambda,
    )
    return episode_mean(jnp.maximum(advantage, 0.0), trajectory.done)


def episode_mean(values: Float[Array, "k n"], done: Array) -> Float[Array, " n"]:
    """Return the mean over finished episodes of the mean over their steps; −∞ where none finished.

    Args:
        values: One number a step.
        done: Which steps were the last of their episode.
    """

    def step(
        carry: tuple[Array, Array, Array, Array], inputs: tuple[Array, Array]
    ) -> tuple[tuple[Array, Array, Array, Array], None]:
        running, length, total, episodes = carry
        value, ended = inputs
        running, length = running + value, length + 1.0
        total = total + jnp.where(ended, running / length, 0.0)
        keep = 1.0 - ended
        return (running * keep, length * keep, total, episodes + ended), None

    zero = jnp.zeros(values.shape[1])
    (_, _, total, episodes), _ = jax.lax.scan(step, (zero, zero, zero, zero), (values, done))
    return jnp.where(episodes > 0, total / jnp.maximum(episodes, 1.0), -jnp.inf)
