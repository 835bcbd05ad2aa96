"""What an actor says: distributions over the three kinds of action, and the heads that make them.

Log-probabilities and entropies of compound actions are sums over their parts.
"""

import dataclasses
import itertools
from typing import Protocol

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from kinetix.pytree import pytree, static


class Distribution(Protocol):
    """A distribution over actions with any leading axes; every distribution is a pytree."""

    @property
    def logits(self) -> Float[Array, "*n k"]:
        """The network's raw output (for a normal distribution its mean)."""
        ...

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Array:
        """Draw one action; logits are divided by the temperature (deviations multiplied)."""
        ...

    def mode(self) -> Array:
        """The likeliest action."""
        ...

    def log_prob(self, action: Array) -> Float[Array, "*n"]:
        """Log-probability (density) of an action, summed over its parts."""
        ...

    def entropy(self) -> Float[Array, "*n"]:
        """Entropy [nat], summed over the parts of an action."""
        ...


@pytree
class MultiCategorical:
    """Independent categoricals whose logits lie one after the other on the last axis."""

    logits: Float[Array, "*n k"]
    """Unnormalised log-probabilities of all parts."""
    sizes: tuple[int, ...] = static()
    """Number of choices of each part; their sum is `k`."""

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Int[Array, "*n parts"]:
        """Draw every part independently."""
        # The Gumbel trick once over all logits: one call of the generator instead of one a part.
        noise = jax.random.gumbel(key, self.logits.shape, self.logits.dtype)
        return self._argmax(self.logits / temperature + noise)

    def mode(self) -> Int[Array, "*n parts"]:
        """The likeliest choice of every part."""
        return self._argmax(self.logits)

    def log_prob(self, action: Int[Array, "*n parts"]) -> Float[Array, "*n"]:
        """Sum of the parts' log-probabilities."""
        parts = self.log_probs()
        total = jnp.zeros(self.logits.shape[:-1], self.logits.dtype)
        for index, part in enumerate(parts):
            # A one-hot product instead of a gather: its gradient is no scatter.
            chosen = jax.nn.one_hot(action[..., index], part.shape[-1], dtype=part.dtype)
            total = total + jnp.sum(part * chosen, axis=-1)
        return total

    def entropy(self) -> Float[Array, "*n"]:
        """Sum of the parts' entropies [nat]."""
        return -sum(
            (jnp.sum(jnp.exp(part) * part, axis=-1) for part in self.log_probs()),
            start=jnp.zeros(self.logits.shape[:-1], self.logits.dtype),
        )

    def log_probs(self) -> list[Float[Array, "*n choices"]]:
        """Normalised log-probabilities, one array a part."""
        return [jax.nn.log_softmax(part) for part in self._split(self.logits)]

    def _split(self, values: Array) -> list[Array]:
        bounds = itertools.accumulate(self.sizes, initial=0)
        return [values[..., a:b] for a, b in itertools.pairwise(bounds)]

    def _argmax(self, scores: Array) -> Array:
        return jnp.stack([jnp.argmax(part, axis=-1) for part in self._split(scores)], axis=-1)


@pytree
class Categorical:
    """One choice of `k`; the action is a single integer."""

    logits: Float[Array, "*n k"]
    """Unnormalised log-probabilities."""

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Int[Array, "*n"]:
        """Draw one choice."""
        return jax.random.categorical(key, self.logits / temperature)

    def mode(self) -> Int[Array, "*n"]:
        """The likeliest choice."""
        return jnp.argmax(self.logits, axis=-1)

    def log_prob(self, action: Int[Array, "*n"]) -> Float[Array, "*n"]:
        """Log-probability of a choice."""
        chosen = jax.nn.one_hot(action, self.logits.shape[-1], dtype=self.logits.dtype)
        return jnp.sum(jax.nn.log_softmax(self.logits) * chosen, axis=-1)

    def entropy(self) -> Float[Array, "*n"]:
        """Entropy [nat]."""
        log_probs = jax.nn.log_softmax(self.logits)
        return -jnp.sum(jnp.exp(log_probs) * log_probs, axis=-1)


