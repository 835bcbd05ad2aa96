"""Recorded episodes played again, to check that the controls reproduce them and for their states.

Only controls are kept on disk; observations of any kind can be computed from them.
"""

import dataclasses
import functools
from typing import Any

import jax
import numpy as np
from jaxtyping import Array, Float

from kinetix.datasets.episode import RecordedEpisode
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv
from kinetix.environment.outcome import OUTCOMES, Outcome, outcome_index
from kinetix.environment.params import static_env_params_of
from kinetix.environment.replay import playing_env
from kinetix.environment.reset import level_state
from kinetix.environment.spaces import ActionType
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.sizes import capacity_of
from kinetix.pytree import on_device

_ROWS = 256
"""Steps are padded to a multiple of this, so that episodes of any length share compilations."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class ReplayedEpisode:
    """Result of playing controls again; axis `k` is environment steps."""

    states: EnvState
    """Before each step, numpy arrays with a leading axis `k`."""
    reward: Float[np.ndarray, " k"]
    length: int
    """Steps until the episode ended or the controls ran out."""
    outcome: Outcome

    def ends_as(self, episode: RecordedEpisode) -> bool:
        """True if an episode ends alike after as many steps."""
        return self.length == episode.length and self.outcome == episode.outcome


def replay(episode: RecordedEpisode, capacity: Capacity | None = None) -> ReplayedEpisode:
    """Play an episode's controls from the start of its level.

    Args:
        episode: The episode.
        capacity: Sizes of the states; by default those of the level's own size.

    Returns:
        The state before each step, cut where the episode ends; the last outcome is `timeout` where
        the controls run out first.

    Raises:
        KinetixError: The level does not fit, or the physics does not exist.
    """
    env = _environment(capacity or capacity_of(episode.level), episode.physics, episode.frame_skip)
    count = episode.length
    rows = np.zeros((-(-max(count, 1) // _ROWS) * _ROWS, episode.control.shape[1]), np.float32)
    rows[:count] = episode.control
    state = level_state(episode.level, env.static_env_params)
    told = jax.device_get(_played(env, *on_device((state, rows))))
    states, reward, done, ending = told
    ends = np.flatnonzero(done[:count])
    length = int(ends[0]) + 1 if len(ends) else count
    last = length - 1
    outcome: Outcome = OUTCOMES[int(ending[last]) - 1] if len(ends) else "timeout"
    return ReplayedEpisode(
        states=jax.tree.map(lambda x: x[:length], states),
        reward=reward[:length],
        length=length,
        outcome=outcome,
    )


def checked(episode: RecordedEpisode) -> RecordedEpisode:
    """Return the episode with `replays` as found by playing it again.

    Args:
        episode: The episode; one that cannot be played, such as under physics that there is not,
            does not replay.
    """
    again = _replayed(episode)
    return dataclasses.replace(episode, replays=again is not None and again.ends_as(episode))


def up_to_the_win(episode: RecordedEpisode) -> RecordedEpisode:
    """Return a recorded solution as it is played again: cut after the step in which it wins.

    A solution claims that it wins, not in which step: after a change to the engine that may be
    an earlier one, and what it drove afterwards is no part of the episode.

    Args:
        episode: From `solution_episode`.
    """
    again = _replayed(episode)
    if again is None or again.outcome != episode.outcome:
        return dataclasses.replace(episode, replays=False)
    reward = episode.reward[: again.length].copy()
    reward[-1:] = 1.0
    return dataclasses.replace(
        episode, control=episode.control[: again.length], reward=reward, replays=True
    )


def _replayed(episode: RecordedEpisode) -> ReplayedEpisode | None:
    """Play an episode again; None where that cannot be done."""
    try:
        return replay(episode)
    except KinetixError:
        return None


@functools.lru_cache(maxsize=16)
def _environment(capacity: Capacity, physics: str, frame_skip: int) -> KinetixEnv:
    static = static_env_params_of(capacity, frame_skip=frame_skip, physics=physics)
    return playing_env(static, actions=ActionType.CONTINUOUS)


@functools.partial(jax.jit, static_argnums=0)
def _played(env: KinetixEnv, state: EnvState, rows: Float[Array, "k u"]) -> Any:
    key = jax.random.key(0)  # nothing in a step of one level is random

    def step(state: EnvState, row: Array) -> tuple[EnvState, Any]:
        _, after, reward, done, info = env.step(key, state, row)
        return after, (state, reward, done, outcome_index(info))

    return jax.lax.scan(step, state, rows)[1]
