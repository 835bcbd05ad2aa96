"""Changes of a state by kinetix-env's names of its fields: `state.replace(polygon=…)`."""

import dataclasses
import difflib
from collections.abc import Mapping
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

from kinetix.engine.types import Bodies, Joints, Thrusters, World
from kinetix.environment.kinetix_env.fields import (
    CONSTANTS,
    JOINTS,
    MOTION,
    THRUSTERS,
    JointFields,
    RigidBodies,
    ThrusterFields,
)
from kinetix.errors import KinetixError

OWN: Final = ("world", "physics", "labels", "timestep", "last_distance")
"""Fields that a state has itself."""
_LABELS: Final = {
    "thruster_bindings": "thruster_binding",
    "motor_bindings": "motor_binding",
    "motor_auto": "motor_auto",
}
_HALVES: Final = {
    "role": ("polygon_shape_roles", "circle_shape_roles"),
    "density": ("polygon_densities", "circle_densities"),
}
_SELECTED: Final = ("polygon_highlighted", "circle_highlighted")
NAMES: Final = frozenset(
    (
        *OWN,
        *("polygon", "circle", "joint", "thruster", "collision_matrix", "gravity"),
        *_LABELS,
        *(name for pair in _HALVES.values() for name in pair),
        *_SELECTED,
    )
)
"""Everything that `EnvState.replace` takes."""


def own_changes(state: Any, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the changes of a state's own fields that some changes by either set of names ask for.

    Positions of joints and thrusters in the world follow from the bodies, and what is selected is
    the editor's: both are left out. Which bodies collide follows from the joints unless it is
    given.

    Args:
        state: An `EnvState`, single or a batch.
        changes: New values by names of `NAMES`.

    Raises:
        KinetixError: The state has no such field, or a value has another form than the field.
    """
    for name in changes:
        if name not in NAMES:
            near = difflib.get_close_matches(name, NAMES, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"expected {', '.join(sorted(NAMES))}"
            if name == "bodies":
                hint = (
                    "bodies are read there and changed in two parts, polygon and circle: "
                    "state.replace(circle=state.circle.replace(position=…))"
                )
            raise KinetixError(f"EnvState has no field {name!r}: {hint}")
    changes = {
        name: value if name in OWN else _fitting(state, name, value)
        for name, value in changes.items()
    }
    made = {name: value for name, value in changes.items() if name in OWN}
    if "polygon" in changes or "circle" in changes:
        polygons = changes.get("polygon", state.polygon)
        circles = changes.get("circle", state.circle)
        made["physics"] = dataclasses.replace(
            made.get("physics", state.physics), **_both(MOTION, polygons, circles)
        )
    world = _world(state, made.get("world", state.world), changes)
    if world is not state.world:
        made["world"] = world
    labels = {_LABELS[name]: value for name, value in changes.items() if name in _LABELS}
    for field, (first, second) in _HALVES.items():
        if first in changes or second in changes:
            halves = (changes.get(name, getattr(state, name)) for name in (first, second))
            labels[field] = jnp.concatenate([jnp.asarray(half) for half in halves], axis=-1)
    if labels:
        made["labels"] = dataclasses.replace(made.get("labels", state.labels), **labels)
    return made


def _fitting(state: Any, name: str, value: Any) -> Any:
    """Return a new value of a field as arrays of the field's types."""
    field = jax.eval_shape(lambda state: getattr(state, name), state)
    if isinstance(field, jax.ShapeDtypeStruct):
        return _array(name, value, field)
    if type(value) is not type(field):
        given, form = type(value).__name__, type(field).__name__
        raise KinetixError(
            f"{name}: expected {form} as state.{name}.replace(…) returns it, got {given}"
        )
    parts = {
        part.name: _array(
            f"{name}.{part.name}", getattr(value, part.name), getattr(field, part.name)
        )
        for part in dataclasses.fields(field)
    }
    return dataclasses.replace(value, **parts)


def _array(name: str, value: Any, field: jax.ShapeDtypeStruct) -> Array:
    array = jnp.asarray(value)
    if array.shape != field.shape:
        raise KinetixError(f"{name}: expected the shape {field.shape}, got {array.shape}")
    return array.astype(field.dtype)


def _world(state: Any, world: World, changes: Mapping[str, Any]) -> World:
    parts: dict[str, Any] = {}
    if "polygon" in changes or "circle" in changes:
        parts["bodies"] = _bodies(
            world.bodies,
            changes.get("polygon", state.polygon),
            changes.get("circle", state.circle),
        )
    if "joint" in changes:
        parts["joints"] = _joints(world.joints, changes["joint"])
        parts["collides"] = collision_matrix(parts["joints"], world.collides.shape[-1])
    if "thruster" in changes:
        parts["thrusters"] = _thrusters(world.thrusters, changes["thruster"])
    if "gravity" in changes:
        parts["gravity"] = changes["gravity"]
    if "collision_matrix" in changes:
        parts["collides"] = changes["collision_matrix"]
    return dataclasses.replace(world, **parts) if parts else world


def _both(names: tuple[str, ...], polygons: RigidBodies, circles: RigidBodies) -> dict[str, Array]:
    """Return fields of all bodies in global order; points carry one axis more than numbers."""
    batch = jnp.ndim(polygons.active) - 1
    return {
        name: jnp.concatenate(
            [jnp.asarray(getattr(part, name)) for part in (polygons, circles)], axis=batch
        )
        for name in names
    }


def _bodies(bodies: Bodies, polygons: RigidBodies, circles: RigidBodies) -> Bodies:
    return dataclasses.replace(
        bodies,
        **_both(CONSTANTS, polygons, circles),
        vertices=polygons.vertices,
        vertex_count=polygons.n_vertices,
        radius=circles.radius,
    )


def _joints(joints: Joints, fields: JointFields) -> Joints:
    return dataclasses.replace(
        joints, **{ours: getattr(fields, theirs) for ours, theirs in JOINTS.items()}
    )


def _thrusters(thrusters: Thrusters, fields: ThrusterFields) -> Thrusters:
    return dataclasses.replace(
        thrusters, **{ours: getattr(fields, theirs) for ours, theirs in THRUSTERS.items()}
    )


def collision_matrix(joints: Joints, bodies: int) -> Bool[Array, "*n b b"]:
    """Return false inside of a jointed component and on the diagonal; traced, for any batch.

    Args:
        joints: The joints of one level or a batch.
        bodies: How many bodies a level has room for.
    """
    first, second, active = map(jnp.asarray, (joints.body_a, joints.body_b, joints.active))
    component = jnp.broadcast_to(jnp.arange(bodies), (*active.shape[:-1], bodies))
    for joint in range(active.shape[-1]):
        ends = [
            jnp.take_along_axis(component, end[..., joint, None], -1) for end in (first, second)
        ]
        merged = jnp.where(component == ends[1], ends[0], component)
        component = jnp.where(active[..., joint, None], merged, component)
    return component[..., :, None] != component[..., None, :]
