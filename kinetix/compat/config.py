"""Configurations of kinetix-env: nested or flat dictionaries, as hydra makes them."""

import datetime
import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any, Final

from kinetix.agents.results import groups_of
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import (
    EnvParams,
    StaticEnvParams,
    static_env_params_from_size,
)
from kinetix.environment.reset import load_from_json_file
from kinetix.environment.spaces import ActionType, ObservationType
from kinetix.errors import KinetixError
from kinetix.level.sizes import SIZES

DEFAULTS: Final[Mapping[str, Any]] = {
    "action_type": "multi_discrete",
    "observation_type": "symbolic_entity",
    "seed": 0,
    "use_wandb": False,
    "train_level_mode": "random",
    "eval_levels": (),
    "recurrent_model": False,
    "activation": "tanh",
}
"""Values of a configuration that are not given."""
_RECORDS: Final = ("env_params", "static_env_params")
_CUSTOM: Final = "custom"


def normalise_config(
    config: Mapping[str, Any], name: str, editor_config: bool = False, save_config: bool = True
) -> dict[str, Any]:
    """Return a configuration as one flat dictionary, with the numbers that follow from it.

    Args:
        config: Sections of options, or the options themselves; it is not modified.
        name: What the run is called in records.
        editor_config: Taken for kinetix-env's sake.
        save_config: Taken for kinetix-env's sake; nothing is written.

    Returns:
        The options in lower case, kinds of action and observation as enumerations,
        `env_params`, `static_env_params`, `num_updates` and `minibatch_size` where their parts are
        given.

    Raises:
        KinetixError: A kind or a size is unknown.
    """
    del editor_config, save_config
    flat = dict(DEFAULTS) | _flat(config)
    flat.setdefault("run_name", name)
    flat["action_type"] = ActionType.from_string(flat["action_type"])
    flat["observation_type"] = ObservationType.from_string(flat["observation_type"])
    if not set(_RECORDS) <= flat.keys():
        params, static = generate_params_from_config(flat)
        for key, record in zip(_RECORDS, (params, static), strict=True):
            flat[key] = {name: getattr(record, name) for name in _fields(type(record))}
    steps, envs = flat.get("num_steps"), flat.get("num_train_envs")
    if steps and envs:
        if flat.get("total_timesteps"):
            flat["num_updates"] = int(flat["total_timesteps"]) // (int(steps) * int(envs))
        if flat.get("num_minibatches"):
            flat["minibatch_size"] = int(envs) * int(steps) // int(flat["num_minibatches"])
    return flat


def generate_params_from_config(config: Mapping[str, Any]) -> tuple[EnvParams, StaticEnvParams]:
    """Return the two records of parameters that a configuration describes.

    Args:
        config: Fields of either record by their names, in the dictionaries `env_params` and
            `static_env_params` or beside them; `env_size_name` (`s`, `m`, `l`) where capacities are
            not given; `env_size_type: custom` with `custom_path`, a level whose parameters are
            taken.

    Raises:
        KinetixError: The size is unknown.
    """
    flat = _flat(config)
    params, static = EnvParams(), StaticEnvParams()
    size = flat.get("env_size_name", flat.get("size"))
    if flat.get("env_size_type") == _CUSTOM and flat.get("custom_path"):
        _, static, params = load_from_json_file(flat["custom_path"])
    elif isinstance(size, str) and "num_polygons" not in flat and size != _CUSTOM:
        if size not in SIZES:
            raise KinetixError(f"env_size_name={size!r}: expected one of {', '.join(SIZES)}")
        static = static_env_params_from_size(size)
    return _changed(params, flat, "env_params"), _changed(static, flat, "static_env_params")


def ued_params_from_config(config: Mapping[str, Any]) -> UEDParams:
    """Return the options of random levels that a configuration names."""
    flat = _flat(config)
    return UEDParams(**{name: flat[name] for name in _fields(UEDParams) if name in flat})


def get_eval_level_groups(eval_levels: Sequence[str]) -> list[tuple[str, Any]]:
    """Return the groups of some levels, as (name of the group, names of its levels).

    Args:
        eval_levels: Names such as `s/first_flight`; the groups are those of an evaluation.
    """
    groups: dict[str, list[str]] = {}
    for level in map(str, eval_levels):
        for group in groups_of(level):
            groups.setdefault(group, []).append(level)
    return list(groups.items())


def get_video_frequency(config: Mapping[str, Any], update_step: int) -> int:
    """Return after how many updates the next film is due (`video_frequency`, else every 64)."""
    del update_step
    return int(config.get("video_frequency", 64))


def get_hash_without_seed(config: Mapping[str, Any]) -> str:
    """Return a fingerprint of a configuration that runs with different seeds share."""
    rest = {key: str(value) for key, value in config.items() if key != "seed"}
    return hashlib.md5(json.dumps(rest, sort_keys=True).encode()).hexdigest()


def get_date() -> str:
    """Return today's date, `2026-11-22`."""
    return datetime.date.today().isoformat()


def get_tags(config: Mapping[str, Any], name: str) -> list[str]:
    """Return the words by which a run is found again."""
    words = (name, config.get("env_size_name"), config.get("train_level_mode"))
    return [str(word) for word in words if word]


def _flat(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of all sections side by side; the two records stay dictionaries."""
    flat: dict[str, Any] = {}
    for key, value in config.items():
        name = str(key).lower()
        if isinstance(value, Mapping) and name not in _RECORDS:
            flat |= _flat(value)
        else:
            flat[name] = value
    return flat


def _fields(record: Any) -> list[str]:
    return list(record.__dataclass_fields__)


def _changed(record: Any, flat: Mapping[str, Any], block: str) -> Any:
    """Return the record with the values of its block and of the options beside it."""
    given = dict(flat.get(block) or {})
    names = [name for name in _fields(type(record)) if name != "features"]
    changes = {name: given[name] for name in names if name in given}
    changes |= {name: flat[name] for name in names if flat.get(name) is not None}
    screen = changes.get("screen_dim")
    if screen is not None:
        pair = screen.values() if isinstance(screen, Mapping) else screen
        changes["screen_dim"] = tuple(int(side) for side in pair)
    return record.replace(**changes)
