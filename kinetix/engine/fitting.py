"""A step of only the slots that a scene fills, in a state with all of them. One world.

Cost grows with the capacity, so a level that fills 7 of 16 bodies and no joint steps several times
as fast in a step of its own size. The state keeps the capacity of its size: observation, rendering
and editing code is unaffected.
"""

import dataclasses
import functools
from collections.abc import Sequence
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int, Shaped

from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.shapes import rows
from kinetix.engine.spec import Capacity, SceneSpec, Used
from kinetix.engine.types import Bodies, Control, State, World

T = TypeVar("T")

_MOVING = ("position", "rotation", "velocity", "angular_velocity")


@functools.cache
def fitted(spec: SceneSpec) -> SceneSpec:
    """Return the scene with its used slots alone: what the solver is compiled for."""
    used, pairs = spec.features.used, spec.features.pairs
    if used is None:
        return spec
    polygons = sum(body < spec.capacity.polygons for body in used.bodies)
    capacity = Capacity(
        polygons=polygons,
        circles=len(used.bodies) - polygons,
        joints=len(used.joints),
        thrusters=len(used.thrusters),
    )
    if pairs is not None:
        number = {body: index for index, body in enumerate(used.bodies)}
        pairs = tuple((number[a], number[b]) for a, b in pairs)
    features = dataclasses.replace(spec.features, pairs=pairs, used=None)
    return SceneSpec(capacity=capacity, features=features)


def narrow(
    world: World, state: State, control: Control, spec: SceneSpec
) -> tuple[World, State, Control]:
    """Return the used slots alone, with bodies renumbered.

    The state's cache is that of the fitted scene already; which pairs touched is not carried over,
    as no step reads it.
    """
    used, capacity = _used(spec), fitted(spec).capacity
    joints, thrusters = _of(world.joints, used.joints), _of(world.thrusters, used.thrusters)
    narrowed = World(
        bodies=_narrow_bodies(world.bodies, spec),
        joints=dataclasses.replace(
            joints,
            body_a=_renumbered(joints.body_a, used),
            body_b=_renumbered(joints.body_b, used),
        ),
        thrusters=dataclasses.replace(thrusters, body=_renumbered(thrusters.body, used)),
        gravity=world.gravity,
        collides=_of(_of(world.collides, used.bodies).T, used.bodies).T,
    )
    moving = {name: _of(getattr(state, name), used.bodies) for name in _MOVING}
    untouched = jnp.zeros(len(candidate_pairs(capacity)), bool)
    return (
        narrowed,
        dataclasses.replace(state, **moving, touching=untouched),
        Control(
            motor=_of(control.motor, used.joints), thruster=_of(control.thruster, used.thrusters)
        ),
    )


def widen(before: State, after: State, spec: SceneSpec) -> State:
    """Return the state of all slots after a step of the used ones; the others stay as they were."""
    used = _used(spec)
    bodies = np.full(spec.capacity.bodies, -1, np.int32)
    bodies[list(used.bodies)] = np.arange(len(used.bodies))
    moved = {
        name: _of(
            jnp.concatenate([getattr(after, name), getattr(before, name)]),
            np.where(bodies >= 0, bodies, len(used.bodies) + np.arange(len(bodies))),
        )
        for name in _MOVING
    }
    pairs = [(used.bodies[a], used.bodies[b]) for a, b in candidate_pairs(fitted(spec).capacity)]
    number = {pair: index for index, pair in enumerate(pairs)}
    wide = [number.get((a, b), len(pairs)) for a, b in candidate_pairs(spec.capacity).tolist()]
    touching = _of(jnp.concatenate([after.touching, jnp.zeros(1, bool)]), wide)
    return dataclasses.replace(after, **moved, touching=touching)


def _narrow_bodies(bodies: Bodies, spec: SceneSpec) -> Bodies:
    used, polygons = _used(spec), spec.capacity.polygons
    of_polygons = [body for body in used.bodies if body < polygons]
    of_circles = [body - polygons for body in used.bodies if body >= polygons]
    kept = {"vertices": of_polygons, "vertex_count": of_polygons, "radius": of_circles}
    names = [field.name for field in dataclasses.fields(Bodies)]
    return Bodies(
        **{name: _of(getattr(bodies, name), kept.get(name, used.bodies)) for name in names}
    )


def _used(spec: SceneSpec) -> Used:
    assert spec.features.used is not None
    return spec.features.used


def _of(tree: T, slots: Sequence[int] | Int[np.ndarray, " k"]) -> T:
    """Return some rows of every array."""
    index = np.array(slots, np.int32)

    def pick(x: Shaped[Array, "rows ..."]) -> Shaped[Array, "k ..."]:
        if len(index) == len(x) and (index == np.arange(len(x))).all():
            return x
        return rows(jnp.asarray(x), index)

    return jax.tree.map(pick, tree)


def _renumbered(body: Int[Array, " k"], used: Used) -> Int[Array, " k"]:
    """Return indices of bodies among the used ones; 0 in slots that this level leaves empty."""
    same: Bool[Array, "k b"] = body[:, None] == np.array(used.bodies, np.int32)
    return jnp.sum(jnp.where(same, np.arange(len(used.bodies), dtype=np.int32), 0), axis=1)
