"""kinetix-env's networks, over ours: the same parameters under the same names."""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Float

from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.config import OBSERVATIONS_OF_KIND, NetworkConfig
from kinetix.agents.networks.distributions import Distribution, MultiCategorical, action_head
from kinetix.agents.networks.recurrent import Carry, initial_carry
from kinetix.environment.env import KinetixEnv
from kinetix.errors import KinetixError
from kinetix.pytree import pytree

_WIDTHS = ("actor_width", "critic_width")
_DEPTHS = ("actor_depth", "critic_depth")


@pytree
class SeededPolicy:
    """A distribution over actions whose draws take a `seed`."""

    distribution: Distribution

    @property
    def logits(self) -> Float[Array, "*n k"]:
        """The network's raw output."""
        return self.distribution.logits

    def sample(
        self, seed: Array, temperature: float | Array = 1.0, sample_shape: Sequence[int] = ()
    ) -> Array:
        """Draw actions.

        Args:
            seed: Random key.
            temperature: Divides the logits.
            sample_shape: Leading axes of independent draws.
        """
        if not sample_shape:
            return self.distribution.sample(seed, temperature)
        keys = jax.random.split(seed, tuple(sample_shape))
        draw = self.distribution.sample
        for _ in sample_shape:
            draw = jax.vmap(draw, in_axes=(0, None))
        return draw(keys, temperature)

    def sample_and_log_prob(self, seed: Array) -> tuple[Array, Array]:
        """Draw actions, with their log-probabilities."""
        action = self.sample(seed)
        return action, self.log_prob(action)

    def mode(self) -> Array:
        """Return the likeliest actions."""
        return self.distribution.mode()

    def log_prob(self, value: Array) -> Array:
        """Return log-probabilities, summed over the parts of an action."""
        return self.distribution.log_prob(value)

    def entropy(self) -> Array:
        """Return entropies [nat], summed over the parts of an action."""
        return self.distribution.entropy()

    def log_prob_disentangled(self, value: Array) -> Float[Array, "*n parts"]:
        """Return the log-probability of every part of an action by itself."""
        parts = self._parts()
        chosen = [
            jnp.take_along_axis(part, value[..., index, None], axis=-1)[..., 0]
            for index, part in enumerate(parts)
        ]
        return jnp.stack(chosen, axis=-1)

    def entropy_disentangled(self) -> Float[Array, "*n parts"]:
        """Return the entropy of every part of an action by itself [nat]."""
        return jnp.stack(
            [-jnp.sum(jnp.exp(part) * part, axis=-1) for part in self._parts()], axis=-1
        )

    @property
    def event_shape(self) -> tuple[int, ...]:
        """The shape of one action."""
        return (len(self._parts()),)

    def _parts(self) -> list[Array]:
        if not isinstance(self.distribution, MultiCategorical):
            raise KinetixError("the action has no parts: expected action_type multi_discrete")
        return self.distribution.log_probs()


def MultiDiscreteActionDistribution(
    logits: Float[Array, "*n k"], number_of_dims_per_distribution: Sequence[int]
) -> SeededPolicy:
    """Return independent categoricals whose logits lie one after the other.

    Args:
        logits: Unnormalised log-probabilities of all parts.
        number_of_dims_per_distribution: Number of choices of each part.
    """
    sizes = tuple(int(size) for size in number_of_dims_per_distribution)
    return SeededPolicy(distribution=MultiCategorical(logits=logits, sizes=sizes))


class GeneralActorCriticRNN:
    """The memory of all networks.

    Here it is no network by itself.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        """Describe the network.

        Raises:
            KinetixError: Always.
        """
        del arguments, options
        raise KinetixError(
            "GeneralActorCriticRNN is a part of whole networks here: make one with "
            "kinetix.models.make_network_from_config, or kinetix.models.actor_critic"
            ".ActorCriticSymbolicRNN"
        )

    @staticmethod
    def initialize_carry(batch_size: int, hidden_size: int = 256) -> Carry:
        """Return the memory at the start of episodes: zeros."""
        return initial_carry(batch_size, hidden_size)


@dataclasses.dataclass(frozen=True)
class SeededNetwork:
    """A network whose policy draws with a `seed`.

    The memory may be the pair that `initialize_carry` returns, or one array of it.
    """

    module: nn.Module

    @staticmethod
    def initialize_carry(batch_size: int, hidden_size: int = 256) -> Carry:
        """Return the memory at the start of episodes: zeros."""
        return initial_carry(batch_size, hidden_size)

    def init(self, rng: Any, hidden: Any, inputs: Any) -> dict[str, Any]:
        """Return fresh parameters for inputs of these shapes."""
        pair, _ = _pair(hidden)
        return dict(jax.jit(self.module.init)(rng, pair, inputs))

    def apply(
        self, params: Mapping[str, Any], hidden: Any, inputs: Any, **options: Any
    ) -> tuple[Any, SeededPolicy, Float[Array, "k n"]]:
        """Return memory, policy and value; inputs have the leading axes time and batch."""
        pair, single = _pair(hidden)
        output: Any = self.module.apply(params, pair, inputs, **options)
        carry, policy, value = output
        return carry[0] if single else carry, SeededPolicy(distribution=policy), value


def _pair(hidden: Any) -> tuple[Carry, bool]:
    if isinstance(hidden, tuple | list):
        return (hidden[0], hidden[1]), False
    return (hidden, jnp.zeros_like(hidden)), True


def make_network_from_config(
    env: KinetixEnv,
    env_params: Any,
    config: Mapping[str, Any],
    network_kws: Mapping[str, Any] | None = None,
) -> SeededNetwork:
    """Return the network of a configuration.

    Args:
        env: Environment with the observation and the actions.
        env_params: Taken for kinetix-env's sake.
        config: Options by the names of `NetworkConfig`; `fc_layer_depth` and `fc_layer_width` set
            those of actor and critic, `permutation_invariant_mlp` picks the network without
            attention.
        network_kws: Options that come before those of the configuration.

    Raises:
        KinetixError: An option is outside its range; the message names it.
    """
    del env_params
    options = {**config, **(network_kws or {})}
    values: dict[str, Any] = {"kind": _kind(env, options)}
    for names, common in ((_DEPTHS, "depth"), (_WIDTHS, "width")):
        shared = options.get(f"override_model_{common}") or options.get(f"fc_layer_{common}")
        values |= {name: int(shared) for name in names if shared}
    fields = dataclasses.fields(NetworkConfig)
    values |= {
        field.name: options[field.name]
        for field in fields
        if field.name != "kind" and options.get(field.name) is not None
    }
    try:
        network = NetworkConfig(**values)
    except ValueError as error:
        raise KinetixError(str(error)) from None
    head = action_head(
        env.action_type.value,
        motor_bindings=env.static_env_params.num_motor_bindings,
        thruster_bindings=env.static_env_params.num_thruster_bindings,
    )
    return SeededNetwork(build_network(network, head))


def _kind(env: KinetixEnv, options: Mapping[str, Any]) -> Any:
    observation = env.observation_type.value
    kinds = [kind for kind, reads in OBSERVATIONS_OF_KIND.items() if observation in reads]
    invariant = "permutation_invariant_mlp"
    return invariant if invariant in kinds and options.get(invariant) else kinds[0]
