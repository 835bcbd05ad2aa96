"""Checks of what an agent is asked with: observations of its kind, as many as its carry."""

from collections.abc import Mapping
from typing import Any, Final

import jax.numpy as jnp

from kinetix.agents.card import AgentCard
from kinetix.agents.from_card import observations_of_card, static_env_params_of_card
from kinetix.environment.params import EnvParams
from kinetix.environment.spaces import Dict
from kinetix.errors import KinetixError

_EXACT: Final = ("symbolic_flat", "pixels")
"""Observations whose every size is the agent's; entities may be of any number."""


def parts_of_observation(card: AgentCard) -> dict[str, Any]:
    """Return the spaces of the arrays that an agent's observation has, by name; "" for a lone one.

    Args:
        card: The agent's description.
    """
    space: Any = observations_of_card(card, EnvParams(), static_env_params_of_card(card)).space
    return dict(space.spaces) if isinstance(space, Dict) else {"": space}


def check_observations(
    card: AgentCard, parts: Mapping[str, Any], observations: Any, batch: int
) -> None:
    """Refuse observations of another kind or size, no batch of them, or not as many as the carry.

    Args:
        card: The agent's description.
        parts: From `parts_of_observation`.
        observations: With a leading axis of environments.
        batch: Environments of the carry.

    Raises:
        KinetixError: The observations are not as expected; one sentence.
    """
    kind = card.observation.type
    told = f"obs: agent {card.name!r} sees {kind}"
    for name, part in parts.items():
        value: Any = getattr(observations, name, None) if name else observations
        if not hasattr(value, "shape"):
            made = type(observations).__name__ + (f" without {name!r}" if name else "")
            raise KinetixError(f"{told}, got {made}; an environment of that kind makes it")
        have, want = jnp.shape(value), part.shape
        where = f"obs.{name}" if name else "obs"
        if len(have) == len(want):
            raise KinetixError(
                f"{where} of shape {have}: expected a leading axis of environments; one "
                "observation gets it by jax.tree.map(lambda x: x[None], obs)"
            )
        sizes = have[1:] if kind in _EXACT else have[-1:]
        wanted = want if kind in _EXACT else want[-1:]
        rows = len(want) > 1 and jnp.issubdtype(part.dtype, jnp.floating)
        if len(have) != len(want) + 1 or ((kind in _EXACT or rows) and sizes != wanted):
            raise KinetixError(f"{told} of shape {want}, got {have[1:]} ({where})")
        if have[0] != batch:
            raise KinetixError(
                f"{where} of shape {have}: expected {batch} environments, as the carry has; "
                f"agent.init_carry({have[0]}) makes one for these"
            )
