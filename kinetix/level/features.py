"""Capacity, pairs that may push and features that a level or a compiled world needs."""

import dataclasses
import functools
from collections.abc import Iterable

import numpy as np
from jaxtyping import Bool

from kinetix.engine.pairs import candidate_pairs, may_push
from kinetix.engine.spec import ARENA_BODIES, Capacity, Features, SceneSpec, Used
from kinetix.engine.types import World
from kinetix.level.compile import Scene, compile_level
from kinetix.level.model import (
    Level,
)
from kinetix.level.sizes import (
    capacity_of,
)


def pushing_pairs(world: World) -> tuple[tuple[int, int], ...]:
    """Return the pairs of bodies that can ever push each other, as sorted global indices.

    Left out are exactly those with an inactive body, two fixed bodies, two bodies of one jointed
    component, or two bodies whose collision modes exclude each other; in candidate order.

    Args:
        world: Of one level or a batch: those that push each other in any of them.
    """
    bodies = world.bodies
    capacity = capacity_of_world(world)
    a, b = candidate_pairs(capacity).T
    active = np.asarray(bodies.active)
    mode = np.asarray(bodies.collision_mode)
    free = (np.asarray(bodies.inverse_mass) != 0) | (np.asarray(bodies.inverse_inertia) != 0)
    kept = active[..., a] & active[..., b] & (free[..., a] | free[..., b])
    kept &= may_push(mode[..., a], mode[..., b]) & np.asarray(world.collides)[..., a, b]
    kept = _in_any(kept)
    return tuple(
        (min(i, j), max(i, j)) for i, j in zip(a[kept].tolist(), b[kept].tolist(), strict=True)
    )


def capacity_of_world(world: World) -> Capacity:
    """Return the capacity that a compiled world has, or each of a batch."""
    return Capacity(
        polygons=world.bodies.vertex_count.shape[-1],
        circles=world.bodies.radius.shape[-1],
        joints=world.joints.active.shape[-1],
        thrusters=world.thrusters.active.shape[-1],
    )


def _in_any(slots: Bool[np.ndarray, "*n slots"]) -> Bool[np.ndarray, " slots"]:
    """Return of each slot whether it is true in any world."""
    return np.asarray(slots.any(axis=tuple(range(slots.ndim - 1))))


def features_of(subject: "Level | Scene | World", *, capacity: Capacity | None = None) -> Features:
    """Return the features that a level or compiled world uses: those left out could never act.

    Args:
        subject: A level, a scene or a world; of a batch, what any of its worlds uses.
        capacity: For a level: what it is compiled to; by default `capacity_of(level)`.
    """
    world = _world_of(subject, capacity)
    bodies, joints = world.bodies, world.joints
    active = np.asarray(joints.active)
    hinges = active & ~np.asarray(joints.fixed)
    filled = np.asarray(bodies.active)
    vertices = np.asarray(bodies.vertex_count)
    thrusters = np.asarray(world.thrusters.active)
    slots = _in_any(filled)
    return Features(
        pairs=pushing_pairs(world),
        used=Used(
            bodies=tuple(np.flatnonzero(slots | (np.arange(len(slots)) < ARENA_BODIES)).tolist()),
            joints=tuple(np.flatnonzero(_in_any(active)).tolist()),
            thrusters=tuple(np.flatnonzero(_in_any(thrusters)).tolist()),
        ),
        restitution=bool((np.asarray(bodies.restitution) * filled > 0).any()),
        triangles=bool((filled[..., : vertices.shape[-1]] & (vertices == 3)).any()),
        limits=bool((hinges & np.asarray(joints.limited)).any()),
        welds=bool((active & np.asarray(joints.fixed)).any()),
        motors=bool((hinges & np.asarray(joints.motor_on)).any()),
        thrusters=bool(thrusters.any()),
    )


def _world_of(subject: "Level | Scene | World", capacity: Capacity | None) -> World:
    if isinstance(subject, World):
        return subject
    if isinstance(subject, Scene):
        return subject.world
    spec = SceneSpec(capacity=capacity or capacity_of(subject))
    return compile_level(subject, spec=spec).world


def features_union(features: Iterable[Features], capacity: Capacity) -> Features:
    """Return the least features that cover several scenes of one capacity."""
    every = list(features)
    listed = [each.pairs for each in every]
    pairs = None
    if None not in listed:
        wanted = {pair for each in listed if each for pair in each}
        ordered = ((min(a, b), max(a, b)) for a, b in candidate_pairs(capacity).tolist())
        pairs = tuple(pair for pair in ordered if pair in wanted)
    filled = [each.used for each in every]
    used = None if None in filled else functools.reduce(Used.union, filter(None, filled))
    names = [
        field.name for field in dataclasses.fields(Features) if field.name not in ("pairs", "used")
    ]
    return Features(
        pairs=pairs,
        used=used,
        **{name: any(getattr(each, name) for each in every) for name in names},
    )
