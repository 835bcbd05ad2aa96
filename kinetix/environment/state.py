"""The state of an environment: a composition of the level, the physics and the clock."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.engine.types import State, World
from kinetix.environment.kinetix_env.fields import FieldsOfKinetixEnv
from kinetix.environment.kinetix_env.rewrite import own_changes
from kinetix.errors import KinetixError
from kinetix.level.compile import Labels, Scene
from kinetix.level.model import Level, Polygon
from kinetix.pytree import on_device, pytree

NO_DISTANCE = -1.0
"""`EnvState.last_distance` before the first step of an episode."""


@pytree
class BodiesView:
    """All bodies of a state in global order: polygons first, then circles."""

    position: Float[Array, "b 2"]
    """Centres of mass [m]."""
    rotation: Float[Array, " b"]
    """Angles [rad]."""
    velocity: Float[Array, "b 2"]
    """Velocities of the bodies [m/s]."""
    angular_velocity: Float[Array, " b"]
    """Angular velocities of the bodies [rad/s]."""
    active: Bool[Array, " b"]
    """True where the slot holds a body."""


@pytree
class EnvState(FieldsOfKinetixEnv):
    """Result of `reset`, advanced by `step`; values at a reset are used as they are."""

    world: World
    """Constants of the level."""
    physics: State
    """Quantities that a physics step changes."""
    labels: Labels
    """Properties of the level that the engine does not need: roles, bindings, time limit."""
    timestep: Int[Array, ""]
    """Environment steps since the reset."""
    last_distance: Float[Array, ""]
    """Green-to-blue distance after the last step [m], −1 before the first one."""

    def __repr__(self) -> str:
        """Sizes and batch; the arrays are many."""
        batch = jnp.shape(self.timestep)
        of = f", batch {batch}" if batch else ""
        bodies = self.world.bodies
        sizes = {
            "polygons": jnp.shape(bodies.vertex_count),
            "circles": jnp.shape(bodies.radius),
            "joints": jnp.shape(self.world.joints.active),
            "thrusters": jnp.shape(self.world.thrusters.active),
        }
        slots = ", ".join(f"{shape[-1]} {name}" for name, shape in sizes.items())
        return f"<EnvState: slots for {slots}{of}>"

    def replace(self, **changes: Any) -> "EnvState":
        """Return the state with other values, also by kinetix-env's names of its fields.

        Args:
            **changes: New values: `gravity=…`, `polygon=state.polygon.replace(friction=…)`.

        Raises:
            KinetixError: The state has no such field.
        """
        return dataclasses.replace(self, **own_changes(self, changes))

    @property
    def bodies(self) -> BodiesView:
        """Positions, velocities and activity of all bodies, polygons first."""
        return BodiesView(
            position=self.physics.position,
            rotation=self.physics.rotation,
            velocity=self.physics.velocity,
            angular_velocity=self.physics.angular_velocity,
            active=self.world.bodies.active,
        )


StepResult = tuple[Any, EnvState, Float[Array, ""], Bool[Array, ""], dict[str, Any]]
"""Observation, state, reward, done, info."""


def state_of(scene: Scene) -> EnvState:
    """Return the state in which an episode of a compiled level starts."""
    none_yet: Any = np.zeros((), np.int32)
    unknown: Any = np.full((), NO_DISTANCE, np.float32)
    return EnvState(
        world=scene.world,
        physics=scene.state,
        labels=scene.labels,
        timestep=none_yet,
        last_distance=unknown,
    )


def without_contacts(physics: State) -> State:
    """Return the same bodies with no memory of contacts and impulses, as right after a reset."""
    return dataclasses.replace(
        physics,
        touching=jnp.zeros_like(physics.touching),
        overflow=jnp.zeros_like(physics.overflow),
        cache=jax.tree.map(jnp.zeros_like, physics.cache),
    )


def stack_states(states: list[EnvState]) -> Any:
    """Return states of equal capacity as one state with a leading axis of levels.

    By numpy: JAX would compile a program for every array, of a thousand levels for minutes.

    Raises:
        KinetixError: No state is given, or the states are of several sizes.
    """
    shapes = {tuple(np.shape(x) for x in jax.tree.leaves(state)) for state in states}
    if len(shapes) != 1:
        wrong = "states of several sizes" if shapes else "none"
        raise KinetixError(
            f"expected states of one size to stack, got {wrong} "
            "(kinetix.environment.rearrange.expand_state makes a state larger)"
        )
    return on_device(
        jax.tree.map(lambda *leaves: np.stack([np.asarray(x) for x in leaves]), *states)
    )


def document_slots(state: EnvState, level: Level, capacity: Capacity) -> Int[np.ndarray, " b"]:
    """Return where the bodies of a document are in a state that came from its file.

    A kinetix-env file may leave slots empty; reading it as a document closes the gaps and keeps
    the order of each kind.

    Args:
        state: The state.
        level: The document.
        capacity: The state's sizes.
    """
    active = np.asarray(state.world.bodies.active)
    polygons = [k for k in range(ARENA_BODIES, capacity.polygons) if active[k]]
    circles = [k for k in range(capacity.polygons, capacity.bodies) if active[k]]
    slots = []
    for body in level.bodies:
        slots.append((polygons if isinstance(body.shape, Polygon) else circles).pop(0))
    return np.array(slots, np.int32)
