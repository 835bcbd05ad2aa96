"""Environments with names, for the registries of gymnax and Gymnasium."""

from typing import Any, Final

from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.reset import (
    load_from_json_file,
    make_reset_fn_list_of_levels,
    make_reset_fn_sample_kinetix_level,
    static_env_params_for_levels,
)
from kinetix.errors import KinetixError
from kinetix.level.sizes import SIZES

RANDOM: Final = "-random"
"""`s-random` means random levels of size s."""
FIRST_LEVEL: Final = "s/first_flight"
"""The level of `Kinetix-level-v0` when none is given."""

NAMED: Final[dict[str, str]] = {f"Kinetix-{size}-random-v0": f"{size}-random" for size in "sml"} | {
    "Kinetix-level-v0": FIRST_LEVEL
}
"""Names in registries, and what is played."""


def make_named_env(
    level: str = FIRST_LEVEL,
    action_type: str = "multi_discrete",
    observation_type: str = "symbolic_flat",
    physics: str = "balanced",
    *,
    auto_reset: bool = True,
    dense_reward_scale: float | None = None,
    frame_skip: int | None = None,
) -> KinetixEnv:
    """Make an environment from plain words.

    Args:
        level: A level file, the name of a bundled level (`s/goalkeeper`), or random levels of a
            size (`s-random`, `m-random`, `l-random`).
        action_type: `multi_discrete`, `discrete` or `continuous`.
        observation_type: `symbolic_flat`, `symbolic_flat_padded`, `symbolic_entity`, `pixels` or
            `blind`.
        physics: Physics preset or solver.
        auto_reset: Whether `step` goes on with a new episode where one is done.
        dense_reward_scale: Weight of the distance reward; None: that of `EnvParams`.
        frame_skip: Physics steps per environment step; None: 2, or what the file says.

    Raises:
        KinetixError: A word is none of these; the sentence lists them.
    """
    changes: dict[str, Any] = {} if frame_skip is None else {"frame_skip": frame_skip}
    static: StaticEnvParams
    if level.endswith(RANDOM):
        size = level.removesuffix(RANDOM)
        if size not in SIZES:
            raise KinetixError(
                f"{level!r}: expected one of {', '.join(f'{name}{RANDOM}' for name in SIZES)}"
            )
        static = static_env_params_from_size(size, physics=physics, **changes)
        params = EnvParams()
        reset_fn = make_reset_fn_sample_kinetix_level(params, static)
    else:
        _, static, params = load_from_json_file(level, physics=physics)
        static = static_env_params_for_levels(level, static.replace(**changes))  # pyright: ignore[reportAttributeAccessIssue]
        reset_fn = make_reset_fn_list_of_levels(level, static)
    if dense_reward_scale is not None:
        params = params.replace(dense_reward_scale=dense_reward_scale)  # pyright: ignore[reportAttributeAccessIssue]
    env: Any = make_kinetix_env(
        action_type, observation_type, reset_fn, params, static, auto_reset=auto_reset
    )
    return env
