"""The façade's two flat records of parameters, and how they split into what the engine takes."""

import dataclasses
from typing import Any, Final, Literal

from jax.core import Tracer

from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.presets import solver_named
from kinetix.engine.solvers import AbstractSolver, PgsBaumgarte
from kinetix.engine.spec import ARENA_BODIES, Capacity, Features, SceneSpec
from kinetix.engine.types import Parameters
from kinetix.environment.bounds import as_number, check_sizes, plain_numbers
from kinetix.errors import KinetixError
from kinetix.level.sizes import describe_capacity, parse_capacity
from kinetix.pytree import hashable, pytree, short_repr, static

LEVEL_FRAME_SKIP: Final = 2
"""Physics steps per environment step in every named size and in native levels."""

Parity = Literal["kinetix-3"]
"""The one value of `parity`: everything as kinetix-env 3.0.2 computes it."""


@pytree
class EnvParams:
    """Numbers that may change without recompiling; hashable by value, a pytree under jit."""

    dt: float = 1 / 60
    """Physics step [s]."""
    slop: float = 0.01
    """Overlap that the `jax2d` preset leaves alone [m]."""
    baumgarte_coefficient_joints_v: float = 2.0
    """Joint error fed into the velocity, `jax2d` preset [1/s]."""
    baumgarte_coefficient_joints_p: float = 0.7
    """Share of the joint error moved directly, `jax2d` preset."""
    baumgarte_coefficient_fjoint_av: float = 2.0
    """Angle error of a weld fed into the angular velocity, `jax2d` preset [1/s]."""
    baumgarte_coefficient_rjoint_limit_av: float = 5.0
    """Limit violation fed into the angular velocity, `jax2d` preset [1/s]."""
    baumgarte_coefficient_collision: float = 0.2
    """Share of the overlap that the `jax2d` preset resolves in a step."""
    joint_stiffness: float = 0.6
    """Relaxation of the joint impulses, `jax2d` preset."""
    clip_position: float = 15
    """Bound of each coordinate after a physics step [m]."""
    clip_velocity: float = 100
    """Bound of each velocity component [m/s]."""
    clip_angular_velocity: float = 50
    """Bound of the angular velocity [rad/s]."""
    base_motor_speed: float = 6.0
    """[rad/s] per unit of motor speed."""
    base_motor_power: float = 900.0
    """[rad/s²] per unit of motor power."""
    base_thruster_power: float = 10.0
    """[N] per unit of thruster power."""
    motor_decay_coefficient: float = 0.1
    """k in the motor's tanh(k·speed error) [s/rad]."""
    motor_joint_limit: float = 0.1
    """Band before a limit in which a motor fades out [rad]."""
    base_friction: float = 0.4
    """A pair of bodies has the coefficient base_friction·sqrt(f_a² + f_b²)."""
    max_timesteps: int = 256
    """Environment steps per episode of random levels; those from files and builders have their own,
    as long as this is finite. `jnp.inf`: no episode is cut."""
    pixels_per_unit: int = 100
    """Pixels per metre of the full-size picture."""
    dense_reward_scale: float = 0.1
    """Weight of the distance reward; 0 switches it off."""
    num_shape_roles: int = 4
    """None, green, blue, red."""

    __repr__ = short_repr

    @property
    def max_steps_in_episode(self) -> int:
        """The time limit, by gymnax's name `max_timesteps`."""
        return self.max_timesteps


def as_numbers(env_params: EnvParams) -> EnvParams:
    """The same parameters with Python's numbers where there are arrays of one: they can be hashed.

    Args:
        env_params: Of an environment that is about to be made.

    Raises:
        KinetixError: A parameter is traced.
    """
    changes: dict[str, Any] = {}
    for field in dataclasses.fields(env_params):
        value = getattr(env_params, field.name)
        if isinstance(value, Tracer):
            raise KinetixError(
                f"env_params.{field.name}: expected a number, got a traced value: make the "
                "environment with usual parameters and give these to reset and step"
            )
        changes[field.name] = as_number(value)
    return dataclasses.replace(env_params, **changes)


