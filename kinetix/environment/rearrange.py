"""The same level in other slots: larger capacities, permuted entities."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from kinetix.aliases import also_named
from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.pipeline import empty_cache
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.engine.types import Bodies, World
from kinetix.environment.checks import check_key, check_one_state, check_static_params
from kinetix.environment.kinetix_env.fields import CONSTANTS
from kinetix.environment.params import StaticEnvParams, physics_engine
from kinetix.environment.state import EnvState, without_contacts
from kinetix.errors import KinetixError
from kinetix.forks import refuse_forked_process
from kinetix.level.features import capacity_of_world


def expand_state(
    state: EnvState, static_env_params: StaticEnvParams, *, name: str = "the level"
) -> EnvState:
    """A state in more slots: new slots are inactive and zero, circles keep coming after polygons.

    The memory of contacts starts empty, in the form of the solver that `static_env_params` names.

    Args:
        state: One state (not a batch).
        static_env_params: The sizes to expand to.
        name: The level's name for the message.

    Raises:
        KinetixError: The level does not fit; the message says of what there are too many, and by
            how many. Or an argument is something else, or a batch.
    """
    refuse_forked_process()
    order = "the order is expand_state(state, static_env_params)"
    check_static_params(static_env_params, order)
    check_one_state(state, "jax.vmap(lambda state: expand_state(state, static_env_params))", order)
    have, need = capacity_of_world(state.world), static_env_params.capacity
    _check_fit(have, need, name)
    engine = physics_engine(static_env_params)
    cache = empty_cache(engine.spec, engine.solver)
    if have == need:
        physics = dataclasses.replace(without_contacts(state.physics), cache=cache)
        return dataclasses.replace(state, physics=physics)
    sizes = (have, need)
    physics = dataclasses.replace(
        state.physics,
        position=_bodies(state.physics.position, sizes),
        rotation=_bodies(state.physics.rotation, sizes),
        velocity=_bodies(state.physics.velocity, sizes),
        angular_velocity=_bodies(state.physics.angular_velocity, sizes),
        touching=jnp.zeros(len(candidate_pairs(need)), bool),
        overflow=jnp.zeros((), bool),
        cache=cache,
    )
    labels = dataclasses.replace(
        state.labels,
        role=_bodies(state.labels.role, sizes),
        density=_bodies(state.labels.density, sizes),
        motor_binding=_grown(state.labels.motor_binding, need.joints),
        motor_auto=_grown(state.labels.motor_auto, need.joints),
        thruster_binding=_grown(state.labels.thruster_binding, need.thrusters),
    )
    return dataclasses.replace(
        state, world=_expanded_world(state.world, sizes), physics=physics, labels=labels
    )


def check_bindings(state: EnvState, static_env_params: StaticEnvParams, *, name: str) -> None:
    """Make sure that the action channel of every active actuator exists.

    Raises:
        KinetixError: A binding is too large; the message says which kind and by how much.
    """
    world, labels, static = state.world, state.labels, static_env_params
    limits = (
        ("motor", labels.motor_binding, world.joints.active, static.num_motor_bindings),
        ("thruster", labels.thruster_binding, world.thrusters.active, static.num_thruster_bindings),
    )
    for kind, binding, active, count in limits:
        largest = int(np.max(np.asarray(binding), initial=0, where=np.asarray(active)))
        if largest >= count:
            raise KinetixError(
                f"{name} does not fit: it uses {kind} binding {largest}, but there are {count} "
                f"(num_{kind}_bindings): {largest + 1 - count} too few"
            )


@also_named(rng="key", env_state="state")
def permute_state(
    key: Array, state: EnvState, static_env_params: StaticEnvParams | None = None
) -> EnvState:
    """Return the same level with its circles, polygons, joints and thrusters in other slots.

    Each kind is permuted uniformly and independently; the arena stays. Which body of a joint is
    first does not change. The memory of contacts is emptied.

    Args:
        key: Draws the permutations.
        state: One state; use `vmap` for a batch.
        static_env_params: Taken for kinetix-env's sake; the state knows its sizes.

    Raises:
        KinetixError: `key` is not a key, `state` is not a state, or one is a batch.
    """
    del static_env_params
    refuse_forked_process()
    order = "the order is permute_state(key, state, static_env_params)"
    many = "jax.vmap(permute_state)(jax.random.split(key, n), states)"
    check_one_state(state, many, order)
    check_key(key, order, many)
    size = capacity_of_world(state.world)
    polygon_key, circle_key, joint_key, thruster_key = jax.random.split(key, 4)
    polygons = ARENA_BODIES + jax.random.permutation(polygon_key, size.polygons - ARENA_BODIES)
    polygons = jnp.concatenate([jnp.arange(ARENA_BODIES), polygons])
    circles = jax.random.permutation(circle_key, size.circles)
    return rearranged(
        state,
        polygons=polygons,
        circles=circles,
        joints=jax.random.permutation(joint_key, size.joints),
        thrusters=jax.random.permutation(thruster_key, size.thrusters),
    )


def rearranged(
    state: EnvState,
    *,
    polygons: Int[Array, " p"],
    circles: Int[Array, " r"],
    joints: Int[Array, " j"],
    thrusters: Int[Array, " t"],
) -> EnvState:
    """Return the state whose slot i holds what slot `polygons[i]` (and so on) held before."""
    order = jnp.concatenate([polygons, polygons.shape[0] + circles])
    slot_of = jnp.argsort(order)
    world, labels = state.world, state.labels
    bodies = world.bodies
    moved_bodies = Bodies(
        inverse_mass=bodies.inverse_mass[order],
        inverse_inertia=bodies.inverse_inertia[order],
        friction=bodies.friction[order],
        restitution=bodies.restitution[order],
        collision_mode=bodies.collision_mode[order],
        active=bodies.active[order],
        vertices=bodies.vertices[polygons],
        vertex_count=bodies.vertex_count[polygons],
        radius=bodies.radius[circles],
    )
    moved_joints: Any = jax.tree.map(lambda x: x[joints], world.joints)
    moved_thrusters: Any = jax.tree.map(lambda x: x[thrusters], world.thrusters)
    physics = without_contacts(state.physics)
    return dataclasses.replace(
        state,
        world=dataclasses.replace(
            world,
            bodies=moved_bodies,
            joints=dataclasses.replace(
                moved_joints,
                body_a=slot_of[moved_joints.body_a].astype(moved_joints.body_a.dtype),
                body_b=slot_of[moved_joints.body_b].astype(moved_joints.body_b.dtype),
            ),
            thrusters=dataclasses.replace(
                moved_thrusters,
                body=slot_of[moved_thrusters.body].astype(moved_thrusters.body.dtype),
            ),
            collides=world.collides[order][:, order],
        ),
        physics=dataclasses.replace(
            physics,
            position=physics.position[order],
            rotation=physics.rotation[order],
            velocity=physics.velocity[order],
            angular_velocity=physics.angular_velocity[order],
        ),
        labels=dataclasses.replace(
            labels,
            role=labels.role[order],
            density=labels.density[order],
            motor_binding=labels.motor_binding[joints],
            motor_auto=labels.motor_auto[joints],
            thruster_binding=labels.thruster_binding[thrusters],
        ),
    )


def _check_fit(have: Capacity, need: Capacity, name: str) -> None:
    kinds = [field.name for field in dataclasses.fields(Capacity)]
    short = [
        f"{getattr(have, kind)} {kind} into {getattr(need, kind)} "
        f"({getattr(have, kind) - getattr(need, kind)} too many)"
        for kind in kinds
        if getattr(have, kind) > getattr(need, kind)
    ]
    if short:
        raise KinetixError(f"{name} does not fit: {', '.join(short)}")


def _expanded_world(world: World, sizes: tuple[Capacity, Capacity]) -> World:
    have, need = sizes
    shift = need.polygons - have.polygons
    bodies: Any = {name: _bodies(getattr(world.bodies, name), sizes) for name in CONSTANTS}
    joints: Any = jax.tree.map(lambda x: _grown(x, need.joints), world.joints)
    thrusters: Any = jax.tree.map(lambda x: _grown(x, need.thrusters), world.thrusters)

    def moved(index: Array) -> Array:
        return index + jnp.where(index >= have.polygons, shift, 0).astype(index.dtype)

    collides = _bodies(_bodies(world.collides, sizes, fill=True).T, sizes, fill=True)
    return World(
        bodies=Bodies(
            **bodies,
            vertices=_grown(world.bodies.vertices, need.polygons),
            vertex_count=_grown(world.bodies.vertex_count, need.polygons),
            radius=_grown(world.bodies.radius, need.circles),
        ),
        joints=dataclasses.replace(
            joints, body_a=moved(joints.body_a), body_b=moved(joints.body_b)
        ),
        thrusters=dataclasses.replace(thrusters, body=moved(thrusters.body)),
        gravity=jnp.asarray(world.gravity),
        collides=collides & ~jnp.eye(need.bodies, dtype=bool),
    )


def _grown(rows: Any, count: int, *, fill: Any = 0) -> Array:
    """Return rows filled up to a count."""
    rows = jnp.asarray(rows)
    padding = [(0, count - rows.shape[0])] + [(0, 0)] * (rows.ndim - 1)
    return jnp.pad(rows, padding, constant_values=jnp.asarray(fill, rows.dtype))


def _bodies(rows: Any, sizes: tuple[Capacity, Capacity], *, fill: Any = 0) -> Array:
    """Return rows of bodies, with gaps after the polygons and after the circles."""
    have, need = sizes
    rows = jnp.asarray(rows)
    polygons, circles = rows[: have.polygons], rows[have.polygons :]
    return jnp.concatenate(
        [_grown(polygons, need.polygons, fill=fill), _grown(circles, need.circles, fill=fill)]
    )
