"""Counts of how often a policy solves each of many levels."""

from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.normalisation import Normalisation
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree
from kinetix.training.ppo.rollout import Game, Playing, act, begin

MOST_EPISODES: Final = 50
"""Episodes per level that count; later ones add little."""
SOLVED_BONUS: Final = 0.001
"""Weight of the success rate in the score; prefers, of two equals, the one that is solved more."""


@pytree
class Tally:
    """Counts by level."""

    episodes: Int[Array, " n"]
    """Episodes that ended."""
    solved: Int[Array, " n"]
    """Those that reached the goal."""


def count_ends(
    tally: Tally,
    done: Bool[Array, " n"],
    solved: Bool[Array, " n"],
    *,
    most: int = MOST_EPISODES,
) -> Tally:
    """Take in one step.

    Args:
        tally: Counts so far.
        done: Which episodes ended in this step.
        solved: Which reached the goal.
        most: How many episodes of a level count at all.
    """
    counts = done & (tally.episodes < most)
    return Tally(episodes=tally.episodes + counts, solved=tally.solved + (counts & solved))


def play_tally(
    game: Game,
    params: Any,
    levels: EnvState,
    key: Array,
    length: int,
    *,
    statistics: Normalisation | None = None,
    episodes: int | None = None,
) -> Tally:
    """Play levels, each again whenever it is over.

    Args:
        game: Environment and network.
        params: Variables of the network.
        levels: The levels, on the first axis.
        key: Random key.
        length: Environment steps; with `episodes`, of each round.
        statistics: Normalise observations by these.
        episodes: Play so many rounds from the start and count the first episode of each only.
    """
    count = levels.timestep.shape[0]
    nothing = Tally(episodes=jnp.zeros(count, jnp.int32), solved=jnp.zeros(count, jnp.int32))

    most = MOST_EPISODES if episodes is None else 1

    def step(carry: tuple[Playing, Tally], key: Array) -> tuple[tuple[Playing, Tally], None]:
        playing, tally = carry
        playing, done, solved = act(
            game, params, playing, key, levels=levels, statistics=statistics
        )
        return (playing, count_ends(tally, done, solved, most=most)), None

    def play(total: Tally, key: Array) -> tuple[Tally, None]:
        begin_key, step_key = jax.random.split(key)
        playing = begin(game, begin_key, count, levels)
        keys = jax.random.split(step_key, length)
        (_, tally), _ = jax.lax.scan(step, (playing, nothing), keys)
        return jax.tree.map(jnp.add, total, tally), None

    return jax.lax.scan(play, nothing, jax.random.split(key, episodes or 1))[0]


def learnability(tally: Tally, *, correction: bool) -> Float[Array, " n"]:
    """p(1 − p), largest for levels that are solved half of the time.

    Args:
        tally: The counts.
        correction: Times n/(n + 1) for n episodes, so that few episodes count less.

    Source: Rutherford et al., "No Regrets: Investigating and Improving Regret Approximations for
    Curriculum Discovery" (2024).
    """
    n = tally.episodes.astype(jnp.float32)
    p = tally.solved / jnp.maximum(n, 1.0)
    score = p * (1.0 - p)
    return score * n / (n + 1.0) if correction else score


def sfl_score(tally: Tally, *, correction: bool) -> Float[Array, " n"]:
    """Return the score by which SFL keeps levels: learnability and a little success rate."""
    p = tally.solved / jnp.maximum(tally.episodes, 1)
    return learnability(tally, correction=correction) + SOLVED_BONUS * p
