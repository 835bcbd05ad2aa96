"""One row an entity, by kind, with masks for attention."""

import dataclasses
import math
from typing import ClassVar, NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.types import World
from kinetix.environment.goal import touch_matrix
from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.features import Feature
from kinetix.environment.observations.rows import (
    body_rows,
    finite,
    gravity_feature,
    joint_rows,
    thruster_rows,
)
from kinetix.environment.spaces import Binary, Box, Dict, Space
from kinetix.environment.state import EnvState


class EntityObservation(NamedTuple):
    """The rows by kind, with masks; rows of inactive entities are not zeroed."""

    circles: Float[Array, "r f"]
    """Circle rows, gravity appended."""
    polygons: Float[Array, "p f"]
    """Polygon rows, the arena's included, gravity appended."""
    joints: Float[Array, "j2 f"]
    """Joint rows seen from body b, then the same joints seen from body a."""
    thrusters: Float[Array, "t f"]
    """Thruster rows."""
    circle_mask: Bool[Array, " r"]
    """True for active circles."""
    polygon_mask: Bool[Array, " p"]
    """True for active polygons."""
    joint_mask: Bool[Array, " j2"]
    """True for active joints, each listed twice."""
    thruster_mask: Bool[Array, " t"]
    """True for active thrusters."""
    attention_mask: Bool[Array, "4 b b"] | None
    """True where a row's body may attend to a column's, in global order: everyone, the same jointed
    component, joined directly, in contact."""
    joint_indexes: Int[Array, "j2 2"]
    """From-body and to-body of every joint row; (0, 0) where inactive."""
    thruster_indexes: Int[Array, " t"]
    """Body of every thruster."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EntityObservations(AbstractObservation):
    """The default form, for networks that treat entities as a set."""

    name: ClassVar[str] = "symbolic_entity"

    attention: bool = True
    """True if the attention mask is made; networks without attention do not need it."""
    symmetric_contacts: bool = False
    """True if the contact plane holds in both directions (Kinetix.js) or only from the first body
    of a candidate pair to the second (Kinetix)."""
    js_anchor_order: bool = False
    """True if a joint's anchors stand in Kinetix.js's order, swapped against the indices."""
    from_upper_corner: bool = False
    """True if a list of four corners that begins at a lower one is seen from the upper right one
    on: levels differ in where they begin, and nothing moves otherwise for it."""

    @property
    def space(self) -> Dict:
        """The parts by name."""
        size, layout = self.layout.capacity, self.layout

        def rows(count: int, width: int) -> Box:
            return Box(low=-math.inf, high=math.inf, shape=(count, width))

        def indexes(*shape: int) -> Box:
            return Box(low=0, high=max(size.bodies - 1, 0), shape=shape, dtype=jnp.int32)

        spaces: dict[str, Space] = {
            "circles": rows(size.circles, len(layout.circle) + 1),
            "polygons": rows(size.polygons, len(layout.polygon) + 1),
            "joints": rows(2 * size.joints, len(layout.joint)),
            "thrusters": rows(size.thrusters, len(layout.thruster)),
            "circle_mask": Binary(shape=(size.circles,)),
            "polygon_mask": Binary(shape=(size.polygons,)),
            "joint_mask": Binary(shape=(2 * size.joints,)),
            "thruster_mask": Binary(shape=(size.thrusters,)),
        }
        if self.attention:
            spaces["attention_mask"] = Binary(shape=(4, size.bodies, size.bodies))
        return Dict(
            spaces=spaces
            | {
                "joint_indexes": indexes(2 * size.joints, 2),
                "thruster_indexes": indexes(size.thrusters),
            }
        )

    @property
    def columns(self) -> dict[str, tuple[Feature, ...]]:
        """The four kinds of rows."""
        layout = self.layout
        return {
            "circles": (*layout.circle, layout.gravity),
            "polygons": (*layout.polygon, layout.gravity),
            "joints": layout.joint,
            "thrusters": layout.thruster,
        }

    def __call__(self, state: EnvState) -> EntityObservation:
        """Return the rows, masks and indices."""
        layout = self.layout
        state = dataclasses.replace(
            state,
            world=finite(state.world),
            physics=dataclasses.replace(
                state.physics,
                position=finite(state.physics.position),
                rotation=finite(state.physics.rotation),
                velocity=finite(state.physics.velocity),
                angular_velocity=finite(state.physics.angular_velocity),
            ),
            labels=finite(state.labels),
        )
        world, polygons = state.world, layout.capacity.polygons
        if self.from_upper_corner:
            state = dataclasses.replace(state, world=_from_upper_corner(world))
        polygon_rows, circle_rows = body_rows(state, layout)
        from_b, from_a = joint_rows(state, layout)
        if self.js_anchor_order:
            from_b, from_a = _anchors_swapped(from_b), _anchors_swapped(from_a)
        gravity = gravity_feature(state)
        joint_indexes = _joint_indexes(state)
        return EntityObservation(
            circles=_with_gravity(circle_rows, gravity),
            polygons=_with_gravity(polygon_rows, gravity),
            joints=jnp.concatenate([from_b, from_a]),
            thrusters=thruster_rows(state, layout),
            circle_mask=world.bodies.active[polygons:],
            polygon_mask=world.bodies.active[:polygons],
            joint_mask=jnp.concatenate([world.joints.active, world.joints.active]),
            thruster_mask=world.thrusters.active,
            attention_mask=self._attention(state) if self.attention else None,
            joint_indexes=joint_indexes,
            thruster_indexes=world.thrusters.body,
        )

    def _attention(self, state: EnvState) -> Bool[Array, "4 b b"]:
        active = state.world.bodies.active
        both = active[:, None] & active[None, :]
        contact = touch_matrix(state.physics.touching, self.layout.capacity)
        if self.symmetric_contacts:
            contact = contact | contact.T
        planes = [both, ~state.world.collides & both, _joined(state) & both, contact & both]
        return jnp.stack(planes)


def _from_upper_corner(world: World) -> World:
    bodies = world.bodies
    x, y = bodies.vertices[:, 0, 0], bodies.vertices[:, 0, 1]
    is_lower = (y < 0) & (bodies.vertex_count == 4)
    vertices = bodies.vertices
    # Clockwise from the lower right corner, the upper right one is last; from the left one, third.
    for corners_back, begins_there in ((1, is_lower & (x > 0)), (2, is_lower & (x <= 0))):
        turned = jnp.roll(bodies.vertices, corners_back, axis=1)
        vertices = jnp.where(begins_there[:, None, None], turned, vertices)
    return dataclasses.replace(world, bodies=dataclasses.replace(bodies, vertices=vertices))


def _with_gravity(rows: Float[Array, "e f"], gravity: Float[Array, ""]) -> Float[Array, "e g"]:
    column = jnp.broadcast_to(gravity, (rows.shape[0], 1))
    return jnp.concatenate([rows, column], axis=1)


def _anchors_swapped(rows: Float[Array, "j f"]) -> Float[Array, "j f"]:
    return jnp.concatenate([rows[:, :2], rows[:, 4:6], rows[:, 2:4], rows[:, 6:]], axis=1)


def _joint_indexes(state: EnvState) -> Int[Array, "j2 2"]:
    joints = state.world.joints
    a = jnp.where(joints.active, joints.body_a, 0)
    b = jnp.where(joints.active, joints.body_b, 0)
    return jnp.concatenate([jnp.stack([b, a], axis=1), jnp.stack([a, b], axis=1)])


def _joined(state: EnvState) -> Bool[Array, "b b"]:
    """Return whether two bodies share an active joint; never true of a body with itself.

    Joint by joint and elementwise, because a scatter would cost more under vmap.
    """
    joints = state.world.joints
    bodies = state.world.bodies.active.shape[0]
    index = jnp.arange(bodies)

    def add(joint: int, joined: Bool[Array, "b b"]) -> Bool[Array, "b b"]:
        is_a = (index == joints.body_a[joint]) & joints.active[joint]
        is_b = (index == joints.body_b[joint]) & joints.active[joint]
        return joined | (is_a[:, None] & is_b[None, :]) | (is_b[:, None] & is_a[None, :])

    joined = jnp.zeros((bodies, bodies), bool)
    for joint in range(joints.active.shape[0]):
        joined = add(joint, joined)
    return joined & ~jnp.eye(bodies, dtype=bool)
