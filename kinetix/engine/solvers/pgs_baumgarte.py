"""kinetix-env's scheme: projected Gauss–Seidel with Baumgarte stabilisation, its quirks included.

One velocity kick, ten sweeps, one drift. Contacts of a kind are solved in batches: all points of a
batch see the same velocities (Jacobi), the batches follow each other (Gauss–Seidel). Levels and
agents were made with this engine, so the preset `jax2d` has to reproduce it; docs/physics.md lists
where it fails. Worlds are on the last axis.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import actuators, collide_jax2d, maths
from kinetix.engine.collide_jax2d import Manifold
from kinetix.engine.lookup import onto, take
from kinetix.engine.maths import Vec, cross, dot, nonzero, rotate, spin, unvec, vec
from kinetix.engine.pairs import candidate_pairs, may_push, pair_counts
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.pytree import pytree


@pytree
class Impulses:
    """Accumulated impulses of one kind of contact."""

    normal: Float[Array, "q n"]
    tangent: Float[Array, "q n"]


@pytree
class PgsBaumgarteCache:
    """Impulses for the warm start: contacts by kind and slot, and the joints."""

    polygons: Impulses
    polygons_second: Impulses
    circle_polygons: Impulses
    circles: Impulses
    joint_x: Float[Array, "j n"]
    joint_y: Float[Array, "j n"]
    joint_angular: Float[Array, "j n"]


@pytree
class Moving:
    """The bodies while they are being solved."""

    position: Vec
    rotation: Float[Array, "b n"]
    velocity: Vec
    omega: Float[Array, "b n"]


@pytree
class Contacts:
    """One slot of one kind of contact, prepared for the sweeps."""

    manifold: Manifold
    pushes: Bool[Array, "q n"]
    """True where an impulse may act (the reward looks at `manifold.active` instead)."""
    bounce: Float[Array, "q n"]
    """Restitution target: approach velocity times restitution [m/s], negative."""
    friction: Float[Array, "q n"]
    batch: Int[Array, "q n"]
    """Batch that solves the pair."""


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
        kinds = _Kinds(spec)
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
        moving = _drive(world, moving, control, parameters)
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
            moving, joint_impulses = _solve_joints(world, moving, joint_impulses, parameters)
            solved = []
            for contact, old, pairs in zip(contacts, impulses, kinds.slots, strict=True):
                moving, new = self._solve_kind(world, moving, contact, old, pairs, parameters)
                solved.append(new)
            return moving, tuple(solved), joint_impulses

        moving, impulses, joint_impulses = jax.lax.fori_loop(
            0, self.iterations, sweep, (moving, impulses, joint_impulses)
        )
        return _finish(world, state, moving, manifolds, impulses, joint_impulses, parameters)

    def _prepare(
        self, world: World, moving: Moving, manifold: Manifold, pairs: Int[np.ndarray, "q 2"]
    ) -> Contacts:
        bodies = world.bodies
        a, b = pairs[:, 0], pairs[:, 1]
        approach = dot(manifold.normal, _contact_velocity(moving, manifold.point, a, b))
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
        """One sweep over one kind, batch after batch."""
        count = len(pairs)
        if count == 0:
            return moving, impulses
        batches = self._batch_count(count)
        padding = batches * self.batch_size - count

        def solve(
            moving: Moving, impulses: Impulses, batch: Int[Array, ""] | int
        ) -> tuple[Moving, Impulses]:
            here = contacts.batch == batch
            moving, new = _solve_points(world, moving, contacts, impulses, here, pairs, parameters)
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


class _Kinds:
    """The static pair lists of a capacity, by contact slot."""

    def __init__(self, spec: SceneSpec) -> None:
        pairs = candidate_pairs(spec.capacity)
        first, second, _ = pair_counts(spec.capacity)
        self.polygons = spec.capacity.polygons
        self.slots = (
            pairs[:first],
            pairs[:first],
            pairs[first : first + second],
            pairs[first + second :],
        )

    def manifolds(self, world: World, state: State) -> tuple[Manifold, ...]:
        """The step-start contacts of every slot, collision modes and activity applied."""
        shapes = collide_jax2d.move_shapes(world.bodies, state)
        centre = vec(state.position[self.polygons :])
        radius = world.bodies.radius
        polygon_pairs, _, mixed, circles = self.slots
        deeper, other = collide_jax2d.polygon_polygon(
            polygon_pairs[:, 0], polygon_pairs[:, 1], shapes
        )
        found = (
            deeper,
            other,
            collide_jax2d.circle_polygon(
                mixed[:, 0] - self.polygons, mixed[:, 1], centre, radius, shapes
            ),
            collide_jax2d.circle_circle(
                circles[:, 0] - self.polygons, circles[:, 1] - self.polygons, centre, radius
            ),
        )
        return tuple(
            dataclasses.replace(manifold, active=manifold.active & may_touch(world, pairs))
            for manifold, pairs in zip(found, self.slots, strict=True)
        )


def may_touch(world: World, pairs: Int[np.ndarray, "q 2"]) -> Bool[Array, "q n"]:
    """Both bodies active and the collision modes allow it."""
    bodies = world.bodies
    a, b = pairs[:, 0], pairs[:, 1]
    mode_a, mode_b = bodies.collision_mode[a], bodies.collision_mode[b]
    return bodies.active[a] & bodies.active[b] & may_push(mode_a, mode_b)


def _contact_velocity(
    moving: Moving, point: Vec, a: Int[np.ndarray, " q"], b: Int[np.ndarray, " q"]
) -> Vec:
    """Velocity of body b relative to body a at a point."""
    arm_a, arm_b = point - moving.position[a], point - moving.position[b]
    return (
        moving.velocity[b]
        + spin(moving.omega[b], arm_b)
        - moving.velocity[a]
        - spin(moving.omega[a], arm_a)
    )


def _solve_points(
    world: World,
    moving: Moving,
    contacts: Contacts,
    impulses: Impulses,
    here: Bool[Array, "q n"],
    pairs: Int[np.ndarray, "q 2"],
    parameters: Parameters,
) -> tuple[Moving, Impulses]:
    """Solve the chosen points from the current velocities and apply all of them at once."""
    bodies = world.bodies
    a, b = pairs[:, 0], pairs[:, 1]
    manifold = contacts.manifold
    normal = manifold.normal
    tangent = Vec(x=normal.y, y=-normal.x)
    arm_a, arm_b = manifold.point - moving.position[a], manifold.point - moving.position[b]
    mass_a, mass_b = bodies.inverse_mass[a], bodies.inverse_mass[b]
    inertia_a, inertia_b = bodies.inverse_inertia[a], bodies.inverse_inertia[b]

    def effective(direction: Vec) -> Float[Array, "q n"]:
        along_a, along_b = dot(arm_a, direction), dot(arm_b, direction)
        return nonzero(
            mass_a
            + mass_b
            + inertia_a * (dot(arm_a, arm_a) - along_a**2)
            + inertia_b * (dot(arm_b, arm_b) - along_b**2)
        )

    relative = _contact_velocity(moving, manifold.point, a, b)
    bias = (
        parameters.baumgarte_collision
        / parameters.dt
        * jnp.maximum(0, manifold.depth - parameters.slop)
    )
    wanted = (bias - dot(relative, normal) - contacts.bounce) / effective(normal)
    total_normal = jnp.maximum(impulses.normal + wanted, 0)
    gained_normal = total_normal - impulses.normal

    # The tangent sees the velocities with this point's own normal impulse in them.
    push = normal * gained_normal
    after = relative + push * (mass_a + mass_b)
    after = (
        after
        + spin(inertia_b * cross(arm_b, push), arm_b)
        + spin(inertia_a * cross(arm_a, push), arm_a)
    )
    bound = parameters.base_friction * contacts.friction * total_normal
    total_tangent = jnp.clip(
        impulses.tangent - dot(after, tangent) / effective(tangent), -bound, bound
    )
    gained_tangent = total_tangent - impulses.tangent

    acts = here & contacts.pushes
    total = jax.tree.map(
        lambda x: jnp.where(acts, x, 0), normal * gained_normal + tangent * gained_tangent
    )
    moving = _apply(world, moving, total, arm_a, arm_b, pairs)
    return moving, Impulses(
        normal=jnp.where(here, jnp.where(contacts.pushes, total_normal, 0), impulses.normal),
        tangent=jnp.where(here, jnp.where(contacts.pushes, total_tangent, 0), impulses.tangent),
    )


def _apply(
    world: World,
    moving: Moving,
    impulse: Vec,
    arm_a: Vec,
    arm_b: Vec,
    pairs: Int[np.ndarray, "q 2"],
) -> Moving:
    """Add impulses on b (and their opposites on a) to the velocities, summed over the pairs."""
    bodies = world.bodies
    count = bodies.inverse_mass.shape[0]
    on_b = (pairs[None, :, 1] == np.arange(count)[:, None]).astype(np.float32)
    on_a = (pairs[None, :, 0] == np.arange(count)[:, None]).astype(np.float32)

    def gather(to_a: Float[Array, "q n"], to_b: Float[Array, "q n"]) -> Float[Array, "b n"]:
        return jnp.asarray(on_b, to_b.dtype) @ to_b - jnp.asarray(on_a, to_a.dtype) @ to_a

    return dataclasses.replace(
        moving,
        velocity=moving.velocity
        + Vec(
            x=gather(impulse.x, impulse.x) * bodies.inverse_mass,
            y=gather(impulse.y, impulse.y) * bodies.inverse_mass,
        ),
        omega=moving.omega
        + gather(cross(arm_a, impulse), cross(arm_b, impulse)) * bodies.inverse_inertia,
    )


def _drive(world: World, moving: Moving, control: Control, parameters: Parameters) -> Moving:
    """Motors and thrusters, each one explicit impulse from the same velocities."""
    joints, bodies = world.joints, world.bodies
    count = bodies.inverse_mass.shape[0]
    inertia = take(bodies.inverse_inertia, joints.body_a) + take(
        bodies.inverse_inertia, joints.body_b
    )
    angle = (
        take(moving.rotation, joints.body_b)
        - take(moving.rotation, joints.body_a)
        - joints.reference_angle
    )
    action = control.motor
    target = parameters.base_motor_speed * joints.motor_speed * action
    error = take(moving.omega, joints.body_b) - take(moving.omega, joints.body_a) - target
    strength = (
        parameters.base_motor_power
        * joints.motor_power
        * parameters.dt
        * actuators.motor_fade(world, angle, action, parameters)
    )
    twist = strength / nonzero(inertia) * jnp.tanh(parameters.motor_decay_coefficient * error)
    twist = jnp.where(actuators.motor_runs(world, action), twist, 0)
    turned = onto(twist, joints.body_a, count) - onto(twist, joints.body_b, count)
    push, turn = actuators.thrust(world, moving.rotation, control, parameters)
    return dataclasses.replace(
        moving,
        velocity=moving.velocity + push * parameters.dt,
        omega=moving.omega + turned * bodies.inverse_inertia + turn * parameters.dt,
    )


def _warm_start(
    world: World,
    moving: Moving,
    contacts: tuple[Contacts, ...],
    impulses: tuple[Impulses, ...],
    joint_impulses: tuple[Float[Array, "j n"], ...],
    kinds: _Kinds,
) -> Moving:
    """Apply last step's impulses, unscaled."""
    start = moving
    for contact, impulse, pairs in zip(contacts, impulses, kinds.slots, strict=True):
        normal, point = contact.manifold.normal, contact.manifold.point
        total = normal * impulse.normal + Vec(x=normal.y, y=-normal.x) * impulse.tangent
        arm_a, arm_b = point - start.position[pairs[:, 0]], point - start.position[pairs[:, 1]]
        moving = _apply(world, moving, total, arm_a, arm_b, pairs)
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


