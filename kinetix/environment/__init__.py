"""The environment: what an agent plays. Names are imported on first use."""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.environment.env import make_kinetix_env
    from kinetix.environment.generators.params import UEDParams
    from kinetix.environment.generators.sample import sample_kinetix_level
    from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
    from kinetix.environment.rearrange import permute_state
    from kinetix.environment.reset import (
        make_reset_fn_list_of_levels,
        make_reset_fn_sample_kinetix_level,
    )
    from kinetix.environment.spaces import ActionType, ObservationType
    from kinetix.environment.state import EnvState
    from kinetix.environment.wrappers import LogWrapper

_HOME = {
    "ActionType": "kinetix.environment.spaces",
    "EnvParams": "kinetix.environment.params",
    "EnvState": "kinetix.environment.state",
    "LogWrapper": "kinetix.environment.wrappers",
    "ObservationType": "kinetix.environment.spaces",
    "StaticEnvParams": "kinetix.environment.params",
    "UEDParams": "kinetix.environment.generators.params",
    "make_kinetix_env": "kinetix.environment.env",
    "make_reset_fn_list_of_levels": "kinetix.environment.reset",
    "make_reset_fn_sample_kinetix_level": "kinetix.environment.reset",
    "permute_state": "kinetix.environment.rearrange",
    "sample_kinetix_level": "kinetix.environment.generators.sample",
    "static_env_params_from_size": "kinetix.environment.params",
}

__all__ = [
    "ActionType",
    "EnvParams",
    "EnvState",
    "LogWrapper",
    "ObservationType",
    "StaticEnvParams",
    "UEDParams",
    "make_kinetix_env",
    "make_reset_fn_list_of_levels",
    "make_reset_fn_sample_kinetix_level",
    "permute_state",
    "sample_kinetix_level",
    "static_env_params_from_size",
]


__getattr__, __dir__ = lazy_names(
    __name__,
    _HOME,
    (
        *("actions", "decompile", "devices", "dummy", "env", "generators", "gymnax", "inverse"),
        *("jaxued", "named", "observations", "params", "rearrange", "replay", "reset", "runs"),
        *("spaces", "state", "stoa", "vector", "wrappers"),
    ),
)
