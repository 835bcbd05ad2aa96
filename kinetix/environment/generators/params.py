"""The options of random levels: kinetix-env's names and defaults, and three switches of ours."""

import math
from typing import Any

from kinetix.environment.arguments import kind_of
from kinetix.environment.bounds import check_options, plain_numbers
from kinetix.environment.checks import check_params, check_static_params
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.params import physics_engine as engine_of
from kinetix.errors import KinetixError
from kinetix.level.model import InertiaModel
from kinetix.pytree import pytree, short_repr, static


@pytree
class UEDParams:
    """Options of random levels (UED: unsupervised environment design).

    Hashable and never traced (all structure, no leaves): another value, another compilation. The
    names, the misspelt one included, are kinetix-env's, so that configurations carry over. Lengths
    are metres, powers and speeds multiples of the base values of `EnvParams`.

    Source: kinetix-env 3.0.2, defaults as published.
    """

    max_shape_size: float = static(default=1.0)
    """Bound M of a shape's size [m]: rectangle diagonals reach M/√2 before the long-side factor."""
    goal_body_opposide_side_chance: float = static(default=0.5)
    """Probability that green keeps to the left half, and blue to the right half."""
    goal_body_size_factor: float = static(default=1.0)
    """Factor on M for free green and blue bodies."""
    min_rjoints_bias: int = static(default=2)
    """As long as a level has fewer revolute joints than this, joints are revolute."""
    large_rect_dim_chance: float = static(default=0.3)
    """Probability that one side of a rectangle is multiplied by `large_rect_dim_scale`."""
    large_rect_dim_scale: float = static(default=2.0)
    """Factor on that side."""
    generate_triangles: bool = static(default=False)
    """True if half of the polygons are triangles."""
    thruster_power_multiplier: float = static(default=2.0)
    """Factor on a thruster's power, which is drawn from 0.5 … 2."""
    thruster_align_com_prob: float = static(default=0.8)
    """Probability that a thruster points along the line through the centre of mass."""
    motor_on_chance: float = static(default=0.8)
    """Probability that a revolute joint has a running motor."""
    motor_min_speed: float = static(default=0.4)
    """Least motor speed."""
    motor_max_speed: float = static(default=3.0)
    """Greatest motor speed."""
    motor_min_power: float = static(default=1.0)
    """Least motor power."""
    motor_max_power: float = static(default=3.0)
    """Greatest motor power."""
    wheel_max_power: float = static(default=1.0)
    """Greatest motor power where a circle takes part."""
    joint_limit_chance: float = static(default=0.4)
    """Probability that a revolute joint between two polygons has limits."""
    joint_limit_max: float = static(default=math.pi)
    """Limits are drawn from −this … 0 and 0 … this [rad]."""
    joint_fixed_chance: float = static(default=0.1)
    """Share of welds. kinetix-env never uses it (quirk Q1: one half)."""
    fixate_chance_min: float = static(default=0.02)
    """Least probability that a free shape is fixed."""
    fixate_chance_max: float = static(default=1.0)
    """Greatest probability that a free shape is fixed."""
    fixate_chance_scale: float = static(default=4.0)
    """A free shape is fixed with probability min(max, min + scale·mass)."""
    fixate_shape_bottom_bias: float = static(default=0.0)
    """Probability that a fixed shape without a role moves from the upper half to the lower."""
    fixate_shape_bottom_bias_special_role: float = static(default=0.6)
    """Probability that a fixed shape with a role moves from the upper half to the lower."""
    circle_max_size_coeff: float = static(default=0.8)
    """Greatest diameter of a circle, as a share of M."""
    connect_to_fixated_prob_coeff: float = static(default=0.05)
    """Weight of a fixed body as a partner of a joint."""
    connect_visibility_min: float = static(default=0.05)
    """Least reach of each of two jointed bodies beyond the other [m]."""
    connect_no_visibility_bias: float = static(default=10.0)
    """Contacts that a proposal with a hidden body counts for."""
    add_shape_chance: float = static(default=0.35)
    """Weight of a free shape as the next one that is added."""
    add_connected_shape_chance: float = static(default=0.35)
    """Weight of a shape that is joined to another."""
    add_no_shape_chance: float = static(default=0.3)
    """Weight of adding none."""
    add_thruster_chance: float = static(default=0.3)
    """Probability of each thruster."""
    add_shape_n_proposals: int = static(default=8)
    """Proposals for a shape, of which the one with the fewest contacts is taken; 1 at size s."""
    floor_prob_normal: float = static(default=0.9)
    """Weight of a floor without a role."""
    floor_prob_green: float = static(default=0.0)
    """Weight of a green floor."""
    floor_prob_blue: float = static(default=0.02)
    """Weight of a blue floor."""
    floor_prob_red: float = static(default=0.08)
    """Weight of a red floor."""
    kinetix_quirks: bool = static(default=True)
    """True: kinetix-env's distribution with its quirks Q1–Q12; False: all of them off together."""
    inertia_model: InertiaModel = static(default="kinetix")
    """Moment of inertia of generated bodies: kinetix-env's (disc m·r²/4) or the true one."""
    legacy_ceiling: bool = static(default=False)
    """True if the ceiling has kinetix-env's slanted outer edge (first corner at x = 5)."""

    __repr__ = short_repr

    def __post_init__(self) -> None:
        """Keep Python's number of an array of one, which can be hashed."""
        plain_numbers(self)

    @property
    def floor_probabilities(self) -> tuple[float, float, float, float]:
        """Weights of the floor's role: none, green, blue, red."""
        return (
            self.floor_prob_normal,
            self.floor_prob_green,
            self.floor_prob_blue,
            self.floor_prob_red,
        )


def checked_options(ued_params: Any) -> UEDParams:
    """Return the options; None means the usual ones.

    Args:
        ued_params: The argument.

    Raises:
        KinetixError: The value has another type, or a number that no level can be generated with.
    """
    if ued_params is None:
        return UEDParams()
    if not isinstance(ued_params, UEDParams):
        raise KinetixError(f"ued_params: expected UEDParams(…), got {type(ued_params).__name__}")
    check_options(ued_params)
    return ued_params


def checked_drawing(
    physics_engine: Any, env_params: Any, static_env_params: Any, ued_params: Any, order: str
) -> tuple[PhysicsEngine, UEDParams]:
    """Return the engine and the options of what draws random levels.

    Args:
        physics_engine: The argument; None: that of `static_env_params`, which may be None else.
        env_params: The argument.
        static_env_params: The argument.
        ued_params: The argument; None: the usual ones.
        order: Right order of the arguments, for the sentence.

    Raises:
        KinetixError: An argument has another type, or a number out of range.
    """
    check_params(env_params, order)
    if physics_engine is None:
        check_static_params(static_env_params, order)
        physics_engine = engine_of(static_env_params)
    elif static_env_params is not None:
        check_static_params(static_env_params, order)
    if not isinstance(physics_engine, PhysicsEngine):
        kind = kind_of(physics_engine)
        raise KinetixError(f"physics_engine: expected env.physics_engine, got {kind}; {order}")
    return physics_engine, checked_options(ued_params)
