"""Observations of a moment: the picture, and the numbers with the names of columns."""

import functools
from typing import Any

import jax
import numpy as np

from editor.base.wording import describe
from editor.worker.requests import AgentView, Observe, ViewTable
from editor.worker.simulation.cast import player_of
from editor.worker.simulation.stepping import without_memory
from kinetix.agents.environments import capacity_for, environment_for
from kinetix.agents.from_card import observations_of_card
from kinetix.engine.spec import ARENA_BODIES, Capacity
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.observations import AbstractObservation
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.level.model import ARENA_NAMES, Circle, Level, Polygon
from kinetix.level.sizes import capacity_of
from kinetix.pytree import on_device
from kinetix.render.pixels import make_render_pixels_rl

_MASKS = {
    "circles": "circle_mask",
    "polygons": "polygon_mask",
    "joints": "joint_mask",
    "thrusters": "thruster_mask",
}
_LONGEST = 4096
"""Numbers of a flat observation that are shown at most."""


@functools.lru_cache(maxsize=8)
def _picture(capacity: Capacity) -> Any:
    return jax.jit(make_render_pixels_rl(EnvParams(), static_env_params_of(capacity)))


@functools.partial(jax.jit, static_argnums=0)
def _seen(observations: AbstractObservation, state: EnvState) -> Any:
    return observations(state)


def observe(request: Observe) -> AgentView:
    """Return the picture and the tables of a moment; see `Observe`.

    Raises:
        KinetixError: The agent cannot be loaded or cannot play the level.
    """
    level = request.level
    capacity, env = _environment(request)
    state = request.state
    if state is None:
        state = level_state(level, env.static_env_params)
    state = on_device(without_memory(state))
    picture = np.asarray(_picture(capacity)(state))
    pixels = np.clip(picture.transpose(1, 0, 2)[::-1] * 255.0, 0, 255).astype(np.uint8)
    observation = env.observations
    return AgentView(
        pixels=np.ascontiguousarray(pixels),
        observation=observation.name,
        tables=tuple(_tables(observation, jax.device_get(_seen(observation, state)), level)),
    )


def _environment(request: Observe) -> tuple[Capacity, KinetixEnv]:
    capacity = capacity_of(request.level)
    if request.agent is not None:
        player = player_of(request.agent)
        if "params" in player.params:  # it has a network
            capacity = capacity_for(player.card, capacity, level=repr(request.level.name))
            physics = player.card.environment.physics
            env = environment_for(player, capacity, physics=physics)
            static = env.static_env_params
            observations = observations_of_card(player.card, env.env_params, static)
            assert observations == env.observations
            return capacity, env
    env = make_kinetix_env(
        env_params=EnvParams(), static_env_params=static_env_params_of(capacity), auto_reset=False
    )
    assert isinstance(env, KinetixEnv)
    return capacity, env


def _tables(observation: AbstractObservation, seen: Any, level: Level) -> list[ViewTable]:
    tables = []
    for name, columns in observation.columns.items():
        values = np.asarray(getattr(seen, name) if hasattr(seen, "_asdict") else seen)
        heads = tuple((c.name, c.unit, c.meaning) for c in columns)
        if name == "image":
            continue
        if values.ndim == 1 and len(values) == len(heads):
            # A flat form reads better downwards: one number a line.
            tables.append(
                ViewTable(
                    name=name or observation.name,
                    columns=(("value", "", ""),),
                    rows=tuple(_head(head) for head in heads[:_LONGEST]),
                    values=values[:_LONGEST, None].astype(np.float32),
                    active=(True,) * min(len(heads), _LONGEST),
                )
            )
        elif values.ndim == 2:
            mask = getattr(seen, _MASKS.get(name, ""), None)
            active = np.ones(len(values), bool) if mask is None else np.asarray(mask, bool)
            tables.append(
                ViewTable(
                    name=name,
                    columns=heads[: values.shape[1]],
                    rows=tuple(_row_names(name, len(values), level)),
                    values=values.astype(np.float32),
                    active=tuple(active.tolist()),
                )
            )
    return tables


def _head(head: tuple[str, str, str]) -> str:
    name, unit, _ = head
    return f"{name} [{unit}]" if unit else name


def _row_names(kind: str, count: int, level: Level) -> list[str]:
    """Return the subjects of the rows; empty slots have their number only."""
    bodies = level.bodies
    names: list[str]
    if kind == "circles":
        names = [describe(level, b.id) for b in bodies if isinstance(b.shape, Circle)]
    elif kind == "polygons":
        polygons = [describe(level, b.id) for b in bodies if isinstance(b.shape, Polygon)]
        names = [*(name.replace("_", " ") for name in ARENA_NAMES[:ARENA_BODIES]), *polygons]
    elif kind == "joints":
        half = count // 2
        own = [describe(level, joint.id) for joint in level.joints]
        own += [f"slot {k}" for k in range(len(own), half)]
        names = [f"{name}, from b" for name in own] + [f"{name}, from a" for name in own]
    elif kind == "thrusters":
        names = [describe(level, thruster.id) for thruster in level.thrusters]
    else:
        names = []
    return [names[k] if k < len(names) else f"slot {k}" for k in range(count)]
