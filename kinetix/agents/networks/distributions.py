"""Outputs of an actor: distributions over the three kinds of action, and the heads that make them.

Log-probabilities and entropies of compound actions are sums over their parts. `restricted` leaves
out the controls that a level does not have: their logits change nothing.
"""

import dataclasses
import itertools
from typing import Any, Protocol

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

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
        """Return the likeliest action."""
        ...

    def log_prob(self, action: Array) -> Float[Array, "*n"]:
        """Log-probability (density) of an action, summed over its parts."""
        ...

    def entropy(self) -> Float[Array, "*n"]:
        """Entropy [nat], summed over the parts of an action."""
        ...

    def divergence(self, other: Any) -> Float[Array, "*n"]:
        """Return the Kullback–Leibler divergence of another one of the kind from this one [nat].

        It is 0 for equal distributions; parts that are not live do not count.
        """
        ...

    def restricted(self, live: Bool[Array, "*n u"]) -> "Distribution":
        """Return the distribution over what some controls do.

        Args:
            live: Motor bindings, then thruster bindings: those that drive anything.
        """
        ...

    def chances(self, motor_bindings: int) -> Float[Array, "*n u 3"]:
        """Return each control's probabilities of −1 (backward), 0 (at rest) and +1.

        Args:
            motor_bindings: How many of the controls are motors; the others are thrusters.
        """
        ...


@pytree
class MultiCategorical:
    """Independent categoricals whose logits lie one after the other on the last axis."""

    logits: Float[Array, "*n k"]
    """Unnormalised log-probabilities of all parts."""
    sizes: tuple[int, ...] = static()
    """Number of choices of each part; their sum is `k`."""
    live: Bool[Array, "*n parts"] | None = None
    """Parts that count in log-probabilities and entropies; None: all."""

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Int[Array, "*n parts"]:
        """Draw every part independently."""
        # The Gumbel trick once over all logits: one call of the generator instead of one a part.
        noise = jax.random.gumbel(key, self.logits.shape, self.logits.dtype)
        return self._argmax(self.logits / temperature + noise)

    def mode(self) -> Int[Array, "*n parts"]:
        """Return the likeliest choice of every part."""
        return self._argmax(self.logits)

    def log_prob(self, action: Int[Array, "*n parts"]) -> Float[Array, "*n"]:
        """Return the sum of the parts' log-probabilities."""
        parts = self.log_probs()
        total = jnp.zeros(self.logits.shape[:-1], self.logits.dtype)
        for index, part in enumerate(parts):
            # A one-hot product instead of a gather: its gradient is no scatter.
            chosen = jax.nn.one_hot(action[..., index], part.shape[-1], dtype=part.dtype)
            total = total + self._counted(index, jnp.sum(part * chosen, axis=-1))
        return total

    def entropy(self) -> Float[Array, "*n"]:
        """Return the sum of the parts' entropies [nat]."""
        return -sum(
            (
                self._counted(index, jnp.sum(jnp.exp(part) * part, axis=-1))
                for index, part in enumerate(self.log_probs())
            ),
            start=jnp.zeros(self.logits.shape[:-1], self.logits.dtype),
        )

    def divergence(self, other: "MultiCategorical") -> Float[Array, "*n"]:
        """Return the sum of the parts' divergences [nat]."""
        pairs = zip(self.log_probs(), other.log_probs(), strict=True)
        return sum(
            (
                self._counted(index, jnp.sum(jnp.exp(own) * (own - its), axis=-1))
                for index, (own, its) in enumerate(pairs)
            ),
            start=jnp.zeros(self.logits.shape[:-1], self.logits.dtype),
        )

    def restricted(self, live: Bool[Array, "*n parts"]) -> "MultiCategorical":
        """Return the distribution of the parts that are live; a part is a control."""
        return MultiCategorical(logits=self.logits, sizes=self.sizes, live=live)

    def chances(self, motor_bindings: int) -> Float[Array, "*n parts 3"]:
        """See `Distribution`; choices are off, forward, backward (motors), off, on (thrusters)."""
        rows = []
        for index, part in enumerate(map(jnp.exp, self.log_probs())):
            backward = part[..., 2] if index < motor_bindings else jnp.zeros_like(part[..., 0])
            rows.append(jnp.stack([backward, part[..., 0], part[..., 1]], axis=-1))
        return jnp.stack(rows, axis=-2)

    def log_probs(self) -> list[Float[Array, "*n choices"]]:
        """Return normalised log-probabilities, one array a part."""
        return [jax.nn.log_softmax(part) for part in self._split(self.logits)]

    def _split(self, values: Array) -> list[Array]:
        bounds = itertools.accumulate(self.sizes, initial=0)
        return [values[..., a:b] for a, b in itertools.pairwise(bounds)]

    def _counted(self, index: int, values: Array) -> Array:
        """Return a part's numbers, 0 where it is not live."""
        return values if self.live is None else jnp.where(self.live[..., index], values, 0.0)

    def _argmax(self, scores: Array) -> Array:
        return jnp.stack([jnp.argmax(part, axis=-1) for part in self._split(scores)], axis=-1)