@pytree
class DiagonalNormal:
    """Independent normal distributions; nothing is squashed, the environment clips."""

    logits: Float[Array, "*n d"]
    """Means, which is what the network says."""
    log_std: Float[Array, " d"]
    """Logarithms of the standard deviations; the same in every state."""

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Float[Array, "*n d"]:
        """Draw one vector; the temperature multiplies the deviations."""
        noise = jax.random.normal(key, self.logits.shape, self.logits.dtype)
        return self.logits + noise * jnp.exp(self.log_std) * temperature

    def mode(self) -> Float[Array, "*n d"]:
        """The mean."""
        return self.logits

    def log_prob(self, action: Float[Array, "*n d"]) -> Float[Array, "*n"]:
        """Log-density of a vector."""
        distance = (action - self.logits) * jnp.exp(-self.log_std)
        constant = jnp.log(2 * jnp.pi)
        return -0.5 * jnp.sum(distance**2 + 2 * self.log_std + constant, axis=-1)

    def entropy(self) -> Float[Array, "*n"]:
        """Differential entropy [nat]."""
        each = self.log_std + 0.5 * (1 + jnp.log(2 * jnp.pi))
        return jnp.broadcast_to(jnp.sum(each), self.logits.shape[:-1])


@dataclasses.dataclass(frozen=True, kw_only=True)
class MultiDiscreteHead:
    """A head that makes several independent choices at once."""

    sizes: tuple[int, ...]
    """Number of choices of each."""
    needs_log_std = False

    @property
    def dimension(self) -> int:
        """Number of outputs that the network gives."""
        return sum(self.sizes)

    def __call__(self, logits: Array, log_std: Array | None) -> Distribution:
        """The distribution of these outputs; `log_std` is ignored."""
        del log_std
        return MultiCategorical(logits=logits, sizes=self.sizes)


@dataclasses.dataclass(frozen=True, kw_only=True)
class DiscreteHead:
    """A head that makes one choice."""

    choices: int
    """Number of choices."""
    needs_log_std = False

    @property
    def dimension(self) -> int:
        """Number of outputs that the network gives."""
        return self.choices

    def __call__(self, logits: Array, log_std: Array | None) -> Distribution:
        """The distribution of these outputs; `log_std` is ignored."""
        del log_std
        return Categorical(logits=logits)


@dataclasses.dataclass(frozen=True, kw_only=True)
class ContinuousHead:
    """A head for real-valued actions."""

    size: int
    """Number of reals in an action."""
    needs_log_std = True

    @property
    def dimension(self) -> int:
        """Number of outputs that the network gives."""
        return self.size

    def __call__(self, logits: Array, log_std: Array | None) -> Distribution:
        """The normal distribution with these means.

        Raises:
            ValueError: There is no `log_std`.
        """
        if log_std is None:
            raise ValueError("a continuous head needs the parameter log_std")
        return DiagonalNormal(logits=logits, log_std=log_std)


ActionHead = MultiDiscreteHead | DiscreteHead | ContinuousHead


def action_head(
    action_type: str, *, motor_bindings: int = 4, thruster_bindings: int = 2
) -> ActionHead:
    """The head for a type of action.

    Args:
        action_type: "multi_discrete", "discrete" or "continuous".
        motor_bindings: Number of motor bindings; three choices each (off, forwards, backwards).
        thruster_bindings: Number of thruster bindings; two choices each.

    Returns:
        The head; its sizes are those of the environment's action space.

    Raises:
        ValueError: Unknown action type.
    """
    match action_type:
        case "multi_discrete":
            return MultiDiscreteHead(sizes=(3,) * motor_bindings + (2,) * thruster_bindings)
        case "discrete":
            return DiscreteHead(choices=2 * motor_bindings + 1 + thruster_bindings)
        case "continuous":
            return ContinuousHead(size=motor_bindings + thruster_bindings)
    raise ValueError(
        f"action type: expected multi_discrete, discrete or continuous, got {action_type!r}"
    )
