"""From a state back to a level, for files, pages and the editor."""

import dataclasses
from typing import get_args

import jax.numpy as jnp
import numpy as np
from jax.core import Tracer

from kinetix.environment.checks import check_is_state
from kinetix.environment.params import EnvParams
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.compile import Scene
from kinetix.level.decompile import level_from_scene
from kinetix.level.model import InertiaModel, Level


def level_of(state: EnvState, name: str = "Untitled") -> Level:
    """Return a state as a level, which can be saved, shown and opened in the editor.

    Where the bodies are and how they move becomes the start; `level_state` makes the same state of
    it, but for empty slots, and joints and thrusters of bodies that were switched off. A random
    level's time limit is the usual one, 256 steps.

    Args:
        state: One state, such as `env.reset` or `sample_kinetix_level` return.
        name: The level's title.

    Raises:
        KinetixError: `state` is not a state, is a batch of them, or has no values, within
            `jax.jit`.
        LevelError: The state has something that no level can hold, such as a body that turns but
            does not move.
    """
    if not isinstance(name, str) or not name:
        raise KinetixError(f"name {name!r:.60}: expected a title")
    check_is_state(state, "the order is level_of(state, name)")
    scene = scene_of(state)
    # Masses that follow from shape and density need not be written down.
    models: tuple[InertiaModel, ...] = get_args(InertiaModel)
    levels = [level_from_scene(scene, name=name, inertia_model=model) for model in models]
    return min(levels, key=_own_masses)


def scene_of(state: EnvState, max_timesteps: float | None = None) -> Scene:
    """Return a state's arrays, with a time limit.

    Args:
        state: One state.
        max_timesteps: The time limit where the state has none; None: the usual one.

    Raises:
        KinetixError: `state` is a batch, or has no values.
    """
    if isinstance(state.timestep, Tracer):
        raise KinetixError("state: it has no values within jax.jit or vmap: return it from there")
    if shape := jnp.shape(state.timestep):
        first = ", ".join("0" for _ in shape)
        raise KinetixError(
            f"state: expected one state, got a batch of shape {shape}: "
            f"jax.tree.map(lambda x: x[{first}], states) is the first"
        )
    usual = EnvParams().max_timesteps if max_timesteps is None else max_timesteps
    limit = int(state.labels.max_timesteps) or usual
    labels = dataclasses.replace(state.labels, max_timesteps=np.int32(limit))
    return Scene(world=state.world, state=state.physics, labels=labels)


def _own_masses(level: Level) -> int:
    return sum(body.mass_properties is not None for body in level.bodies)