@pytree
class Categorical:
    """One choice of `k`; the action is a single integer."""

    logits: Float[Array, "*n k"]
    """Unnormalised log-probabilities."""
    idle: Bool[Array, "*n k"] | None = None
    """Choices that all do nothing, and count as one; None: every choice differs."""

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Int[Array, "*n"]:
        """Draw one choice."""
        return jax.random.categorical(key, self.logits / temperature)

    def mode(self) -> Int[Array, "*n"]:
        """Return the likeliest choice."""
        return jnp.argmax(self.logits, axis=-1)

    def log_prob(self, action: Int[Array, "*n"]) -> Float[Array, "*n"]:
        """Log-probability of a choice, or of any of those that do the same."""
        chosen = jax.nn.one_hot(action, self.logits.shape[-1], dtype=self.logits.dtype)
        return jnp.sum(self._told_apart() * chosen, axis=-1)

    def entropy(self) -> Float[Array, "*n"]:
        """Return the entropy [nat]."""
        # Choices that do the same share one logarithm: their sum is −p ln p of all together.
        return -jnp.sum(jnp.exp(jax.nn.log_softmax(self.logits)) * self._told_apart(), axis=-1)

    def divergence(self, other: "Categorical") -> Float[Array, "*n"]:
        """See `Distribution`; choices that do the same count as one."""
        alike = Categorical(logits=other.logits, idle=self.idle)
        apart = self._told_apart() - alike._told_apart()
        return jnp.sum(jnp.exp(jax.nn.log_softmax(self.logits)) * apart, axis=-1)

    def restricted(self, live: Bool[Array, "*n u"]) -> "Categorical":
        """Return the distribution in which controls that drive nothing are the no-op."""
        controls, choices = live.shape[-1], self.logits.shape[-1]
        motors = choices - 1 - controls
        acts = jnp.concatenate(
            [
                jnp.repeat(live[..., :motors], 2, axis=-1),
                jnp.zeros_like(live[..., :1]),
                live[..., motors:],
            ],
            axis=-1,
        )
        return Categorical(logits=self.logits, idle=~acts)

    def chances(self, motor_bindings: int) -> Float[Array, "*n u 3"]:
        """See `Distribution`; the marginal probabilities of each control."""
        chance = jax.nn.softmax(self.logits)
        motors = chance[..., : 2 * motor_bindings].reshape(*chance.shape[:-1], motor_bindings, 2)
        burns = chance[..., 2 * motor_bindings + 1 :]
        backward = jnp.concatenate([motors[..., 0], jnp.zeros_like(burns)], axis=-1)
        forward = jnp.concatenate([motors[..., 1], burns], axis=-1)
        return jnp.stack([backward, 1.0 - backward - forward, forward], axis=-1)

    def _told_apart(self) -> Float[Array, "*n k"]:
        """Log-probability of what each choice does."""
        log_probs = jax.nn.log_softmax(self.logits)
        if self.idle is None:
            return log_probs
        nothing = jax.nn.logsumexp(log_probs, axis=-1, keepdims=True, where=self.idle)
        return jnp.where(self.idle, nothing, log_probs)


