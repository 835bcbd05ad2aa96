"""Episodes that begin on the way of a win: what is near the goal is learnt first."""

import dataclasses
from collections.abc import Sequence
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from kinetix.environment.env import KinetixEnv, ResetFunction
from kinetix.environment.reset import level_state
from kinetix.environment.search.search import solve_level, solving_env
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.model import Level
from kinetix.level.sets import SetLevel
from kinetix.training.imitation.lessons import NothingWonError, played_again, state_at
from kinetix.training.imitation.sources import Demonstration

SECONDS: Final = 60.0
"""Time for which a win is searched for where none is recorded, or the recorded one wins no more."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Starts:
    """Moments on the way of wins."""

    moments: EnvState
    """On one axis."""
    odds: Float[np.ndarray, " n"]
    """Probability of each moment; those of a level add up to its share of the weights."""
    without: tuple[str, ...]
    """Levels without moments: their win was lost when it was played again."""


def starts_on_the_way(levels: Sequence[SetLevel], env: KinetixEnv) -> Starts:
    """Return the moments of a win of each level.

    Args:
        levels: Levels; the recorded solution shows the way, else one is searched for.
        env: Where they are played.

    Raises:
        KinetixError: No win of a level was found, or all were lost when they were played again.
    """
    wins = [_win(each.level, env) for each in levels]
    try:
        played = played_again(env, wins, gamma=1.0)
    except NothingWonError:
        raise KinetixError(
            f"{', '.join(each.name for each in levels)}: no win that was found is one when it is "
            "played again; set demo_starts = 0"
        ) from None
    moments = state_at(played.lessons, jnp.arange(played.lessons.count))
    lost = set(played.lost)
    weights = [each.weight for index, each in enumerate(levels) if index not in lost]
    episode = np.asarray(played.lessons.episode)
    odds = (np.array(weights) / np.bincount(episode))[episode]
    return Starts(
        moments=jax.tree.map(np.asarray, moments),
        odds=odds / odds.sum(),
        without=tuple(levels[index].name for index in played.lost),
    )


def _win(level: Level, env: KinetixEnv) -> Demonstration:
    static = env.static_env_params
    state = jax.tree.map(np.asarray, level_state(level, static))
    solution = level.solution
    if solution is not None and solution.frame_skip == static.frame_skip:
        recorded = _demonstration(state, list(solution.unrolled()))
        try:
            played_again(env, [recorded], gamma=1.0)
        except NothingWonError:
            pass  # another one is searched for
        else:
            return recorded
    physics = str(static.physics)
    found = solve_level(
        level,
        physics=physics,
        seconds=SECONDS,
        env=solving_env([level], physics=physics, frame_skip=static.frame_skip),
    )
    if found is None:
        raise KinetixError(
            f"{level.name}: no win was found in {SECONDS:g} s to begin episodes from; record a "
            "solution in the level, or set demo_starts = 0"
        )
    return _demonstration(state, list(found.unrolled()))


def _demonstration(state: EnvState, actions: Sequence[Sequence[int]]) -> Demonstration:
    return Demonstration(state=state, actions=np.array(actions, np.int8).reshape(-1, 6))


def beginning_on_the_way(reset_fn: ResetFunction, starts: Starts, share: float) -> ResetFunction:
    """Return a reset function of which a share of the episodes begins at one of some moments.

    Args:
        reset_fn: Where the others begin.
        starts: The moments.
        share: 0 … 1.
    """
    up_to = np.cumsum(starts.odds)[:-1].astype(np.float32)

    def reset(key: Array) -> EnvState:
        level_key, row_key, share_key = jax.random.split(key, 3)
        usual = reset_fn(level_key)
        row = jnp.searchsorted(jnp.asarray(up_to), jax.random.uniform(row_key), side="right")
        on_the_way = jax.random.uniform(share_key) < share
        return jax.tree.map(
            lambda x, y: jnp.where(on_the_way, jnp.asarray(x)[row], y), starts.moments, usual
        )

    return reset