def _solve_joints(
    world: World,
    moving: Moving,
    impulses: tuple[Float[Array, "j n"], ...],
    parameters: Parameters,
) -> tuple[Moving, tuple[Float[Array, "j n"], ...]]:
    """One sweep over the joints, one after the other."""
    count = world.joints.body_a.shape[0]
    if count == 0:
        return moving, impulses

    def one(moving: Moving, joint: tuple) -> tuple[Moving, tuple]:
        return _solve_joint(world, moving, joint[0], joint[1], parameters)

    moving, impulses = jax.lax.scan(one, moving, (world.joints, impulses))
    return moving, impulses


def _solve_joint(
    world: World,
    moving: Moving,
    joint: Any,
    impulse: tuple[Float[Array, " n"], ...],
    parameters: Parameters,
) -> tuple[Moving, tuple[Float[Array, " n"], ...]]:
    """One joint in all worlds; every quantity is taken from the state at its start."""
    bodies = world.bodies
    index = np.arange(bodies.inverse_mass.shape[0])[:, None]
    is_a, is_b = index == joint.body_a, index == joint.body_b

    def at(values: Float[Array, "b n"], mask: Bool[Array, "b n"]) -> Float[Array, " n"]:
        return jnp.sum(jnp.where(mask, values, 0), axis=0)

    def at_vec(values: Vec, mask: Bool[Array, "b n"]) -> Vec:
        return Vec(x=at(values.x, mask), y=at(values.y, mask))

    mass_a, mass_b = at(bodies.inverse_mass, is_a), at(bodies.inverse_mass, is_b)
    inertia_a, inertia_b = at(bodies.inverse_inertia, is_a), at(bodies.inverse_inertia, is_b)
    position_a, position_b = at_vec(moving.position, is_a), at_vec(moving.position, is_b)
    rotation_a, rotation_b = at(moving.rotation, is_a), at(moving.rotation, is_b)
    omega_a, omega_b = at(moving.omega, is_a), at(moving.omega, is_b)
    arm_a = rotate(
        jnp.cos(rotation_a), jnp.sin(rotation_a), Vec(x=joint.anchor_a[0], y=joint.anchor_a[1])
    )
    arm_b = rotate(
        jnp.cos(rotation_b), jnp.sin(rotation_b), Vec(x=joint.anchor_b[0], y=joint.anchor_b[1])
    )
    anchor_a, anchor_b = position_a + arm_a, position_b + arm_b

    weight_a, weight_b = 1 / nonzero(mass_a), 1 / nonzero(mass_b)
    middle = (anchor_a * weight_a + anchor_b * weight_b) / (weight_a + weight_b)
    middle = maths.where(mass_a == 0, anchor_a, maths.where(mass_b == 0, anchor_b, middle))
    relative = (
        at_vec(moving.velocity, is_b)
        + spin(omega_b, middle - position_b)
        - at_vec(moving.velocity, is_a)
        - spin(omega_a, middle - position_a)
    )
    direction = relative / nonzero(maths.length(relative))
    gap = anchor_b - anchor_a
    mass = (
        mass_a
        + mass_b
        + inertia_a * cross(arm_a, direction) ** 2
        + inertia_b * cross(arm_b, direction) ** 2
    )
    push = (relative + gap * parameters.baumgarte_joint_velocity) * (
        parameters.joint_stiffness / nonzero(mass)
    )
    share = parameters.baumgarte_joint_position / nonzero(mass_a + mass_b)

    spin_a = inertia_a * cross(arm_a, push)
    spin_b = -inertia_b * cross(arm_b, push)
    turning = (omega_b + spin_b) - (omega_a + spin_a)
    angle = rotation_b - rotation_a - joint.reference_angle
    twist, kept = _angular_impulse(
        joint, turning, angle, nonzero(inertia_a + inertia_b), parameters
    )

    both_active = (at(bodies.active.astype(mass_a.dtype), is_a) > 0) & (
        at(bodies.active.astype(mass_a.dtype), is_b) > 0
    )
    acts = joint.active & both_active & ((mass_a != 0) | (mass_b != 0))
    on = acts.astype(mass_a.dtype)
    velocity = (push * (on * mass_a), push * (-on * mass_b))
    nudge = (gap * (on * share * mass_a), gap * (-on * share * mass_b))
    moving = dataclasses.replace(
        moving,
        position=_add(moving.position, is_a, nudge[0], is_b, nudge[1]),
        velocity=_add(moving.velocity, is_a, velocity[0], is_b, velocity[1]),
        omega=moving.omega
        + jnp.where(is_a, on * (spin_a + inertia_a * twist), 0)
        + jnp.where(is_b, on * (spin_b - inertia_b * twist), 0),
    )
    x, y, angular = impulse
    return moving, (
        jnp.where(acts, x + push.x, 0),
        jnp.where(acts, y + push.y, 0),
        jnp.where(acts, kept * (angular + twist), 0),
    )


