"""Kernels of a step for many worlds at once, each made once for all environments that share it.

Environments that differ only in how episodes start play and observe alike: training and evaluation,
say. The kernels that do so are cached by value, so that each is traced once in a process.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, Final

import jax
from jaxtyping import Array, Int

from kinetix.engine.batch import worlds_last
from kinetix.engine.solvers.room import worlds_at_once
from kinetix.environment.actions import AbstractAction
from kinetix.environment.advance import advance
from kinetix.environment.observations import AbstractObservation
from kinetix.environment.params import EnvParams, StaticEnvParams, physics_engine
from kinetix.environment.state import EnvState

_KEPT: Final = 64
"""Kernels that are kept; a longer search through kinds of environments lets the oldest go."""


@functools.lru_cache(_KEPT)
def observing(observations: AbstractObservation) -> Callable[[EnvState], Any]:
    """Return the observation of a state as a function of one world to `vmap`.

    Args:
        observations: The kind of observation.
    """
    if not observations.worlds_last:
        return observations
    many = jax.vmap(observations, in_axes=-1, out_axes=-1)
    return worlds_last(many, made_of=("observation", observations))


@functools.lru_cache(_KEPT)
def playing(
    actions: AbstractAction, observations: AbstractObservation, static: StaticEnvParams
) -> Callable[[EnvState, Any, EnvParams], tuple[Any, ...]]:
    """Return step and observation as a function of one world to `vmap`.

    Args:
        actions: The kind of action.
        observations: The kind of observation.
        static: Sizes, physics, physics steps of an action, and which touches count.

    Returns:
        A function of state, action and parameters to what the step changed in the state, the
        observation, reward, done and info.
    """

    def play(state: EnvState, action: Any, params: EnvParams) -> tuple[Any, ...]:
        return advance(state, actions.process_action(action, state.labels), params, static=static)

    def observed(state: EnvState, played: dict[str, Any]) -> Any:
        return observations(dataclasses.replace(state, **played))

    def both(state: EnvState, action: Any, params: EnvParams) -> tuple[Any, ...]:
        played, *rest = play(state, action, params)
        return played, observed(state, played), *rest

    if observations.worlds_last:
        return _by_tiles(both, static, ("step, observation", actions, observations, static))
    played_by_tiles = _by_tiles(play, static, ("step", actions, static))

    def apart(state: EnvState, action: Any, params: EnvParams) -> tuple[Any, ...]:
        played, *rest = played_by_tiles(state, action, params)
        return played, observed(state, played), *rest

    return apart


def _by_tiles(
    one: Callable[..., Any], static: StaticEnvParams, made_of: tuple[Any, ...]
) -> Callable[..., Any]:
    engine = physics_engine(static)

    def effort(state: EnvState, action: Any, params: EnvParams) -> Int[Array, " n"]:
        """Estimate the work that the next step of each world takes."""
        del action, params
        return engine.solver.effort(state.world, state.physics)

    many = jax.vmap(one, in_axes=-1, out_axes=-1)
    return worlds_last(many, effort, tile=worlds_at_once(engine.spec), made_of=made_of)
