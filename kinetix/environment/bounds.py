"""Bounds of the numbers in `EnvParams` and `StaticEnvParams`."""

import math
import numbers
from collections.abc import Callable
from typing import Any, Final

import jax
import numpy as np
from jax.core import Tracer

from kinetix.bounds import Bound, check_bounds
from kinetix.engine.spec import ARENA_BODIES


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


def as_number(value: Any) -> Any:
    """Return Python's number for an array of one, of numpy or JAX; anything else as it is.

    Args:
        value: What a caller passed for a number.
    """
    known = isinstance(value, np.ndarray | jax.Array) and not isinstance(value, Tracer)
    return value.item() if known and value.ndim == 0 else value


def check_numbers(env_params: Any) -> None:
    """Refuse an `EnvParams` with a number that no episode can be played with.

    Raises:
        KinetixError: The sentence names the field.
    """
    check_bounds(env_params, _NUMBERS, "env_params.")


def check_sizes(static_env_params: Any) -> None:
    """Refuse a `StaticEnvParams` with a size that cannot be.

    Raises:
        KinetixError: The sentence names the field.
    """
    check_bounds(static_env_params, _SIZES, "static_env_params.")
