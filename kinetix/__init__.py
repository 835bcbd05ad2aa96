"""Kinetix: design, play and train on 2D rigid-body physics levels.

Every public name is imported on first use, so that `import kinetix` stays fast and free of JAX.
"""

from typing import TYPE_CHECKING

from kinetix.compat.finder import install as install_names_of_kinetix_env
from kinetix.compiler import ask_for_options
from kinetix.forks import watch_forks
from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.agents.agent import load_agent, save_agent
    from kinetix.cores import use_all_cores
    from kinetix.environment.decompile import level_of
    from kinetix.environment.env import make_kinetix_env
    from kinetix.environment.generators.params import UEDParams
    from kinetix.environment.generators.sample import sample_kinetix_level
    from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
    from kinetix.environment.rearrange import permute_state
    from kinetix.environment.reset import (
        load_from_json_file,
        make_reset_fn_list_of_levels,
        make_reset_fn_sample_kinetix_level,
    )
    from kinetix.environment.simulation import simulate
    from kinetix.environment.spaces import ActionType, ObservationType
    from kinetix.environment.state import EnvState
    from kinetix.environment.vector import VectorEnv, vectorize
    from kinetix.environment.wrappers import LogWrapper
    from kinetix.errors import CheckpointError, KinetixError, LevelError
    from kinetix.level.builder import LevelBuilder
    from kinetix.level.codec import load_level, save_level
    from kinetix.level.model import Level
    from kinetix.pages.show import show
    from kinetix.render.film_files import save_film
    from kinetix.render.pixels import make_render_pixels
    from kinetix.version import __version__

_HOME = {
    "ActionType": "kinetix.environment.spaces",
    "CheckpointError": "kinetix.errors",
    "EnvParams": "kinetix.environment.params",
    "EnvState": "kinetix.environment.state",
    "KinetixError": "kinetix.errors",
    "Level": "kinetix.level.model",
    "LevelBuilder": "kinetix.level.builder",
    "LevelError": "kinetix.errors",
    "LogWrapper": "kinetix.environment.wrappers",
    "ObservationType": "kinetix.environment.spaces",
    "StaticEnvParams": "kinetix.environment.params",
    "UEDParams": "kinetix.environment.generators.params",
    "VectorEnv": "kinetix.environment.vector",
    "level_of": "kinetix.environment.decompile",
    "load_agent": "kinetix.agents.agent",
    "load_from_json_file": "kinetix.environment.reset",
    "load_level": "kinetix.level.codec",
    "make_kinetix_env": "kinetix.environment.env",
    "make_render_pixels": "kinetix.render.pixels",
    "make_reset_fn_list_of_levels": "kinetix.environment.reset",
    "make_reset_fn_sample_kinetix_level": "kinetix.environment.reset",
    "permute_state": "kinetix.environment.rearrange",
    "sample_kinetix_level": "kinetix.environment.generators.sample",
    "save_agent": "kinetix.agents.agent",
    "save_film": "kinetix.render.film_files",
    "save_level": "kinetix.level.codec",
    "show": "kinetix.pages.show",
    "simulate": "kinetix.environment.simulation",
    "static_env_params_from_size": "kinetix.environment.params",
    "__version__": "kinetix.version",
    "use_all_cores": "kinetix.cores",
    "vectorize": "kinetix.environment.vector",
}

__all__ = [
    "ActionType",
    "CheckpointError",
    "EnvParams",
    "EnvState",
    "KinetixError",
    "Level",
    "LevelBuilder",
    "LevelError",
    "LogWrapper",
    "ObservationType",
    "StaticEnvParams",
    "UEDParams",
    "VectorEnv",
    "__version__",
    "level_of",
    "load_agent",
    "load_from_json_file",
    "load_level",
    "make_kinetix_env",
    "make_render_pixels",
    "make_reset_fn_list_of_levels",
    "make_reset_fn_sample_kinetix_level",
    "permute_state",
    "sample_kinetix_level",
    "save_agent",
    "save_film",
    "save_level",
    "show",
    "simulate",
    "static_env_params_from_size",
    "use_all_cores",
    "vectorize",
]

ask_for_options()
watch_forks()
install_names_of_kinetix_env()

__getattr__, __dir__ = lazy_names(
    __name__,
    _HOME,
    ("agents", "engine", "environment", "gymnasium", "level", "render", "scenes", "training"),
)
