"""Reasons for an agent's action: attention, gradients per entity, the value over places."""

from typing import Any, Final

import jax.numpy as jnp
import numpy as np

from editor.documents.commands.rigid import component
from editor.worker.requests import Explain, Explained
from editor.worker.simulation.cast import player_of
from editor.worker.simulation.stepping import without_memory
from kinetix.agents.environments import capacity_for, environment_for
from kinetix.agents.explain import Situation, attention, saliency, values_over_places
from kinetix.agents.player import Player
from kinetix.environment.env import KinetixEnv
from kinetix.environment.reset import level_state
from kinetix.environment.state import document_slots
from kinetix.errors import KinetixError
from kinetix.level.geometry import ARENA_WIDTH
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of
from kinetix.pytree import on_device

CELLS: Final = 24
"""Places along each side of the arena."""


def explain(request: Explain) -> Explained:
    """Ask a network about a moment; see `Explain`.

    Raises:
        KinetixError: The agent has no network, cannot be loaded, or cannot play the level.
    """
    level, player = request.level, player_of(request.agent)
    if not player.params:
        raise KinetixError(f"{player.card.name} has no network, so nothing can be explained.")
    capacity = capacity_for(player.card, capacity_of(level), level=repr(level.name))
    env = environment_for(player, capacity, physics=request.physics)
    state = request.state
    if state is None:
        state = level_state(level, env.static_env_params)
    state = on_device(without_memory(state))
    begins = request.memory is None
    carry = player.policy.init_carry(1) if begins else request.memory
    moment = Situation(
        state=state,
        carry=on_device(carry),
        begins=jnp.asarray(begins),
    )
    told = saliency(env, player.policy, player.params, moment, request.about)
    shares = attention(env, player.policy, player.params, moment)
    slots = document_slots(state, level, capacity)
    joints = np.flatnonzero(np.asarray(state.world.joints.active))
    thrusters = np.flatnonzero(np.asarray(state.world.thrusters.active))
    cell = ARENA_WIDTH / CELLS
    value, places = _places(env, player, moment, slots, request, cell)
    return Explained(
        attention=None if shares is None else np.asarray(shares)[slots],
        bodies=np.asarray(told.bodies)[slots],
        joints=np.asarray(told.joints)[joints],
        thrusters=np.asarray(told.thrusters)[thrusters],
        value=value,
        body=request.body if places is not None else None,
        places=places,
        cell=cell,
    )


def _places(
    env: KinetixEnv,
    player: Player,
    moment: Situation,
    slots: np.ndarray,
    request: Explain,
    cell: float,
) -> tuple[float, np.ndarray | None]:
    """Return the value as things are, and with the asked body and its joined bodies elsewhere."""
    level = request.level
    held = next((k for k, body in enumerate(level.bodies) if body.id == request.body), None)
    moved = _moved(moment, slots, level, request.body)
    shifts = np.zeros((1 + CELLS * CELLS, 2), np.float32)
    if held is not None:
        middle = (np.arange(CELLS) + 0.5) * cell
        x, y = np.meshgrid(middle, middle)
        here = np.asarray(moment.state.physics.position)[slots[held]]
        shifts[1:] = np.stack([x.ravel(), y.ravel()], axis=1) - here
    else:
        shifts = shifts[:1]
    told = values_over_places(
        env, player.policy, player.params, moment, jnp.asarray(moved), jnp.asarray(shifts)
    )
    values = np.asarray(told)
    if held is None:
        return float(values[0]), None
    return float(values[0]), values[1:].reshape(CELLS, CELLS)


def _moved(moment: Situation, slots: np.ndarray, level: Level, body: int | None) -> Any:
    """Return the body and what is jointed to it, slots of the state."""
    moved = np.zeros(np.asarray(moment.state.world.bodies.active).shape, bool)
    if body is not None:
        together = component(level, (body,))
        rows = [k for k, one in enumerate(level.bodies) if one.id in together]
        moved[slots[rows]] = True
    return moved
