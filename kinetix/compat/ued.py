"""kinetix-env's functions of level distributions, over our reset functions and samplers."""

from collections.abc import Callable, Mapping
from typing import Any, Final

from jaxtyping import Array

from kinetix.compat.config import ued_params_from_config
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.generators.edits import accel_edit
from kinetix.environment.generators.filters import (
    FILTER_STEPS,
    SAMPLE_RATIO,
    sample_filtered_levels,
)
from kinetix.environment.generators.locomotion import LocomotionParams, locomotion_sampler
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.generators.starts import accel_start_sampler
from kinetix.environment.params import EnvParams, StaticEnvParams, physics_engine
from kinetix.environment.rearrange import expand_state
from kinetix.environment.reset import (
    ResetFunction,
    make_reset_fn_empty,
    make_reset_fn_list_of_levels,
    make_reset_fn_locomotion,
    make_reset_fn_sample_kinetix_level,
    make_reset_fn_sample_sizes,
)
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError

LevelSampler = Callable[[Array, int], Any]
"""Draws a number of levels."""
_LOCOMOTION: Final = {
    "dimension_sampling_range_ratio_exclude": "dim_exclude",
    "dimension_sampling_range_ratio": "dim_sampling_ratio",
    "dimension_default": "dim_default",
    "absolute_range_exclude": "exclude",
    "absolute_range": "range",
}
"""Parts of kinetix-env's names of the options of walkers, and ours."""


def make_reset_fn_from_config(
    config: Mapping[str, Any],
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    physics_engine: Any = None,
    ued_params: UEDParams | None = None,
) -> ResetFunction:
    """Return the reset function that `train_level_mode` names.

    Args:
        config: `train_level_mode` is `random`, `random_all`, `list` (of `train_levels_list`),
            `locomotion` or `empty`.
        env_params: Parameters.
        static_env_params: Sizes and physics.
        physics_engine: Taken for kinetix-env's sake.
        ued_params: Options of random levels; None: those that the configuration names.

    Raises:
        KinetixError: The mode is none of these, or a level does not fit.
    """
    del physics_engine
    ued = ued_params or ued_params_from_config(config)
    mode = config.get("train_level_mode", config.get("level_mode", "random"))
    match mode:
        case "random":
            return make_reset_fn_sample_kinetix_level(env_params, static_env_params, ued)
        case "random_all":
            return make_reset_fn_sample_sizes(static_env_params, ued)
        case "list":
            return make_reset_fn_list_of_levels(config["train_levels_list"], static_env_params)
        case "locomotion":
            return make_reset_fn_locomotion(static_env_params)
        case "empty":
            return make_reset_fn_empty(static_env_params)
    raise KinetixError(
        f"train_level_mode={mode!r}: expected random, random_all, list, locomotion or empty"
    )


def make_reset_fn_sample_empty_level(
    env_params: EnvParams, static_env_params: StaticEnvParams
) -> ResetFunction:
    """Return a reset function that always gives the level with nothing but the arena."""
    del env_params
    return make_reset_fn_empty(static_env_params)


def make_reset_fn_sample_kinetix_level_different_static_env_params(
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    different_static_env_params: StaticEnvParams,
    ued_params: UEDParams | None = None,
) -> ResetFunction:
    """Return a reset function that draws random levels of one size and puts them in larger slots.

    Args:
        env_params: Parameters.
        static_env_params: The slots.
        different_static_env_params: The size that levels are drawn for.
        ued_params: Options of random levels.
    """
    draw = make_reset_fn_sample_kinetix_level(env_params, different_static_env_params, ued_params)
    return lambda key: expand_state(draw(key), static_env_params)


def make_vmapped_filtered_level_sampler(
    level_sampler: Callable[[Array], EnvState],
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    config: Mapping[str, Any],
    env: KinetixEnv,
    ued_params: UEDParams | None = None,
    return_rngs: bool = False,
) -> LevelSampler:
    """Return a function that draws levels; (nearly) none is won by doing nothing.

    Args:
        level_sampler: Draws one level from a key.
        env_params: Parameters.
        static_env_params: Taken for kinetix-env's sake.
        config: `filter_levels`, `level_filter_n_steps`, `level_filter_sample_ratio`.
        env: Plays the levels.
        ued_params: Taken for kinetix-env's sake.
        return_rngs: Not to be had: the levels themselves are returned.
    """
    del static_env_params, ued_params
    if return_rngs:
        raise KinetixError("return_rngs=True: expected False; keep the levels instead of the keys")
    steps = int(config.get("level_filter_n_steps", FILTER_STEPS))
    ratio = int(config.get("level_filter_sample_ratio", SAMPLE_RATIO))
    steps = steps if config.get("filter_levels", True) else 0

    def sample(rng: Array, n_samples: int) -> EnvState:
        return sample_filtered_levels(
            rng, n_samples, level_sampler, env, env_params, steps=steps, ratio=ratio
        )

    return sample