def _angular_impulse(
    joint: Any,
    turning: Float[Array, " n"],
    angle: Float[Array, " n"],
    inertia: Float[Array, " n"],
    parameters: Parameters,
) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """Angular impulse of a weld or of a violated limit, and whether it is accumulated (1 or 0)."""
    weld = (turning + parameters.baumgarte_fixed_joint * angle) / inertia
    beyond = angle - jnp.clip(angle, joint.limit_min, joint.limit_max)
    back = parameters.baumgarte_limit * beyond
    same = jnp.sign(turning) == jnp.sign(back)
    limit = jnp.where(same, (turning + back) / inertia, 0)
    limit = jnp.where(joint.limited & (beyond != 0), limit, 0)
    return jnp.where(joint.fixed, weld, limit), joint.fixed.astype(turning.dtype)


def _add(
    values: Vec, is_a: Bool[Array, "b n"], to_a: Vec, is_b: Bool[Array, "b n"], to_b: Vec
) -> Vec:
    return Vec(
        x=values.x + jnp.where(is_a, to_a.x, 0) + jnp.where(is_b, to_b.x, 0),
        y=values.y + jnp.where(is_a, to_a.y, 0) + jnp.where(is_b, to_b.y, 0),
    )


def _finish(
    world: World,
    state: State,
    moving: Moving,
    manifolds: tuple[Manifold, ...],
    impulses: tuple[Impulses, ...],
    joint_impulses: tuple[Float[Array, "j n"], ...],
    parameters: Parameters,
) -> State:
    """Drift, clip, and keep the impulses."""
    dt = parameters.dt
    bound, speed, spin_rate = (
        parameters.clip_position,
        parameters.clip_velocity,
        parameters.clip_angular_velocity,
    )
    deeper, _, mixed, circles = manifolds
    return dataclasses.replace(
        state,
        position=jnp.clip(unvec(moving.position + moving.velocity * dt), -bound, bound),
        rotation=moving.rotation + moving.omega * dt,
        velocity=jnp.clip(unvec(moving.velocity), -speed, speed),
        angular_velocity=jnp.clip(moving.omega, -spin_rate, spin_rate),
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
