"""kinetix-env's symbolic renderers, which are the observations here, and their inverses."""

from collections.abc import Callable
from typing import Any

from jaxtyping import Array, Float

from kinetix.environment.inverse import state_from_entities, state_from_flat
from kinetix.environment.observations import (
    EntityObservation,
    EntityObservations,
    FlatObservations,
    FlatPaddedObservations,
    Layout,
)
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError


def make_render_entities(
    env_params: EnvParams, static_params: StaticEnvParams, ignore_attention_mask: bool = False
) -> Callable[[EnvState], EntityObservation]:
    """Return the function from a state to its entity observation."""
    layout = Layout.of(env_params, static_params)
    return EntityObservations(layout=layout, attention=not ignore_attention_mask)


def make_render_symbolic(
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    padded: bool = False,
    clip: bool = True,
) -> Callable[[EnvState], Float[Array, "..."]]:
    """Return the function from a state to its flat observation.

    Args:
        env_params: Parameters.
        static_env_params: Sizes.
        padded: Whether the rows are kept as a matrix.
        clip: Whether values are clipped to ±10; there is no other form.

    Raises:
        KinetixError: `clip` is false.
    """
    if not clip:
        raise KinetixError("clip=False: expected True; the entity observation is not clipped")
    layout = Layout.of(env_params, static_env_params)
    return FlatPaddedObservations(layout=layout) if padded else FlatObservations(layout=layout)


def make_inverse_render_entity(
    env_state: EnvState, env_params: EnvParams, static_env_params: StaticEnvParams
) -> Callable[[Any], EnvState]:
    """Return the function from an entity observation back to a state."""
    del env_state
    return lambda observation: state_from_entities(observation, env_params, static_env_params)


def make_inverse_render_symbolic(
    env_state: EnvState, env_params: EnvParams, static_env_params: StaticEnvParams
) -> Callable[[Any], EnvState]:
    """Return the function from a flat observation back to a state."""
    del env_state
    return lambda observation: state_from_flat(observation, env_params, static_env_params)