@pytree
class StaticEnvParams:
    """Sizes and choices: a new value means a new compilation. Hashable, never traced."""

    num_polygons: int = static(default=12)
    """Polygons, the four arena bodies included."""
    num_circles: int = static(default=12)
    """Slots for circles."""
    num_joints: int = static(default=12)
    """Slots for joints."""
    num_thrusters: int = static(default=12)
    """Slots for thrusters."""
    max_polygon_vertices: int = static(default=4)
    """Corners of a polygon: 4."""
    num_solver_iterations: int = static(default=10)
    """Sweeps of the `jax2d` preset."""
    solver_batch_size: int = static(default=16)
    """Contacts that the `jax2d` preset solves at once."""
    do_warm_starting: bool = static(default=True)
    """True if the `jax2d` preset starts from the impulses of the last step."""
    num_static_fixated_polys: int = static(default=ARENA_BODIES)
    """Arena bodies."""
    screen_dim: tuple[int, int] = static(default=(500, 500))
    """Size of the full-size picture [px]."""
    downscale: int = static(default=4)
    """Pixel observations are `screen_dim // downscale`."""
    frame_skip: int = static(default=1)
    """Physics steps per environment step."""
    max_shape_size: float = static(default=2)
    """Largest extent of a shape of the random levels [m]."""
    num_motor_bindings: int = static(default=4)
    """Action channels of motors."""
    num_thruster_bindings: int = static(default=2)
    """Action channels of thrusters."""
    physics: str | AbstractSolver = static(default=DEFAULT_PHYSICS)
    """Physics preset, or a solver's name at its default settings."""
    touch_includes_joined: bool = static(default=True)
    """True if two bodies of one jointed component that overlap count as touching."""
    features: Features = static(default=Features())
    """Features that the levels use; fewer than all specialise the compiled step."""

    __repr__ = short_repr

    def __post_init__(self) -> None:
        """Keep a list or an array of sides as a tuple, and an array of one as its number.

        So both can be hashed.

        Raises:
            KinetixError: There is no such physics.
        """
        plain_numbers(self)
        solver_named(self.physics)
        object.__setattr__(self, "screen_dim", hashable(self.screen_dim))

    @property
    def capacity(self) -> Capacity:
        """The four capacities."""
        return Capacity(
            polygons=self.num_polygons,
            circles=self.num_circles,
            joints=self.num_joints,
            thrusters=self.num_thrusters,
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class PhysicsEngine:
    """Sizes and solver of an environment's physics: hashable, made from `StaticEnvParams` alone."""

    spec: SceneSpec
    solver: AbstractSolver

    def __repr__(self) -> str:
        """Name the size and the solver."""
        size = describe_capacity(self.spec.capacity)
        return f"<PhysicsEngine: size {size}, {type(self.solver).__name__}>"


def engine_parameters(env_params: EnvParams) -> Parameters:
    """Return the engine's share of `EnvParams`, under the engine's names."""
    values: dict[str, Any] = {
        "dt": env_params.dt,
        "base_friction": env_params.base_friction,
        "base_motor_speed": env_params.base_motor_speed,
        "base_motor_power": env_params.base_motor_power,
        "base_thruster_power": env_params.base_thruster_power,
        "motor_decay_coefficient": env_params.motor_decay_coefficient,
        "motor_joint_limit": env_params.motor_joint_limit,
        "clip_position": env_params.clip_position,
        "clip_velocity": env_params.clip_velocity,
        "clip_angular_velocity": env_params.clip_angular_velocity,
        "slop": env_params.slop,
        "baumgarte_collision": env_params.baumgarte_coefficient_collision,
        "baumgarte_joint_velocity": env_params.baumgarte_coefficient_joints_v,
        "baumgarte_joint_position": env_params.baumgarte_coefficient_joints_p,
        "baumgarte_fixed_joint": env_params.baumgarte_coefficient_fjoint_av,
        "baumgarte_limit": env_params.baumgarte_coefficient_rjoint_limit_av,
        "joint_stiffness": env_params.joint_stiffness,
    }
    return Parameters(**values)


def physics_engine(static_env_params: StaticEnvParams) -> PhysicsEngine:
    """Sizes, features and solver that `StaticEnvParams` names.

    Raises:
        KinetixError: For a size that cannot be, or a preset that does not exist.
    """
    check_sizes(static_env_params)
    solver = solver_named(static_env_params.physics)
    if isinstance(solver, PgsBaumgarte):
        solver = dataclasses.replace(
            solver,
            iterations=static_env_params.num_solver_iterations,
            batch_size=static_env_params.solver_batch_size,
            warm_start=static_env_params.do_warm_starting,
        )
    return PhysicsEngine(
        spec=SceneSpec(capacity=static_env_params.capacity, features=static_env_params.features),
        solver=solver,
    )


def static_env_params_of(capacity: Capacity, **changes: Any) -> StaticEnvParams:
    """Static parameters for a capacity, with the frame skip of levels."""
    values: dict[str, Any] = {
        "num_polygons": capacity.polygons,
        "num_circles": capacity.circles,
        "num_joints": capacity.joints,
        "num_thrusters": capacity.thrusters,
        "frame_skip": LEVEL_FRAME_SKIP,
    }
    return StaticEnvParams(**(values | changes))


def static_env_params_from_size(size: str, return_dict: bool = False, **changes: Any) -> Any:
    """Static parameters of a named size (`s`, `m`, `l`, `locomotion`) or of four capacities.

    Args:
        size: A name, or polygons with the arena, circles, joints, thrusters: `12,4,6,2`.
        return_dict: Whether the fields are returned as a dictionary, for configurations.
        **changes: Other fields of `StaticEnvParams`.

    Returns:
        `StaticEnvParams`, or its fields.

    Raises:
        LevelError: When the size is neither.
    """
    made = static_env_params_of(parse_capacity(size), **changes)
    if not return_dict:
        return made
    return {field.name: getattr(made, field.name) for field in dataclasses.fields(made)}


def with_parity(static_env_params: StaticEnvParams, parity: Parity | None) -> StaticEnvParams:
    """Return the same sizes under the physics of kinetix-env when parity is asked for.

    Raises:
        KinetixError: For any other value than `"kinetix-3"` and None.
    """
    if parity is None:
        return static_env_params
    if parity != "kinetix-3":
        raise KinetixError(f"parity={parity!r}: expected 'kinetix-3' or None")
    return dataclasses.replace(static_env_params, physics="jax2d", touch_includes_joined=True)