def create_vmapped_filtered_distribution(  # noqa: PLR0913 (kinetix-env's signature)
    rng: Array,
    level_sampler: Callable[[Array], EnvState],
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued_params: UEDParams,
    n_samples: int,
    env: KinetixEnv,
    do_filter_levels: bool,
    level_filter_sample_ratio: int,
    env_size_name: str,
    level_filter_n_steps: int,
) -> EnvState:
    """Draw levels; (nearly) none is won by doing nothing."""
    del env_size_name
    config = {
        "filter_levels": do_filter_levels,
        "level_filter_n_steps": level_filter_n_steps,
        "level_filter_sample_ratio": level_filter_sample_ratio,
    }
    sample = make_vmapped_filtered_level_sampler(
        level_sampler, env_params, static_env_params, config, env, ued_params
    )
    return sample(rng, n_samples)


def make_mutate_env(
    static_env_params: StaticEnvParams, env_params: EnvParams, ued_params: UEDParams
) -> Callable[..., EnvState]:
    """Return a function `(rng, level, n=1)` that makes `n` random mutations in a row."""
    del static_env_params, env_params
    return lambda rng, level, n=1: accel_edit(rng, level, n, ued_params)


def create_random_starting_distribution(
    rng: Array,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued_params: UEDParams | None,
    env_size_name: str,
    controllable: bool = True,
) -> EnvState:
    """Draw one of the simple levels that ACCEL starts from.

    Args:
        rng: Random key.
        env_params: Taken for kinetix-env's sake.
        static_env_params: Sizes and physics.
        ued_params: Options.
        env_size_name: Taken for kinetix-env's sake.
        controllable: Every such level has a motor or a thruster; there are no others.
    """
    del env_params, env_size_name
    if not controllable:
        raise KinetixError("controllable=False: expected True; such levels cannot be won")
    return accel_start_sampler(physics_engine(static_env_params), ued_params)(rng)


def sample_locomotion_level(
    rng: Array,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    ued_params: UEDParams | None = None,
    **options: Any,
) -> EnvState:
    """Draw a walker with a goal to reach.

    Args:
        rng: Random key.
        env_params: Taken for kinetix-env's sake.
        static_env_params: Sizes and physics.
        ued_params: For the floor's role.
        **options: Fields of `LocomotionParams`, also by kinetix-env's names, such as
            `body_dimension_default`.
    """
    del env_params
    locomotion = _locomotion(options)
    return locomotion_sampler(physics_engine(static_env_params), locomotion, ued_params)(rng)


def make_reset_fn_custom_distribution(
    fn_name: str,
    env_params: EnvParams,
    static_env_params: StaticEnvParams,
    fn_kwargs: Mapping[str, Any] | None = None,
) -> ResetFunction:
    """Return the reset function of a distribution with a name.

    Raises:
        KinetixError: The name is not `locomotion`.
    """
    del env_params
    if "locomotion" not in fn_name:
        raise KinetixError(f"fn_name={fn_name!r}: expected 'locomotion'")
    return make_reset_fn_locomotion(static_env_params, _locomotion(fn_kwargs or {}))


def make_env(
    config: Mapping[str, Any],
    static_env_params: StaticEnvParams,
    env_params: EnvParams,
    reset_fn: ResetFunction | None = None,
) -> Any:
    """Return the environment of a configuration (`action_type`, `observation_type`)."""
    return make_kinetix_env(
        config["action_type"],
        config["observation_type"],
        reset_fn or make_reset_fn_from_config(config, env_params, static_env_params),
        env_params,
        static_env_params,
    )


def _locomotion(options: Mapping[str, Any]) -> LocomotionParams:
    for theirs, ours in _LOCOMOTION.items():
        options = {name.replace(theirs, ours): value for name, value in options.items()}
    known = LocomotionParams.__dataclass_fields__  # pyright: ignore[reportAttributeAccessIssue]
    unknown = sorted(set(options) - set(known))
    if unknown:
        raise KinetixError(f"{unknown[0]}: expected one of {', '.join(known)}")
    return LocomotionParams(**options)
