"""From a symbolic observation back to a state, to draw logged or predicted observations."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.engine.types import Bodies, Joints, Thrusters, World
from kinetix.environment.kinetix_env.rewrite import collision_matrix
from kinetix.environment.observations import EntityObservation, Feature, Layout
from kinetix.environment.observations.flat import BOUND
from kinetix.environment.observations.rows import (
    ANGULAR_VELOCITY_SCALE,
    GRAVITY_SCALE,
    body_rows,
)
from kinetix.environment.params import EnvParams, StaticEnvParams, physics_engine
from kinetix.environment.state import EnvState, state_of
from kinetix.errors import KinetixError
from kinetix.level.compile import Labels, compile_level
from kinetix.level.model import Level
from kinetix.render.pixels import make_render_pixels


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Table:
    """Rows of an observation, with their columns by name."""

    rows: Float[Array, "e f"]
    features: tuple[Feature, ...]

    def column(self, name: str) -> Float[Array, " e"]:
        """Return one column."""
        names = [feature.name for feature in self.features]
        return self.rows[:, names.index(name)]

    def vector(self, name: str) -> Float[Array, "e 2"]:
        """Return two columns that are coordinates."""
        return jnp.stack([self.column(f"{name}_x"), self.column(f"{name}_y")], axis=1)

    def flag(self, name: str) -> Bool[Array, " e"]:
        """Return a column of zeros and ones as truth values."""
        return self.column(name) > 0.5

    def angle(self, name: str) -> Float[Array, " e"]:
        """Return the angle of a sine and a cosine, −π … π [rad]."""
        return jnp.arctan2(self.column(f"sin_{name}"), self.column(f"cos_{name}"))

    def choice(self, prefix: str) -> Int[Array, " e"]:
        """Return which of the one-hot columns with a common prefix is largest."""
        chosen = [i for i, f in enumerate(self.features) if f.name.startswith(prefix)]
        return jnp.argmax(self.rows[:, chosen[0] : chosen[-1] + 1], axis=1).astype(jnp.int32)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Parsed:
    """An observation in either form, as tables by kind."""

    polygons: _Table
    circles: _Table
    joints: _Table
    """Seen from body b."""
    thrusters: _Table
    active: Bool[Array, " b"]
    joint_active: Bool[Array, " j"]
    body_a: Int[Array, " j"]
    body_b: Int[Array, " j"]
    thruster_body: Int[Array, " t"]
    gravity_y: Float[Array, ""]


def state_from_entities(
    observation: EntityObservation, env_params: EnvParams, static_env_params: StaticEnvParams
) -> EnvState:
    """Return the state that an entity observation shows; what it does not show has its usual value.

    Rotations come out between 0 and 2π, limits between −π and π; contacts are forgotten, no motor
    is automatic, gravity is vertical.

    Args:
        observation: As `EntityObservations` makes it, without a batch axis.
        env_params: Parameters.
        static_env_params: Sizes and physics.
    """
    layout = Layout.of(env_params, static_env_params)
    joints = layout.capacity.joints
    index = jnp.asarray(observation.joint_indexes)[:joints].astype(jnp.int32)
    active = [observation.polygon_mask, observation.circle_mask]
    parsed = _Parsed(
        polygons=_table(observation.polygons, (*layout.polygon, layout.gravity)),
        circles=_table(observation.circles, (*layout.circle, layout.gravity)),
        joints=_table(observation.joints, layout.joint, count=joints),
        thrusters=_table(observation.thrusters, layout.thruster),
        active=jnp.concatenate([jnp.asarray(part) > 0 for part in active]),
        joint_active=jnp.asarray(observation.joint_mask)[:joints] > 0,
        body_a=index[:, 1],
        body_b=index[:, 0],
        thruster_body=jnp.asarray(observation.thruster_indexes).astype(jnp.int32),
        gravity_y=jnp.asarray(observation.polygons)[0, -1].astype(jnp.float32) * GRAVITY_SCALE,
    )
    return _state(parsed, layout)


def state_from_flat(
    observation: Float[Array, " f"], env_params: EnvParams, static_env_params: StaticEnvParams
) -> EnvState:
    """Return the state that a flat observation shows.

    As for `state_from_entities`; besides, walls and ceiling are the standard ones, and inverse
    masses and inertias that were clipped are recomputed from shape and density, as Kinetix does.

    Args:
        observation: As `FlatObservations` makes it, without a batch axis.
        env_params: Parameters.
        static_env_params: Sizes and physics.
    """
    layout = Layout.of(env_params, static_env_params)
    size, values = layout.capacity, jnp.asarray(observation, jnp.float32)
    tables, start = [], 0
    for count, features in (
        (len(layout.flat_polygons), layout.polygon),
        (size.circles, layout.circle),
        (size.joints, layout.flat_joint),
        (size.thrusters, layout.flat_thruster),
    ):
        stop = start + count * len(features)
        tables.append(_table(values[start:stop].reshape(count, len(features)), features))
        start = stop
    listed, circles, joints, thrusters = tables
    polygons = _with_arena(listed, layout)
    shown = [_shows_body(table) for table in (polygons, circles)]
    parsed = _Parsed(
        polygons=polygons,
        circles=circles,
        joints=joints,
        thrusters=thrusters,
        active=jnp.concatenate(shown),
        joint_active=joints.flag("active"),
        body_a=_body(joints, "to", size),
        body_b=_body(joints, "from", size),
        thruster_body=_body(thrusters, "body", size),
        gravity_y=values[-1] * GRAVITY_SCALE,
    )
    state = _state(parsed, layout)
    return _with_masses(state)


def make_inverse_render_symbolic(
    env_params: EnvParams, static_env_params: StaticEnvParams
) -> Callable[[Any], Float[Array, "w h 3"]]:
    """Return a function that draws symbolic observations.

    Args:
        env_params: Parameters, with the size of the picture.
        static_env_params: Sizes.

    Returns:
        From an entity observation or a flat one to the picture of `make_render_pixels`.
    """
    render = make_render_pixels(env_params, static_env_params)
    width = len(Layout.of(env_params, static_env_params).flat)

    def draw(observation: Any) -> Float[Array, "w h 3"]:
        if hasattr(observation, "joint_indexes"):
            return render(state_from_entities(observation, env_params, static_env_params))
        if jnp.shape(observation) != (width,):
            raise KinetixError(
                f"observation of shape {jnp.shape(observation)}: expected an entity observation "
                f"or a flat one of shape ({width},)"
            )
        return render(state_from_flat(observation, env_params, static_env_params))

    return draw


def _table(rows: Any, features: tuple[Feature, ...], *, count: int | None = None) -> _Table:
    return _Table(rows=jnp.asarray(rows, jnp.float32)[:count], features=features)


def _body(table: _Table, name: str, size: Capacity) -> Int[Array, " e"]:
    """Return the body in the one-hot columns `name_polygon_0` … `name_circle_…`."""
    first = [f.name for f in table.features].index(f"{name}_polygon_0")
    return jnp.argmax(table.rows[:, first : first + size.bodies], axis=1).astype(jnp.int32)


def _shows_body(table: _Table) -> Bool[Array, " e"]:
    """Rows of inactive bodies are zero; others have a direction."""
    return jnp.hypot(table.column("sin_rotation"), table.column("cos_rotation")) > 0.5


def _with_arena(listed: _Table, layout: Layout) -> _Table:
    """Return the polygons with walls and ceiling, which the flat form leaves out."""
    walls, _ = body_rows(_empty(layout), layout)
    rows = jnp.concatenate([listed.rows[:1], walls[1:ARENA_BODIES], listed.rows[1:]])
    return _Table(rows=rows, features=listed.features)


def _empty(layout: Layout) -> EnvState:
    engine = physics_engine(layout.static_env_params)
    level = Level(name="empty", max_timesteps=layout.max_timesteps)
    return state_of(compile_level(level, spec=engine.spec, solver=engine.solver))


def _state(parsed: _Parsed, layout: Layout) -> EnvState:
    size, empty = layout.capacity, _empty(layout)
    both = (parsed.polygons, parsed.circles)

    def bodies(read: Callable[[_Table], Array]) -> Array:
        return jnp.concatenate([read(table) for table in both])

    is_arena = jnp.arange(size.bodies) < ARENA_BODIES
    count = jnp.where(parsed.polygons.flag("is_triangle"), 3, 4).astype(jnp.int32)
    corners = [parsed.polygons.vector(f"vertex_{corner}") for corner in range(4)]
    used = jnp.arange(4)[None, :] < count[:, None]
    speed = bodies(lambda table: table.column("angular_velocity"))
    thrusters, joints = parsed.thrusters, _joints(parsed)
    return EnvState(
        world=World(
            bodies=Bodies(
                inverse_mass=bodies(lambda table: table.column("inverse_mass")),
                inverse_inertia=bodies(lambda table: table.column("inverse_inertia")),
                friction=bodies(lambda table: table.column("friction")),
                restitution=bodies(lambda table: table.column("restitution")),
                collision_mode=jnp.where(is_arena, 2, 1).astype(jnp.int32),
                active=parsed.active,
                vertices=jnp.where(used[:, :, None], jnp.stack(corners, axis=1), 0.0),
                vertex_count=count,
                radius=parsed.circles.column("radius"),
            ),
            joints=joints,
            thrusters=Thrusters(
                body=parsed.thruster_body,
                position=thrusters.vector("position"),
                angle=thrusters.angle("angle"),
                power=thrusters.column("power"),
                active=thrusters.flag("active"),
            ),
            gravity=jnp.stack([jnp.zeros(()), parsed.gravity_y]),
            collides=collision_matrix(joints, size.bodies),
        ),
        physics=dataclasses.replace(
            empty.physics,
            position=bodies(lambda table: table.vector("position")),
            rotation=bodies(lambda table: table.angle("rotation")) % (2 * math.pi),
            velocity=bodies(lambda table: table.vector("velocity")),
            angular_velocity=ANGULAR_VELOCITY_SCALE * jnp.arctanh(speed),
        ),
        labels=Labels(
            role=bodies(lambda table: table.choice("role_")),
            density=bodies(lambda table: table.column("density")),
            motor_binding=parsed.joints.choice("motor_binding_"),
            motor_auto=jnp.zeros(size.joints, bool),
            thruster_binding=thrusters.choice("thruster_binding_"),
            max_timesteps=empty.labels.max_timesteps,
        ),
        timestep=empty.timestep,
        last_distance=empty.last_distance,
    )


def _joints(parsed: _Parsed) -> Joints:
    table = parsed.joints
    return Joints(
        body_a=parsed.body_a,
        body_b=parsed.body_b,
        anchor_a=table.vector("to_anchor"),
        anchor_b=table.vector("from_anchor"),
        active=parsed.joint_active,
        fixed=table.flag("is_weld"),
        reference_angle=table.angle("reference_angle"),
        motor_on=table.flag("motor_on"),
        motor_speed=table.column("motor_speed"),
        motor_power=table.column("motor_power"),
        limited=table.flag("has_limits"),
        limit_min=table.angle("limit_min"),
        limit_max=table.angle("limit_max"),
    )


def _with_masses(state: EnvState) -> EnvState:
    """Return the inverse masses and inertias that the flat form clipped, from shape and density.

    Source: the conventions of Kinetix (physics of its levels): a disc's inertia is π/4·ρ·r⁴.
    """
    bodies, density = state.world.bodies, state.labels.density
    area, moment = jax.vmap(_polygon_moments)(bodies.vertices, bodies.vertex_count)
    area = jnp.concatenate([area, math.pi * bodies.radius**2]) * density
    moment = jnp.concatenate([moment, math.pi / 4 * bodies.radius**4]) * density

    def restored(seen: Array, value: Array) -> Array:
        return jnp.where(seen >= BOUND, 1.0 / jnp.where(value > 0, value, 1.0), seen)

    return dataclasses.replace(
        state,
        world=dataclasses.replace(
            state.world,
            bodies=dataclasses.replace(
                bodies,
                inverse_mass=restored(bodies.inverse_mass, area),
                inverse_inertia=restored(bodies.inverse_inertia, moment),
            ),
        ),
    )


def _polygon_moments(
    vertices: Float[Array, "v 2"], count: Int[Array, ""]
) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Area [m²] and second moment about the origin of the frame [m⁴]."""
    index = jnp.arange(vertices.shape[0])
    following = jnp.where(index + 1 < count, index + 1, 0)
    a, b = vertices, vertices[following]
    cross = jnp.where(index < count, jnp.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), 0.0)
    squares = jnp.sum(a * a + a * b + b * b, axis=1)
    return jnp.sum(cross) / 2, jnp.sum(cross * squares) / 12