@pytree
class DiagonalNormal:
    """Independent normal distributions; nothing is squashed, the environment clips."""

    logits: Float[Array, "*n d"]
    """Means, the output of the network."""
    log_std: Float[Array, " d"]
    """Logarithms of the standard deviations; the same in every state."""
    live: Bool[Array, "*n d"] | None = None
    """Entries that count in log-densities and entropies; None: all."""

    def sample(self, key: PRNGKeyArray, temperature: float | Array = 1.0) -> Float[Array, "*n d"]:
        """Draw one vector; the temperature multiplies the deviations."""
        noise = jax.random.normal(key, self.logits.shape, self.logits.dtype)
        return self.logits + noise * jnp.exp(self.log_std) * temperature

    def mode(self) -> Float[Array, "*n d"]:
        """Return the mean."""
        return self.logits

    def log_prob(self, action: Float[Array, "*n d"]) -> Float[Array, "*n"]:
        """Log-density of a vector."""
        distance = (action - self.logits) * jnp.exp(-self.log_std)
        constant = jnp.log(2 * jnp.pi)
        return -0.5 * self._sum(distance**2 + 2 * self.log_std + constant)

    def entropy(self) -> Float[Array, "*n"]:
        """Return the differential entropy [nat]."""
        each = self.log_std + 0.5 * (1 + jnp.log(2 * jnp.pi))
        return self._sum(jnp.broadcast_to(each, self.logits.shape))

    def divergence(self, other: "DiagonalNormal") -> Float[Array, "*n"]:
        """Return the sum of the entries' divergences [nat]."""
        spread = jnp.exp(2 * (self.log_std - other.log_std))
        distance = ((self.logits - other.logits) * jnp.exp(-other.log_std)) ** 2
        each = other.log_std - self.log_std + 0.5 * (spread + distance - 1)
        return self._sum(each)

    def restricted(self, live: Bool[Array, "*n d"]) -> "DiagonalNormal":
        """Return the distribution of the entries that are live; an entry is a control."""
        return DiagonalNormal(logits=self.logits, log_std=self.log_std, live=live)

    def chances(self, motor_bindings: int) -> Float[Array, "*n d 3"]:
        """See `Distribution`: of the signs, as an action is as good as never exactly 0."""
        positive = jax.scipy.stats.norm.cdf(self.logits * jnp.exp(-self.log_std))
        is_motor = jnp.arange(self.logits.shape[-1]) < motor_bindings
        rest = 1.0 - positive
        nothing = jnp.zeros_like(rest)
        return jnp.stack(
            [jnp.where(is_motor, rest, nothing), jnp.where(is_motor, nothing, rest), positive],
            axis=-1,
        )

    def _sum(self, values: Float[Array, "*n d"]) -> Float[Array, "*n"]:
        counted = values if self.live is None else jnp.where(self.live, values, 0.0)
        return jnp.sum(counted, axis=-1)


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

    def of_controls(self, motors: Float[Array, "*n m 3"], jets: Float[Array, "*n t 2"]) -> Array:
        """Arrange the logits of each control in the order of the action space.

        Args:
            motors: Of each motor binding: at rest, forward, backward.
            jets: Of each thruster binding: off, on.
        """
        return jnp.concatenate([_flattened(motors), _flattened(jets)], axis=-1)

    def __call__(self, logits: Array, log_std: Array | None) -> Distribution:
        """Return the distribution of these outputs; `log_std` is ignored."""
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

    def of_controls(self, motors: Float[Array, "*n m 3"], jets: Float[Array, "*n t 2"]) -> Array:
        """Arrange the logits of each control in the order of the action space.

        Args:
            motors: Of each motor binding: at rest, forward, backward.
            jets: Of each thruster binding: off, on.
        """
        # Backward and forward of each motor, nothing at all, each thruster, as the actions count.
        moved = motors[..., 2:0:-1] - motors[..., :1]
        pushed = jets[..., 1:] - jets[..., :1]
        nothing = jnp.zeros((*motors.shape[:-2], 1), motors.dtype)
        return jnp.concatenate([_flattened(moved), nothing, _flattened(pushed)], axis=-1)

    def __call__(self, logits: Array, log_std: Array | None) -> Distribution:
        """Return the distribution of these outputs; `log_std` is ignored."""
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

    def of_controls(self, motors: Float[Array, "*n m 3"], jets: Float[Array, "*n t 2"]) -> Array:
        """Arrange the logits of each control in the order of the action space.

        Args:
            motors: Of each motor binding: at rest, forward, backward.
            jets: Of each thruster binding: off, on.
        """
        moved, pushed = motors[..., 1] - motors[..., 2], jets[..., 1] - jets[..., 0]
        return jnp.concatenate([moved, pushed], axis=-1)

    def __call__(self, logits: Array, log_std: Array | None) -> Distribution:
        """Return the normal distribution with these means.

        Raises:
            ValueError: `log_std` is missing.
        """
        if log_std is None:
            raise ValueError("a continuous head needs the parameter log_std")
        return DiagonalNormal(logits=logits, log_std=log_std)


def _flattened(values: Float[Array, "*n u k"]) -> Float[Array, "*n v"]:
    return values.reshape(*values.shape[:-2], -1)


ActionHead = MultiDiscreteHead | DiscreteHead | ContinuousHead


def action_head(
    action_type: str, *, motor_bindings: int = 4, thruster_bindings: int = 2
) -> ActionHead:
    """Return the head for a type of action.

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
