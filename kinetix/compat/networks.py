"""kinetix-env's network classes by their own names, over ours."""

import dataclasses
from collections.abc import Sequence
from typing import Any, Final

from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.config import Kind, NetworkConfig
from kinetix.agents.networks.distributions import (
    ActionHead,
    ContinuousHead,
    DiscreteHead,
    MultiDiscreteHead,
)
from kinetix.compat.models import SeededNetwork
from kinetix.errors import KinetixError

_RENAMED: Final = {"recurrent": "recurrent_model"}
_SHARED: Final = {
    "fc_layer_depth": ("actor_depth", "critic_depth"),
    "fc_layer_width": ("actor_width", "critic_width"),
}
"""Names of versions before 2.0, for two options at once."""
_WITHOUT_EFFECT: Final = ("include_actions_and_rewards", "permutation_invariant", "name", "parent")
_NOT_HERE: Final = ("add_generator_embedding", "preprocess_separately")
"""Options that change the network in kinetix-env and have no counterpart: they must be off."""
_FIELDS: Final = frozenset(field.name for field in dataclasses.fields(NetworkConfig)) - {"kind"}


def ActorCriticTransformer(action_dim: int, **options: Any) -> SeededNetwork:
    """Return the network that attends over entities; see `_network`."""
    return _network("entity_transformer", action_dim, options)


def ActorCriticSymbolicRNN(action_dim: int, **options: Any) -> SeededNetwork:
    """Return the network over a flat observation; see `_network`."""
    return _network("flat_mlp", action_dim, options)


def ActorCriticPixelsRNN(action_dim: int, **options: Any) -> SeededNetwork:
    """Return the network over pixels; see `_network`."""
    return _network("cnn", action_dim, options)


def ActorCriticPermutationInvariantSymbolicRNN(action_dim: int, **options: Any) -> SeededNetwork:
    """Return the network without attention over entities; see `_network`."""
    return _network("permutation_invariant_mlp", action_dim, options)


def _network(kind: Kind, action_dim: int, options: dict[str, Any]) -> SeededNetwork:
    """Return the network of a kind.

    Args:
        kind: One of ours.
        action_dim: Choices of a discrete action, or reals of a continuous one.
        options: Those of `NetworkConfig`, with `action_mode` and
            `multi_discrete_number_of_dims_per_distribution`; also by the names of older versions.

    Raises:
        KinetixError: An option is unknown, outside its range, or has no counterpart here.
    """
    options = {name: value for name, value in options.items() if name not in _WITHOUT_EFFECT}
    mode = str(options.pop("action_mode", options.pop("action_type", "multi_discrete")))
    choices = options.pop("multi_discrete_number_of_dims_per_distribution", None)
    options.pop("hybrid_action_continuous_dim", None)
    options.pop("generator_embedding_number_of_timesteps", None)
    for name in _NOT_HERE:
        if options.pop(name, False):
            raise KinetixError(f"{name}: expected False; this network has no such part")
    values: dict[str, Any] = {}
    for name, value in options.items():
        ours = _SHARED.get(name, (_RENAMED.get(name, name),))
        if not _FIELDS.issuperset(ours):
            raise KinetixError(f"{name}: no such option; there are {', '.join(sorted(_FIELDS))}")
        values |= dict.fromkeys(ours, value)
    try:
        config = NetworkConfig(kind=kind, **values)
    except ValueError as error:
        raise KinetixError(str(error)) from None
    return SeededNetwork(build_network(config, _head(mode, action_dim, choices)))


def _head(mode: str, action_dim: int, choices: Sequence[int] | None) -> ActionHead:
    match mode:
        case "discrete":
            return DiscreteHead(choices=action_dim)
        case "continuous":
            return ContinuousHead(size=action_dim)
        case "multi_discrete" if choices:
            return MultiDiscreteHead(sizes=tuple(int(choice) for choice in choices))
        case "multi_discrete":
            raise KinetixError(
                "multi_discrete_number_of_dims_per_distribution: expected the number of choices "
                "of each part of an action, such as [3, 3, 3, 3, 2, 2]"
            )
    raise KinetixError(
        f"action_mode: expected discrete, continuous or multi_discrete, got {mode!r}"
    )
