"""Functions of kinetix-env 0.x and 1.x that projects still call."""

from collections.abc import Mapping, Sequence
from typing import Any

from kinetix.compat.config import ued_params_from_config
from kinetix.compat.saving import load_evaluation_levels
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.reset import (
    ResetFunction,
    make_reset_fn_list_of_levels,
    make_reset_fn_sample_kinetix_level,
)
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError


class Environments:
    """The classes of `gymnax.environments.environment`, which old code finds beside the env."""

    Environment = KinetixEnv
    EnvParams = EnvParams
    EnvState = EnvState


_OBSERVATIONS = {
    "symbolic": "symbolic_flat",
    "symbolicpadded": "symbolic_flat_padded",
    "entity": "symbolic_entity",
    "pixels": "pixels",
    "blind": "blind",
}
_ACTIONS = {
    "discrete": "discrete",
    "continuous": "continuous",
    "multidiscrete": "multi_discrete",
}


def make_kinetix_env_from_name(
    name: str,
    env_params: EnvParams | None = None,
    static_env_params: StaticEnvParams | None = None,
) -> Any:
    """Make an environment from a name such as `Kinetix-Symbolic-Continuous-v1`.

    Raises:
        KinetixError: The name is none of these; the message lists its parts.
    """
    parts = name.lower().split("-")
    if len(parts) != 4 or parts[1] not in _OBSERVATIONS or parts[2] not in _ACTIONS:
        raise KinetixError(
            f"{name!r}: expected Kinetix-OBSERVATION-ACTION-v1, with Symbolic, SymbolicPadded, "
            "Entity, Pixels or Blind, and Discrete, Continuous or MultiDiscrete"
        )
    return make_kinetix_env_from_args(parts[1], parts[2], "replay", static_env_params, env_params)


def make_kinetix_env_from_args(
    obs_type: str,
    action_type: str,
    reset_type: str = "replay",
    static_env_params: StaticEnvParams | None = None,
    env_params: EnvParams | None = None,
) -> Any:
    """Make an environment whose episodes end and stay ended, from the names of its parts."""
    del reset_type
    return make_kinetix_env(
        _ACTIONS.get(action_type.lower().replace("_", ""), action_type),
        _OBSERVATIONS.get(obs_type.lower(), obs_type),
        None,
        env_params,
        static_env_params,
        auto_reset=False,
    )


def make_reset_train_function_with_mutations(
    engine: Any,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    config: Mapping[str, Any] | None = None,
    make_pcg_state: bool = False,
) -> ResetFunction:
    """Return a reset function that draws a random level."""
    del engine, make_pcg_state
    return make_reset_fn_sample_kinetix_level(
        env_params, static_env_params, ued_params_from_config(config or {})
    )


def make_reset_train_function_with_list_of_levels(
    config: Mapping[str, Any],
    levels: Sequence[str],
    static_env_params: StaticEnvParams,
    make_pcg_state: bool = False,
    is_loading_train_levels: bool = False,
) -> ResetFunction:
    """Return a reset function that picks one of some levels."""
    del config, make_pcg_state, is_loading_train_levels
    return make_reset_fn_list_of_levels(levels, static_env_params)


def generate_ued_params_from_config(config: Mapping[str, Any]) -> UEDParams:
    """Return the options of random levels that a configuration names."""
    return ued_params_from_config(config)


def get_eval_levels(eval_levels: Sequence[str], static_env_params: StaticEnvParams) -> EnvState:
    """Return levels as one state with a leading axis."""
    return load_evaluation_levels(eval_levels, static_env_params)[0]
