"""The solver: one step of kinetix-env's scheme."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.collision.jax2d import Manifold
from kinetix.engine.lookup import onto, take
from kinetix.engine.maths import Vec, cross, dot, rotate, unvec, vec
from kinetix.engine.pairs import pair_counts
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.end import clipped
from kinetix.engine.solvers.pgs_baumgarte.contacts import (
    Contacts,
    Kinds,
    apply_impulses,
    contact_velocity,
    solve_points,
)
from kinetix.engine.solvers.pgs_baumgarte.joints import drive, solve_joints
from kinetix.engine.solvers.pgs_baumgarte.moving import Impulses, Moving, PgsBaumgarteCache
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World


@dataclasses.dataclass(frozen=True, kw_only=True)
class PgsBaumgarte(AbstractSolver):
    """Projected Gauss–Seidel, Baumgarte bias, joints by a relaxed scalar mass (preset `jax2d`).

    Source: the behaviour of jax2d 1.0.1 (Matthews, Beukman, Lu & Foerster 2025).
    """

    iterations: int = 10
    """Sweeps over all joints and contacts."""
    batch_size: int = 16
    """Pairs of a kind that are solved from the same velocities."""
    warm_start: bool = True
    """Start from the impulses of the previous step."""

    def empty_cache(self, spec: SceneSpec) -> Any:
        """Zero impulses for every pair slot and joint."""
        capacity = spec.capacity
        polygon_polygon, circle_polygon, circle_circle = pair_counts(capacity)

        def zeros(count: int) -> Any:
            return np.zeros(count, np.float32)

        def impulses(count: int) -> Any:
            return Impulses(normal=zeros(count), tangent=zeros(count))

        return PgsBaumgarteCache(
            polygons=impulses(polygon_polygon),
            polygons_second=impulses(polygon_polygon),
            circle_polygons=impulses(circle_polygon),
            circles=impulses(circle_circle),
            joint_x=zeros(capacity.joints),
            joint_y=zeros(capacity.joints),
            joint_angular=zeros(capacity.joints),
        )

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """See the contract; one step of kinetix-env's engine."""
        bodies = world.bodies
        kinds = Kinds(spec)
        moves = (bodies.inverse_mass != 0).astype(state.rotation.dtype) * parameters.dt
        moving = Moving(
            position=vec(state.position),
            rotation=state.rotation,
            velocity=vec(state.velocity) + Vec(x=world.gravity[0], y=world.gravity[1]) * moves,
            omega=state.angular_velocity,
        )
        manifolds = kinds.manifolds(world, state)
        contacts = tuple(
            self._prepare(world, moving, manifold, pairs)
            for manifold, pairs in zip(manifolds, kinds.slots, strict=True)
        )
        moving = drive(world, moving, control, parameters)
        cache: PgsBaumgarteCache = state.cache
        if not self.warm_start:
            cache = jax.tree.map(jnp.zeros_like, cache)
        impulses = tuple(
            Impulses(
                normal=jnp.where(contact.manifold.active, old.normal, 0),
                tangent=jnp.where(contact.manifold.active, old.tangent, 0),
            )
            for contact, old in zip(
                contacts,
                (cache.polygons, cache.polygons_second, cache.circle_polygons, cache.circles),
                strict=True,
            )
        )
        joint_impulses = (cache.joint_x, cache.joint_y, cache.joint_angular)
        if self.warm_start:
            moving = _warm_start(world, moving, contacts, impulses, joint_impulses, kinds)

        def sweep(_: Int[Array, ""], carry: tuple) -> tuple:
            moving, impulses, joint_impulses = carry
            moving, joint_impulses = solve_joints(world, moving, joint_impulses, parameters)
            solved = []
            for contact, old, pairs in zip(contacts, impulses, kinds.slots, strict=True):
                moving, new = self._solve_kind(world, moving, contact, old, pairs, parameters)
                solved.append(new)
            return moving, tuple(solved), joint_impulses

        moving, impulses, joint_impulses = jax.lax.fori_loop(
            0, self.iterations, sweep, (moving, impulses, joint_impulses)
        )
        return _finish(state, moving, manifolds, impulses, joint_impulses, parameters)

    def _prepare(
        self, world: World, moving: Moving, manifold: Manifold, pairs: Int[np.ndarray, "q 2"]
    ) -> Contacts:
        bodies = world.bodies
        a, b = pairs[:, 0], pairs[:, 1]
        approach = dot(manifold.normal, contact_velocity(moving, manifold.point, a, b))
        pushes = (
            manifold.active
            & ((bodies.inverse_mass[a] != 0) | (bodies.inverse_mass[b] != 0))
            & world.collides[a, b]
        )
        friction = jnp.sqrt((bodies.friction[a]) ** 2 + (bodies.friction[b]) ** 2)
        return Contacts(
            manifold=manifold,
            pushes=pushes,
            bounce=jnp.where(
                manifold.active,
                approach * jnp.minimum(bodies.restitution[a], bodies.restitution[b]),
                0,
            ),
            friction=friction,
            batch=self._batches(manifold.active),
        )

    def _batch_count(self, pair_count: int) -> int:
        return -(-pair_count // self.batch_size)

    def _batches(self, active: Bool[Array, "q n"]) -> Int[Array, "q n"]:
        """The batch of each pair: inactive pairs first, then active ones, dealt out in turn."""
        count = active.shape[0]
        if count == 0:
            return jnp.zeros(active.shape, jnp.int32)
        idle = jnp.cumsum(~active, axis=0, dtype=jnp.int32)
        busy = jnp.cumsum(active, axis=0, dtype=jnp.int32)
        rank = jnp.where(active, idle[-1:] + busy - 1, idle - 1)
        return rank % self._batch_count(count)

    def _solve_kind(
        self,
        world: World,
        moving: Moving,
        contacts: Contacts,
        impulses: Impulses,
        pairs: Int[np.ndarray, "q 2"],
        parameters: Parameters,
    ) -> tuple[Moving, Impulses]:
        """Do one sweep over one kind, batch after batch."""
        count = len(pairs)
        if count == 0:
            return moving, impulses
        batches = self._batch_count(count)
        padding = batches * self.batch_size - count

        def solve(
            moving: Moving, impulses: Impulses, batch: Int[Array, ""] | int
        ) -> tuple[Moving, Impulses]:
            here = contacts.batch == batch
            moving, new = solve_points(world, moving, contacts, impulses, here, pairs, parameters)
            # kinetix-env pads a batch with index −1, which is the last pair: its impulses are lost.
            padded = (
                (jnp.arange(padding) + count) % batches == batch if padding else np.zeros(1, bool)
            )
            lost = jnp.any(padded) & (np.arange(count)[:, None] == count - 1)
            return moving, Impulses(
                normal=jnp.where(lost, 0, new.normal), tangent=jnp.where(lost, 0, new.tangent)
            )

        if batches == 1:
            return solve(moving, impulses, 0)

        def next_batch(batch: Any, carry: tuple[Moving, Impulses]) -> tuple[Moving, Impulses]:
            return solve(carry[0], carry[1], batch)

        return jax.lax.fori_loop(0, batches, next_batch, (moving, impulses))


def _warm_start(
    world: World,
    moving: Moving,
    contacts: tuple[Contacts, ...],
    impulses: tuple[Impulses, ...],
    joint_impulses: tuple[Float[Array, "j n"], ...],
    kinds: Kinds,
) -> Moving:
    """Apply last step's impulses, unscaled."""
    start = moving
    for contact, impulse, pairs in zip(contacts, impulses, kinds.slots, strict=True):
        normal, point = contact.manifold.normal, contact.manifold.point
        total = normal * impulse.normal + Vec(x=normal.y, y=-normal.x) * impulse.tangent
        arm_a, arm_b = point - start.position[pairs[:, 0]], point - start.position[pairs[:, 1]]
        moving = apply_impulses(world, moving, total, arm_a, arm_b, pairs)
    joints, bodies = world.joints, world.bodies
    count = bodies.inverse_mass.shape[0]
    x, y, angular = joint_impulses
    impulse = Vec(x=x, y=y)
    arms = []
    for body, anchor in ((joints.body_a, joints.anchor_a), (joints.body_b, joints.anchor_b)):
        angle = take(moving.rotation, body)
        arms.append(rotate(jnp.cos(angle), jnp.sin(angle), vec(anchor)))

    def net(on_a: Float[Array, "j n"], on_b: Float[Array, "j n"]) -> Float[Array, "b n"]:
        return onto(on_a, joints.body_a, count) - onto(on_b, joints.body_b, count)

    turn = net(cross(arms[0], impulse) + angular, cross(arms[1], impulse) + angular)
    return dataclasses.replace(
        moving,
        velocity=moving.velocity + Vec(x=net(x, x), y=net(y, y)) * bodies.inverse_mass,
        omega=moving.omega + turn * bodies.inverse_inertia,
    )


def _finish(
    state: State,
    moving: Moving,
    manifolds: tuple[Manifold, ...],
    impulses: tuple[Impulses, ...],
    joint_impulses: tuple[Float[Array, "j n"], ...],
    parameters: Parameters,
) -> State:
    """Drift, clip, and keep the impulses."""
    dt = parameters.dt
    deeper, _, mixed, circles = manifolds
    end = dataclasses.replace(
        state,
        position=unvec(moving.position + moving.velocity * dt),
        rotation=moving.rotation + moving.omega * dt,
        velocity=unvec(moving.velocity),
        angular_velocity=moving.omega,
        touching=jnp.concatenate([deeper.active, mixed.active, circles.active], axis=0),
        cache=PgsBaumgarteCache(
            polygons=impulses[0],
            polygons_second=impulses[1],
            circle_polygons=impulses[2],
            circles=impulses[3],
            joint_x=joint_impulses[0],
            joint_y=joint_impulses[1],
            joint_angular=joint_impulses[2],
        ),
    )
    return clipped(end, parameters)
