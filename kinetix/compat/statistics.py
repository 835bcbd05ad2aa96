"""kinetix-env's running statistics of observations, and sums over parameters."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.spaces import ObservationType
from kinetix.pytree import pytree

EPSILON = 1e-4
"""Keeps the division by a standard deviation finite, and is the count at the start."""


@pytree
class RunningMeanStandard:
    """Mean and variance of one array of observations; a tree of such describes all of them."""

    mean: Any
    var: Any
    count: Any
    epsilon: Any = EPSILON


def rms_should_normalise(x: Any) -> bool:
    """Return whether an array holds reals; masks and indices stay as they are."""
    return jnp.issubdtype(jnp.result_type(x), jnp.floating)


def rms_is_leaf(node: Any) -> bool:
    """Return whether a node of a tree is the statistics of one array."""
    return isinstance(node, RunningMeanStandard)


def rms_init(obs: Any, epsilon: float = EPSILON) -> Any:
    """Return statistics for one observation (without batch axes), of nothing seen so far."""
    return jax.tree.map(
        lambda x: RunningMeanStandard(
            mean=jnp.zeros_like(x), var=jnp.ones_like(x), count=jnp.asarray(epsilon)
        ),
        obs,
    )


def rms_init_from_batch(
    obs: Any, observation_type: ObservationType | str | None = None, epsilon: float = EPSILON
) -> Any:
    """Return statistics of a batch of observations (one leading axis)."""
    del observation_type
    return rms_update(rms_init(jax.tree.map(lambda x: x[0], obs), epsilon), obs)


def _moments(x: Array) -> tuple[Array, Array, Array]:
    return jnp.mean(x, axis=0), jnp.var(x, axis=0), jnp.asarray(float(x.shape[0]))


def _merged(old: RunningMeanStandard, mean: Array, var: Array, count: Array) -> RunningMeanStandard:
    """Return the statistics of both samples together.

    Source: Chan, Golub and LeVeque, "Algorithms for computing the sample variance" (1983).
    """
    total = old.count + count
    delta = mean - old.mean
    squares = old.var * old.count + var * count + delta**2 * old.count * count / total
    return RunningMeanStandard(
        mean=old.mean + delta * count / total,
        var=squares / total,
        count=total,
        epsilon=old.epsilon,
    )


def _rows(statistics: RunningMeanStandard, x: Array) -> Array:
    """Return all leading axes as one."""
    shape = jnp.shape(statistics.mean)
    return jnp.reshape(x, (-1, *shape))


def rms_update(rms: Any, observations: Any, flatten: bool | str = "auto") -> Any:
    """Return statistics that have also seen a batch, with any number of leading axes."""
    del flatten

    def one(statistics: RunningMeanStandard, x: Array) -> RunningMeanStandard:
        if not rms_should_normalise(x):
            return statistics
        return _merged(statistics, *_moments(_rows(statistics, x)))

    return jax.tree.map(one, rms, observations, is_leaf=rms_is_leaf)


def rms_normalise(rms: Any, observations: Any, flatten: bool | str = "auto") -> Any:
    """Return observations, with any number of leading axes, in standard deviations."""
    del flatten

    def one(statistics: RunningMeanStandard, x: Array) -> Array:
        if not rms_should_normalise(x):
            return x
        return (x - statistics.mean) / jnp.sqrt(statistics.var + statistics.epsilon)

    return jax.tree.map(one, rms, observations, is_leaf=rms_is_leaf)


def maybe_normalise(static_should_normalise: bool, rms: Any, obs: Any) -> Any:
    """Return observations in standard deviations where that is asked for."""
    return rms_normalise(rms, obs) if static_should_normalise else obs


def parallel_rms_update(rms: Any, data: Any, axis_name: str = "devices") -> Any:
    """Return statistics that have also seen the batches of all devices of an axis.

    The mean of all comes first and deviations are taken from it: squares of large means would
    swallow a small variance.
    """

    def one(statistics: RunningMeanStandard, x: Array) -> RunningMeanStandard:
        if not rms_should_normalise(x):
            return statistics
        rows = _rows(statistics, x)
        count = jax.lax.psum(jnp.asarray(float(rows.shape[0])), axis_name)
        mean = jax.lax.psum(jnp.sum(rows, axis=0), axis_name) / count
        deviation = jax.lax.psum(jnp.sum((rows - mean) ** 2, axis=0), axis_name)
        return _merged(statistics, mean, deviation / count, count)

    return jax.tree.map(one, rms, data, is_leaf=rms_is_leaf)


class EMA(NamedTuple):
    """Exponential moving average of a number, without a bias towards its start."""

    value: Any = 0.0
    count: Any = 0
    """Number of values seen."""
    beta: float = 0.99
    """Weight of a value relative to the one after it."""

    def update_ema(self, current_value: Any) -> "EMA":
        """Return the average with one value more."""
        weight = (1 - self.beta) / (1 - self.beta ** (self.count + 1))
        value = (1 - weight) * self.value + weight * current_value
        return EMA(value=value, count=self.count + 1, beta=self.beta)


def weight_norm(tree: Any) -> Float[Array, ""]:
    """Return the Euclidean norm of all parameters together."""
    return jnp.sqrt(sum(jnp.sum(jnp.square(leaf)) for leaf in jax.tree.leaves(tree)))
