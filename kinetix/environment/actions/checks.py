"""Checks of an action: shape and type while a step is traced, values where they are known."""

from collections.abc import Mapping
from typing import Any

import jax.numpy as jnp
import numpy as np

from kinetix.environment.actions.base import AbstractAction
from kinetix.environment.arguments import NUMBERS, is_array, kind_of
from kinetix.environment.spaces import Box
from kinetix.errors import KinetixError


def check_action(action: Any, actions: AbstractAction) -> None:
    """Refuse an action of another shape or type.

    Raises:
        KinetixError: The action has another shape or type than the space; the message says which.
    """
    space: Any = actions.action_space
    if not is_array(action):
        raise KinetixError(
            f"action: expected an array of shape {space.shape} ({actions.name}), got "
            f"{kind_of(action)}; a list becomes one by jnp.array"
        )
    if jnp.shape(action) != space.shape:
        batch = jnp.shape(action)[1:] == space.shape
        why = (
            "for a batch use jax.vmap(env.step), or gymnasium.make_vec"
            if batch
            else "see env.action_space()"
        )
        raise KinetixError(
            f"action of shape {jnp.shape(action)}: expected {space.shape} ({actions.name}); {why}"
        )
    real = jnp.issubdtype(jnp.result_type(action), jnp.inexact)
    if real and not isinstance(space, Box):
        raise KinetixError(
            f"action of type {jnp.result_type(action).name}: expected integers ({actions.name}); "
            "for reals make the environment with ActionType.CONTINUOUS"
        )


def check_choice(action: Any, actions: AbstractAction, *, batch: bool = False) -> None:
    """Refuse an action whose values mean nothing, where they are known.

    Args:
        action: Of any shape; another one than the space's is left to `check_action`.
        actions: What it is an action of.
        batch: True for an action a world.

    Raises:
        KinetixError: The action holds a choice that does not exist.
    """
    space: Any = actions.action_space
    if isinstance(space, Box):
        return  # reals are clipped, as agents that draw them expect
    chosen = np.asarray(action)
    worlds, shape = chosen.shape[:batch], chosen.shape[batch:]
    if len(worlds) != batch or shape != space.shape or chosen.dtype.kind not in "iu":
        return  # `check_action` reports it
    choices = getattr(space, "number_of_dims_per_distribution", None)
    wrong = (chosen < 0) | (chosen >= np.array(choices or space.n))
    if wrong.any():
        known = f"below {', '.join(map(str, choices))}" if choices else f"up to {space.n - 1}"
        world = np.argwhere(wrong)[0, :batch]
        of = f" of world {world[0]}," if batch else ""
        raise KinetixError(
            f"action{of} {chosen[tuple(world)].tolist()}: expected whole numbers from 0 and "
            f"{known} ({actions.name}); under jit a choice that does not exist drives nothing"
        )


def with_usual_action(
    arguments: tuple[Any, ...], named: Mapping[str, Any]
) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """The arguments of a method, choices of an action as int32: each other type recompiles."""
    if "action" in named:
        return arguments, {**named, "action": _usual(named["action"])}
    if len(arguments) > 2:
        arguments = (*arguments[:2], _usual(arguments[2]), *arguments[3:])
    return arguments, dict(named)


def _usual(action: Any) -> Any:
    if not isinstance(action, NUMBERS) or getattr(action, "dtype", None) == np.int32:
        return action
    array = np.asarray(action)
    return array.astype(np.int32) if array.dtype.kind in "biu" else action
