"""Recorded solutions and fixed actions, played again on their level."""

from collections.abc import Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.presets import solver_named
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.episode import Episode, play_episode, play_until
from kinetix.environment.outcome import Outcome
from kinetix.environment.params import (
    LEVEL_FRAME_SKIP,
    EnvParams,
    StaticEnvParams,
    static_env_params_of,
)
from kinetix.environment.reset import level_state
from kinetix.environment.spaces import ActionType, ObservationType
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of

_ROWS: Final = 512
"""Actions are padded to a multiple of this, so that solutions of any length share compilations."""


def replay_solution(level: Level, physics: str | None = None) -> Outcome:
    """Return how a level's recorded solution ends; see `play_solution`."""
    return play_solution(level, physics).outcome


def play_solution(level: Level, physics: str | None = None) -> Episode:
    """Play a level's recorded solution.

    Args:
        level: A level with a solution.
        physics: Physics preset; by default the one that the solution names.

    Returns:
        The episode as it stands when it ends or the actions run out (a time-out).

    Raises:
        KinetixError: The level has no solution, or its physics preset does not exist.
    """
    solution = level.solution
    if solution is None:
        raise KinetixError(f"level {level.name!r} has no recorded solution")
    physics = physics or solution_physics(level, f"level {level.name!r}")
    return play_actions(
        level,
        list(solution.unrolled()),
        physics=physics,
        frame_skip=solution.frame_skip,
    )


def noop_outcome(level: Level, physics: str = DEFAULT_PHYSICS) -> Outcome:
    """Return how a level ends when nothing is done; a level that wins itself is no task.

    Raises:
        KinetixError: The physics preset does not exist.
    """
    env, start = _stage(level, physics, LEVEL_FRAME_SKIP)
    steps = max(level.max_timesteps, 1)
    # Without a row of its own for each step it plays in the program that short solutions have.
    return play_episode(env, start, next_row, limit=steps, **recorded_rows(())).outcome


def solution_physics(level: Level, name: str) -> str:
    """Return the physics that a level's recorded solution names.

    Args:
        level: A level with a solution.
        name: Its file, for the message.

    Raises:
        KinetixError: The level has no solution, or its physics do not exist.
    """
    if level.solution is None:
        raise KinetixError(f"{name}: this level records no solution")
    try:
        solver_named(level.solution.physics)
    except KinetixError as error:
        raise KinetixError(f"{name}: $.solution.physics: {error}") from None
    return level.solution.physics


def play_actions(
    level: Level,
    actions: Sequence[Sequence[int]],
    *,
    physics: str = DEFAULT_PHYSICS,
    frame_skip: int = LEVEL_FRAME_SKIP,
) -> Episode:
    """Play multi-discrete actions from a level's start, until the episode ends or they run out.

    Raises:
        KinetixError: The physics preset does not exist.
    """
    env, start = _stage(level, physics, frame_skip)
    return play_episode(env, start, next_row, limit=len(actions), **recorded_rows(actions))


def state_after(
    level: Level,
    actions: Sequence[Sequence[int]],
    *,
    physics: str = DEFAULT_PHYSICS,
    frame_skip: int = LEVEL_FRAME_SKIP,
) -> EnvState | None:
    """Return the state in which `play_actions` leaves a level; None where the episode is over.

    Args:
        level: The level.
        actions: Multi-discrete, one per environment step.
        physics: Preset or solver.
        frame_skip: Engine steps per environment step.

    Raises:
        KinetixError: The physics preset does not exist.
    """
    env, start = _stage(level, physics, frame_skip)
    end = play_until(env, start, next_row, limit=len(actions), **recorded_rows(actions))
    return end.state if end.outcome is None else None


def _stage(level: Level, physics: str, frame_skip: int) -> tuple[KinetixEnv, EnvState]:
    """Return the environment that all levels of the size share, and the level's first state."""
    static = static_env_params_of(capacity_of(level), frame_skip=frame_skip, physics=physics)
    return playing_env(static), level_state(level, static)


def playing_env(
    static: StaticEnvParams,
    env_params: EnvParams | None = None,
    actions: ActionType = ActionType.MULTI_DISCRETE,
) -> KinetixEnv:
    """Return an environment that plays given actions: it observes nothing, and episodes end in it.

    Args:
        static: Sizes, physics and frame skip.
        env_params: Parameters that need no compilation.
        actions: Kind of the actions.

    Raises:
        KinetixError: The physics preset does not exist.
    """
    env = make_kinetix_env(
        actions, ObservationType.BLIND, None, env_params, static, auto_reset=False
    )
    assert isinstance(env, KinetixEnv)
    return env


def recorded_rows(actions: Sequence[Sequence[int]]) -> dict[str, Any]:
    """Return `params` and `carry` with which `next_row` plays multi-discrete actions, then none."""
    count = len(actions)
    rows = np.zeros(((count // _ROWS + 1) * _ROWS, 6), np.int32)
    rows[:count] = np.asarray(actions, np.int32).reshape(count, 6)
    return {"params": jnp.asarray(rows), "carry": jnp.int32(0)}


def next_row(
    rows: Array, index: Array, observation: Any, keys: Array, begins: Array
) -> tuple[Array, Array, dict[str, Any]]:
    """Return the recorded action of the step, whatever is observed; see `episode.Decide`."""
    return jax.lax.dynamic_slice_in_dim(rows, index, 1), index + 1, {}
