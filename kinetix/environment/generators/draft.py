"""A whole level under construction, and how it becomes the environment's state and back.

A `Draft` lists bodies by slot (polygons, the arena first, then circles), worlds on the last axis.
It says what a level says and nothing derived: masses, the collision filter and the engine's empty
memory come in `states`.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.pipeline import empty_cache
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.engine.types import Bodies, Joints, State, Thrusters, World
from kinetix.environment.generators.blocks import JointRows, ThrusterRows
from kinetix.environment.generators.figures import VERTICES, Figures, inertia, mass, pick
from kinetix.environment.params import PhysicsEngine
from kinetix.environment.state import NO_DISTANCE, EnvState
from kinetix.level.compile import Labels
from kinetix.level.model import InertiaModel
from kinetix.pytree import pytree

FARTHEST = 15.0
"""Bound of every coordinate [m]: the engine clips to it in the first step, files refuse more."""
GRAVITY = (0.0, -9.81)
"""Gravity of generated levels [m/s²]."""


@pytree
class Draft:
    """Levels by slot, worlds last."""

    figures: Figures
    velocity: Float[Array, "b 2 n"]
    angular_velocity: Float[Array, "b n"]
    friction: Float[Array, "b n"]
    restitution: Float[Array, "b n"]
    collision_mode: Int[Array, "b n"]
    joints: JointRows
    thrusters: ThrusterRows
    gravity: Float[Array, "2 n"]


def plain_draft(figures: Figures, joints: JointRows, thrusters: ThrusterRows) -> Draft:
    """A level with default surfaces, everything at rest, under ordinary gravity."""
    rows = figures.rotation
    worlds = rows.shape[-1]
    mode = np.ones((rows.shape[0], 1), np.int32)
    mode[:ARENA_BODIES] = 2
    return Draft(
        figures=figures,
        velocity=jnp.zeros_like(figures.position),
        angular_velocity=jnp.zeros_like(rows),
        friction=jnp.ones_like(rows),
        restitution=jnp.zeros_like(rows),
        collision_mode=jnp.broadcast_to(jnp.asarray(mode), rows.shape),
        joints=joints,
        thrusters=thrusters,
        gravity=jnp.broadcast_to(jnp.array(GRAVITY, jnp.float32)[:, None], (2, worlds)),
    )


def components(joints: JointRows, bodies: int) -> Int[Array, "b n"]:
    """A number per body that is the same within a jointed component, and only there."""
    worlds = joints.active.shape[-1]
    labels = jnp.broadcast_to(jnp.arange(bodies, dtype=jnp.int32)[:, None], (bodies, worlds))
    for joint in range(joints.active.shape[0]):
        kept = pick(labels, joints.body_a[joint])
        gone = pick(labels, joints.body_b[joint])
        merge = joints.active[joint][None] & (labels == gone[None])
        labels = jnp.where(merge, kept[None], labels)
    return labels


def _worlds_first(rows: Array) -> Array:
    return jnp.moveaxis(rows, -1, 0)


def _worlds_last(rows: Array) -> Array:
    return jnp.moveaxis(rows, 0, -1)


def states(draft: Draft, engine: PhysicsEngine, inertia_model: InertiaModel) -> EnvState:
    """The drafts as environment states at the start of an episode, worlds on the first axis.

    Args:
        draft: The levels.
        engine: Sizes and solver.
        inertia_model: How the moments of inertia follow from the shapes.
    """
    capacity = engine.spec.capacity
    figures = draft.figures
    worlds = figures.rotation.shape[-1]
    labels = components(draft.joints, capacity.bodies)
    world = World(
        bodies=_bodies(draft, capacity, inertia_model),
        joints=_joints(draft.joints),
        thrusters=_thrusters(draft.thrusters),
        gravity=_worlds_first(draft.gravity),
        collides=_worlds_first(labels[:, None] != labels[None, :]),
    )
    pairs = candidate_pairs(capacity).shape[0]
    cache = jax.tree.map(
        lambda leaf: jnp.zeros((worlds, *np.shape(leaf)), np.asarray(leaf).dtype),
        empty_cache(engine.spec, engine.solver),
    )
    physics = State(
        position=_worlds_first(jnp.clip(figures.position, -FARTHEST, FARTHEST)),
        rotation=_worlds_first(figures.rotation),
        velocity=_worlds_first(draft.velocity),
        angular_velocity=_worlds_first(draft.angular_velocity),
        touching=jnp.zeros((worlds, pairs), bool),
        overflow=jnp.zeros((worlds,), bool),
        cache=cache,
    )
    return EnvState(
        world=world,
        physics=physics,
        labels=_labels(draft, worlds),
        timestep=jnp.zeros((worlds,), jnp.int32),
        last_distance=jnp.full((worlds,), NO_DISTANCE, jnp.float32),
    )


def _inverse(quantity: Float[Array, "b n"], moves: Bool[Array, "b n"]) -> Float[Array, "n b"]:
    safe = jnp.where(quantity == 0, 1.0, quantity)
    return _worlds_first(jnp.where(moves, 1 / safe, 0.0))


def _bodies(draft: Draft, capacity: Capacity, inertia_model: InertiaModel) -> Bodies:
    figures = draft.figures
    moves = figures.active & ~figures.fixed
    return Bodies(
        inverse_mass=_inverse(mass(figures), moves),
        inverse_inertia=_inverse(inertia(figures, inertia_model), moves),
        friction=_worlds_first(draft.friction),
        restitution=_worlds_first(draft.restitution),
        collision_mode=_worlds_first(draft.collision_mode),
        active=_worlds_first(figures.active),
        vertices=_worlds_first(figures.vertices[: capacity.polygons]),
        vertex_count=_worlds_first(figures.vertex_count[: capacity.polygons]),
        radius=_worlds_first(figures.radius[capacity.polygons :]),
    )


def _joints(joints: JointRows) -> Joints:
    return Joints(
        body_a=_worlds_first(joints.body_a),
        body_b=_worlds_first(joints.body_b),
        anchor_a=_worlds_first(joints.anchor_a),
        anchor_b=_worlds_first(joints.anchor_b),
        active=_worlds_first(joints.active),
        fixed=_worlds_first(joints.weld),
        reference_angle=_worlds_first(joints.reference_angle),
        motor_on=_worlds_first(joints.motor_on),
        motor_speed=_worlds_first(joints.motor_speed),
        motor_power=_worlds_first(joints.motor_power),
        limited=_worlds_first(joints.limited),
        limit_min=_worlds_first(joints.limit_min),
        limit_max=_worlds_first(joints.limit_max),
    )


def _thrusters(thrusters: ThrusterRows) -> Thrusters:
    return Thrusters(
        body=_worlds_first(thrusters.body),
        position=_worlds_first(thrusters.position),
        angle=_worlds_first(thrusters.angle),
        power=_worlds_first(thrusters.power),
        active=_worlds_first(thrusters.active),
    )


def _labels(draft: Draft, worlds: int) -> Labels:
    return Labels(
        role=_worlds_first(draft.figures.role),
        density=_worlds_first(draft.figures.density),
        motor_binding=_worlds_first(draft.joints.binding),
        motor_auto=_worlds_first(draft.joints.auto),
        thruster_binding=_worlds_first(draft.thrusters.binding),
        max_timesteps=jnp.zeros((worlds,), jnp.int32),
    )


def draft_of(state: EnvState) -> Draft:
    """Environment states (worlds on the first axis) as drafts, solver memory left behind."""
    bodies = state.world.bodies
    polygons, circles = bodies.vertex_count.shape[1], bodies.radius.shape[1]
    worlds = bodies.radius.shape[0]

    def after(rows: Array, fill: float) -> Array:
        return jnp.concatenate([rows, jnp.full((circles, *rows.shape[1:]), fill, rows.dtype)])

    radius = _worlds_last(bodies.radius)
    slots = jnp.arange(polygons + circles) >= polygons
    figures = Figures(
        position=_worlds_last(state.physics.position),
        rotation=_worlds_last(state.physics.rotation),
        vertices=after(_worlds_last(bodies.vertices), 0),
        vertex_count=after(_worlds_last(bodies.vertex_count), VERTICES),
        radius=jnp.concatenate([jnp.zeros((polygons, worlds), radius.dtype), radius]),
        circle=jnp.broadcast_to(slots[:, None], (polygons + circles, worlds)),
        role=_worlds_last(state.labels.role),
        density=_worlds_last(state.labels.density),
        fixed=_worlds_last(bodies.active & (bodies.inverse_mass == 0)),
        active=_worlds_last(bodies.active),
    )
    return Draft(
        figures=figures,
        velocity=_worlds_last(state.physics.velocity),
        angular_velocity=_worlds_last(state.physics.angular_velocity),
        friction=_worlds_last(bodies.friction),
        restitution=_worlds_last(bodies.restitution),
        collision_mode=_worlds_last(bodies.collision_mode),
        joints=_joint_rows(state),
        thrusters=_thruster_rows(state),
        gravity=_worlds_last(state.world.gravity),
    )


def _joint_rows(state: EnvState) -> JointRows:
    joints = state.world.joints
    names = (
        "body_a body_b anchor_a anchor_b active reference_angle motor_on motor_speed motor_power "
        "limited limit_min limit_max"
    )
    return JointRows(
        **{name: _worlds_last(getattr(joints, name)) for name in names.split()},
        weld=_worlds_last(joints.fixed),
        binding=_worlds_last(state.labels.motor_binding),
        auto=_worlds_last(state.labels.motor_auto),
    )


def _thruster_rows(state: EnvState) -> ThrusterRows:
    thrusters = state.world.thrusters
    return ThrusterRows(
        body=_worlds_last(thrusters.body),
        position=_worlds_last(thrusters.position),
        angle=_worlds_last(thrusters.angle),
        power=_worlds_last(thrusters.power),
        binding=_worlds_last(state.labels.thruster_binding),
        active=_worlds_last(thrusters.active),
    )
