"""Running mean and variance of observations, one statistic per column, shared by all rows."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from kinetix.agents.card import NormalisationCard
from kinetix.pytree import pytree

EPSILON = 1e-4
"""Keeps the division finite, and is the weight of the prior (mean 0, variance 1)."""


LIMIT = 10.0
"""Normalised values end here: a column that was all but constant would give enormous ones."""


@pytree
class Normalisation:
    """Statistics by field; observations that are one array have the single field ""."""

    count: dict[str, Float[Array, ""]]
    """Rows seen so far; empty slots are none."""
    mean: dict[str, Float[Array, " f"]]
    variance: dict[str, Float[Array, " f"]]


def fields_of(observation: Any) -> dict[str, Array]:
    """Return the parts of an observation that are real numbers, by field.

    Args:
        observation: A named tuple, or one array.
    """
    if not hasattr(observation, "_asdict"):
        return {"": observation}
    fields = observation._asdict()
    return {
        name: value
        for name, value in fields.items()
        if value is not None and jnp.issubdtype(value.dtype, jnp.floating)
    }


def start(observation: Any) -> Normalisation:
    """Return the statistics before the first observation.

    Args:
        observation: Any observation, for its fields and widths.
    """
    fields = fields_of(observation)
    return Normalisation(
        count={name: jnp.asarray(EPSILON) for name in fields},
        mean={name: jnp.zeros(value.shape[-1]) for name, value in fields.items()},
        variance={name: jnp.ones(value.shape[-1]) for name, value in fields.items()},
    )


def update(statistics: Normalisation, observation: Any) -> Normalisation:
    """Take in a batch of observations.

    Args:
        statistics: What was seen before.
        observation: Any leading axes.

    Returns:
        Statistics of everything, weighted by rows.

    Source: Chan, Golub & LeVeque, "Updating Formulae and a Pairwise Algorithm for Computing Sample
    Variances" (1979).
    """
    count, mean, variance = {}, {}, {}
    for name, value in fields_of(observation).items():
        rows = _weights(observation, name, value)
        axes = tuple(range(value.ndim - 1))
        batch = jnp.sum(rows)
        share = rows / jnp.maximum(batch, 1.0)
        batch_mean = jnp.sum(value * share, axes)
        batch_variance = jnp.sum((value - batch_mean) ** 2 * share, axes)
        before = statistics.count[name]
        total = before + batch
        difference = batch_mean - statistics.mean[name]
        count[name] = total
        mean[name] = statistics.mean[name] + difference * batch / total
        squares = (
            statistics.variance[name] * before
            + batch_variance * batch
            + difference**2 * before * batch / total
        )
        variance[name] = squares / total
    return Normalisation(count=count, mean=mean, variance=variance)


def _weights(observation: Any, name: str, value: Array) -> Float[Array, "*n 1"]:
    """1 for rows that hold something, 0 for empty slots."""
    # The mask of `circles` is `circle_mask`.
    mask = getattr(observation, f"{name.removesuffix('s')}_mask", None)
    if mask is None:
        return jnp.ones((*value.shape[:-1], 1), value.dtype)
    return mask[..., None].astype(value.dtype)


def normalise(statistics: Normalisation | None, observation: Any) -> Any:
    """Shift and scale every column to mean 0 and variance 1, within ±`LIMIT`.

    Args:
        statistics: What was seen in training; None leaves the observation as it is.
        observation: Any leading axes.
    """
    if statistics is None:
        return observation
    changed = {
        name: jnp.clip(
            (value - statistics.mean[name]) / jnp.sqrt(statistics.variance[name] + EPSILON),
            -LIMIT,
            LIMIT,
        )
        for name, value in fields_of(observation).items()
    }
    return observation._replace(**changed) if hasattr(observation, "_replace") else changed[""]


def to_card(statistics: Normalisation | None) -> NormalisationCard | None:
    """Return the statistics as plain numbers."""
    if statistics is None:
        return None
    as_lists: Any = jax.tree.map(lambda x: np.asarray(x).tolist(), statistics)
    return NormalisationCard(
        count=max(as_lists.count.values()),
        counts=as_lists.count,
        mean=as_lists.mean,
        variance=as_lists.variance,
    )


def from_card(card: NormalisationCard | None) -> Normalisation | None:
    """Return the statistics that `to_card` stored."""
    if card is None:
        return None
    return Normalisation(
        count={
            name: jnp.asarray(card.counts.get(name, card.count), jnp.float32) for name in card.mean
        },
        mean={name: jnp.asarray(x, jnp.float32) for name, x in card.mean.items()},
        variance={name: jnp.asarray(x, jnp.float32) for name, x in card.variance.items()},
    )
