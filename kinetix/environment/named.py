"""Environments with names, for the registries of gymnax and Gymnasium."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.params import (
    EnvParams,
    static_env_params_from_size,
    static_env_params_of,
)
from kinetix.environment.reset import (
    load_from_json_file,
    make_reset_fn_list_of_levels,
    make_reset_fn_sample_kinetix_level,
    static_env_params_for_levels,
)
from kinetix.errors import KinetixError
from kinetix.level.model import Level
from kinetix.level.sets import (
    LoadedSet,
    SetLevel,
    common_capacity,
    gather_levels,
    is_set_file,
    place_of,
)
from kinetix.level.sizes import SIZES

Levels = str | Path | Level | LoadedSet | Iterable[str | Path | Level | SetLevel]
"""Levels of an environment: names, files, folders, sets, or documents."""

RANDOM: Final = "-random"
"""`s-random` means random levels of size s."""
FIRST_LEVEL: Final = "s/first_flight"
"""The level of `Kinetix-level-v0` when none is given."""

NAMED: Final[dict[str, str]] = {f"Kinetix-{size}-random-v0": f"{size}-random" for size in "sml"} | {
    "Kinetix-level-v0": FIRST_LEVEL
}
"""Names in registries, and what is played."""


def make_named_env(
    level: Levels = FIRST_LEVEL,
    action_type: str = "multi_discrete",
    observation_type: str = "symbolic_flat",
    physics: str = DEFAULT_PHYSICS,
    *,
    auto_reset: bool = True,
    dense_reward_scale: float | None = None,
    frame_skip: int | None = None,
) -> KinetixEnv:
    """Make an environment from plain words.

    Args:
        level: A level, its file, or the name of a bundled one (`s/goalkeeper`); random levels of a
            size (`s-random`, `m-random`, `l-random`); or several levels, of which each episode
            draws one: a folder, a level set, or a list of levels, files and folders.
        action_type: `multi_discrete`, `discrete` or `continuous`.
        observation_type: `symbolic_flat`, `symbolic_flat_padded`, `symbolic_entity`, `pixels` or
            `blind`.
        physics: Physics preset or solver.
        auto_reset: Whether `step` goes on with a new episode where one is done.
        dense_reward_scale: Weight of the distance reward; None: that of `EnvParams`.
        frame_skip: Physics steps per environment step; None: 2, or that of the file.

    Raises:
        KinetixError: A word is none of these; the message lists them.
    """
    changes: dict[str, Any] = {} if frame_skip is None else {"frame_skip": frame_skip}
    if isinstance(level, str) and level.endswith(RANDOM):
        size = level.removesuffix(RANDOM)
        if size not in SIZES:
            raise KinetixError(
                f"{level!r}: expected one of {', '.join(f'{name}{RANDOM}' for name in SIZES)}"
            )
        static = static_env_params_from_size(size, physics=physics, **changes)
        params = EnvParams()
        reset_fn = make_reset_fn_sample_kinetix_level(params, static)
    else:
        several: Any = one_by_one(level)
        if isinstance(several, str | Path):
            _, static, params = load_from_json_file(several, physics=physics)
            static = static.replace(**changes)  # pyright: ignore[reportAttributeAccessIssue]
        else:
            longest = max(each.level.max_timesteps for each in several)
            params = EnvParams(max_timesteps=longest)
            capacity = common_capacity(each.level for each in several)
            static = static_env_params_of(capacity, physics=physics, **changes)
        static = static_env_params_for_levels(several, static)
        reset_fn = make_reset_fn_list_of_levels(several, static)
    if dense_reward_scale is not None:
        params = params.replace(dense_reward_scale=dense_reward_scale)  # pyright: ignore[reportAttributeAccessIssue]
    env: Any = make_kinetix_env(
        action_type, observation_type, reset_fn, params, static, auto_reset=auto_reset
    )
    return env


def one_by_one(level: Levels) -> str | Path | list[SetLevel]:
    """The levels of an environment, where it has several or is given documents.

    Args:
        level: As for `make_named_env`, which also takes what this returns.

    Returns:
        The levels; a single name or file, and the word for random levels, as they are.

    Raises:
        KinetixError: There is none, or something else among them.
    """
    is_name = isinstance(level, str | Path)
    if is_name and (str(level).endswith(RANDOM) or not _has_several(level)):
        return level
    return _all_of(level)


def level_names(levels: str | Path | list[SetLevel]) -> tuple[str, ...]:
    """The names of an environment's levels, in the order of their places; of random ones none.

    Args:
        levels: From `one_by_one`.
    """
    if isinstance(levels, str | Path):
        return () if str(levels).endswith(RANDOM) else (str(levels),)
    return tuple(each.name for each in levels)


def _has_several(name: str | Path) -> bool:
    """Return whether this is a folder or a level set, not a level."""
    place = place_of(name)
    return os.path.isdir(place) or is_set_file(place)


def _all_of(levels: Levels) -> list[SetLevel]:
    """Return the levels, one by one.

    Raises:
        KinetixError: `levels` is empty, or has something that is not a level.
    """
    if isinstance(levels, LoadedSet):
        return list(levels.levels)
    given = [levels] if isinstance(levels, str | Path | Level) else levels
    if not isinstance(given, Iterable):
        raise _no_level(given)
    found: list[SetLevel] = []
    for each in given:
        if isinstance(each, SetLevel):
            found.append(each)
        elif isinstance(each, Level):
            found.append(SetLevel(name=each.name, level=each))
        elif isinstance(each, str | Path):
            found += gather_levels([each])
        else:
            raise _no_level(each)
    if not found:
        raise KinetixError("level is empty: expected at least one level")
    return found


def _no_level(given: Any) -> KinetixError:
    return KinetixError(
        f"level: expected levels, files, folders or level sets, got {type(given).__name__}"
    )
