"""Episodes that begin on the way of a win: what is near the goal is learnt first."""

from collections.abc import Sequence
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from kinetix.environment.env import KinetixEnv, ResetFunction
from kinetix.environment.reset import level_state
from kinetix.environment.search import solve_level
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.model import Level
from kinetix.level.sets import SetLevel
from kinetix.training.imitation.lessons import played_again, state_at
from kinetix.training.imitation.sources import Demonstration

SECONDS: Final = 60.0
"""Time for which a win is searched for where none is recorded, or the recorded one wins no more."""


def starts_on_the_way(levels: Sequence[SetLevel], env: KinetixEnv) -> EnvState:
    """Return the moments of a win of each level, on one axis.

    Args:
        levels: Levels; the recorded solution shows the way, else one is searched for.
        env: Where they are played.

    Raises:
        KinetixError: No win of a level was found.
    """
    episodes = [_win(each.level, env) for each in levels]
    lessons = played_again(env, episodes, gamma=1.0).lessons
    moments = state_at(lessons, jnp.arange(lessons.count))
    return jax.tree.map(np.asarray, moments)


def _win(level: Level, env: KinetixEnv) -> Demonstration:
    static = env.static_env_params
    state = jax.tree.map(np.asarray, level_state(level, static))
    solution = level.solution
    if solution is not None and solution.frame_skip == static.frame_skip:
        recorded = _demonstration(state, list(solution.unrolled()))
        try:
            played_again(env, [recorded], gamma=1.0)
        except KinetixError:
            pass  # It wins no more here: another one is searched for.
        else:
            return recorded
    found = solve_level(level, physics=str(static.physics), seconds=SECONDS)
    if found is None:
        raise KinetixError(
            f"{level.name}: no win was found in {SECONDS:g} s to begin episodes from; record a "
            "solution in the level, or set demo_starts = 0"
        )
    return _demonstration(state, list(found.unrolled()))


def _demonstration(state: EnvState, actions: Sequence[Sequence[int]]) -> Demonstration:
    return Demonstration(state=state, actions=np.array(actions, np.int8).reshape(-1, 6))


def beginning_on_the_way(reset_fn: ResetFunction, moments: EnvState, share: float) -> ResetFunction:
    """Return a reset function of which a share of the episodes begins at one of some moments.

    Args:
        reset_fn: Where the others begin.
        moments: States on one axis, all equally likely.
        share: 0 … 1.
    """
    count = moments.timestep.shape[0]

    def reset(key: Array) -> EnvState:
        level_key, row_key, share_key = jax.random.split(key, 3)
        usual = reset_fn(level_key)
        row = jax.random.randint(row_key, (), 0, count)
        on_the_way = jax.random.uniform(share_key) < share
        return jax.tree.map(
            lambda x, y: jnp.where(on_the_way, jnp.asarray(x)[row], y), moments, usual
        )

    return reset
