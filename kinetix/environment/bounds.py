"""Bounds of the numbers in `EnvParams`, `StaticEnvParams` and `UEDParams`."""

import math
import numbers
from collections.abc import Callable
from typing import Any, Final, get_args

import jax
import numpy as np
from jax.core import Tracer

from kinetix.bounds import Bound, check_bounds
from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.model import InertiaModel


def _whole(least: int) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, numbers.Integral) and int(value) >= least


_NUMBERS: Final = (
    Bound(("dt",), "seconds above 0 and up to 1, such as 1/60", lambda x: 0 < x <= 1),
    Bound(
        ("max_timesteps",),
        "a whole number of steps from 1, or jnp.inf for no time limit",
        lambda x: x >= 1 and (math.isinf(x) or x == int(x)),
    ),
    Bound(("clip_position", "clip_velocity", "clip_angular_velocity"), "above 0", lambda x: x > 0),
    Bound(("base_friction",), "0 or more", lambda x: x >= 0),
    Bound(("pixels_per_unit",), "a number from 1", lambda x: x >= 1),
    Bound(
        (
            "slop",
            "baumgarte_coefficient_joints_v",
            "baumgarte_coefficient_joints_p",
            "baumgarte_coefficient_fjoint_av",
            "baumgarte_coefficient_rjoint_limit_av",
            "baumgarte_coefficient_collision",
            "joint_stiffness",
            "base_motor_speed",
            "base_motor_power",
            "base_thruster_power",
            "motor_decay_coefficient",
            "motor_joint_limit",
            "dense_reward_scale",
        ),
        "a finite number",
        math.isfinite,
    ),
)

_SIZES: Final = (
    Bound(
        ("num_polygons",),
        f"a whole number from {ARENA_BODIES}, which the arena takes",
        _whole(ARENA_BODIES),
    ),
    Bound(
        (
            *("num_circles", "num_joints", "num_thrusters"),
            *("num_motor_bindings", "num_thruster_bindings"),
        ),
        "a whole number from 0",
        _whole(0),
    ),
    Bound(
        ("frame_skip", "downscale", "num_solver_iterations", "solver_batch_size"),
        "a whole number from 1",
        _whole(1),
    ),
    Bound(
        ("screen_dim",),
        "width and height in pixels, such as (500, 500)",
        lambda sides: len(sides) == 2 and all(map(_whole(1), sides)),
    ),
    Bound(("max_shape_size",), "metres above 0", lambda x: 0 < x < math.inf),
    Bound(("num_static_fixated_polys",), f"{ARENA_BODIES}, the arena", lambda x: x == 4),
    Bound(("max_polygon_vertices",), "4", lambda x: x == 4),
)

_OPTIONS: Final = (
    Bound(
        (
            "max_shape_size",
            "goal_body_size_factor",
            "large_rect_dim_scale",
            "circle_max_size_coeff",
        ),
        "a finite number above 0",
        lambda x: 0 < x < math.inf,
    ),
    Bound(
        (
            "goal_body_opposide_side_chance",
            "large_rect_dim_chance",
            "thruster_align_com_prob",
            "motor_on_chance",
            "joint_limit_chance",
            "joint_fixed_chance",
            "fixate_chance_min",
            "fixate_chance_max",
            "fixate_shape_bottom_bias",
            "fixate_shape_bottom_bias_special_role",
            "add_thruster_chance",
        ),
        "a probability from 0 to 1",
        lambda x: 0 <= x <= 1,
    ),
    Bound(
        (
            *("add_shape_chance", "add_connected_shape_chance", "add_no_shape_chance"),
            *("floor_prob_normal", "floor_prob_green", "floor_prob_blue", "floor_prob_red"),
            *("connect_to_fixated_prob_coeff", "joint_limit_max"),
        ),
        "a finite number from 0",
        lambda x: 0 <= x < math.inf,
    ),
    Bound(
        (
            *("motor_min_speed", "motor_max_speed", "motor_min_power", "motor_max_power"),
            *("wheel_max_power", "thruster_power_multiplier", "fixate_chance_scale"),
            *("connect_visibility_min", "connect_no_visibility_bias", "min_rjoints_bias"),
        ),
        "a finite number",
        math.isfinite,
    ),
    Bound(("add_shape_n_proposals",), "a whole number from 1", _whole(1)),
    Bound(
        ("inertia_model",),
        " or ".join(map(repr, get_args(InertiaModel))),
        lambda word: word in get_args(InertiaModel),
    ),
)


def as_number(value: Any) -> Any:
    """Return Python's number for an array of one, of numpy or JAX; anything else as it is.

    Args:
        value: What a caller passed for a number.
    """
    known = isinstance(value, np.ndarray | jax.Array) and not isinstance(value, Tracer)
    return value.item() if known and value.ndim == 0 else value


def plain_numbers(record: Any) -> None:
    """Keep Python's numbers where a frozen record was given arrays of one.

    Args:
        record: A dataclass that is being made.
    """
    for name, value in vars(record).items():
        object.__setattr__(record, name, as_number(value))


def check_numbers(env_params: Any) -> None:
    """Refuse an `EnvParams` with a number that no episode can be played with.

    Raises:
        KinetixError: The sentence names the field.
    """
    check_bounds(env_params, _NUMBERS, "env_params.")


def check_options(ued_params: Any) -> None:
    """Refuse a `UEDParams` with a number that no level can be drawn by.

    Raises:
        KinetixError: The sentence names the field.
    """
    check_bounds(ued_params, _OPTIONS, "ued_params.")


def check_sizes(static_env_params: Any) -> None:
    """Refuse a `StaticEnvParams` with a size that cannot be.

    Raises:
        KinetixError: The sentence names the field.
    """
    check_bounds(static_env_params, _SIZES, "static_env_params.")
