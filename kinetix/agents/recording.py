"""Attempts of an evaluation with what was driven in every step, as data."""

from collections.abc import Iterator, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from kinetix.agents.environments import environment_for
from kinetix.agents.episodes import Episodes, rows
from kinetix.agents.evaluate import (
    NamedLevel,
    Prepared,
    Settings,
    begin,
    episode_results,
    go_on,
    prepare,
)
from kinetix.agents.player import Player
from kinetix.agents.results import EpisodeResult
from kinetix.datasets.episode import RecordedEpisode
from kinetix.datasets.replays import checked
from kinetix.environment.env import KinetixEnv
from kinetix.environment.reset import level_state
from kinetix.level.codec import LoadedLevel, load_level
from kinetix.level.model import Level


def recorded_attempts(
    player: Player,
    level: NamedLevel,
    settings: Settings | None = None,
    *,
    outcomes: Sequence[str] = (),
) -> Iterator[RecordedEpisode | None]:
    """Play all attempts of an evaluation and keep what was driven.

    Args:
        player: Who plays.
        level: A file or a document.
        settings: Of the evaluation: the same attempts to the bit.
        outcomes: Which ends are wanted; empty: all.

    Yields:
        None after every step, so that it can be cancelled; then the episodes.

    Raises:
        CheckpointError: The player cannot play the level.
        LevelError: The level is bad.
    """
    settings = settings or Settings()
    source = level.source.level if isinstance(level.source, LoadedLevel) else level.source
    document = source if isinstance(source, Level) else load_level(str(source))
    prepared = prepare(player, level)
    env = environment_for(player, prepared.capacity, physics=settings.physics_for(player))
    provenance = settings.provenance(player)
    batch = rows(player.policy)
    for first in range(0, settings.attempts, batch):
        chosen = range(first, min(first + batch, settings.attempts))
        driven: list[np.ndarray] = []
        rewards: list[np.ndarray] = []
        episodes: Episodes | None = None
        for episodes in _steps(env, player, prepared, settings, chosen):
            driven.append(np.asarray(_unified(env, episodes.last.action)))
            rewards.append(np.asarray(episodes.last.reward))
            yield None
        assert episodes is not None
        results = episode_results(episodes)
        for row, attempt in enumerate(chosen):
            result: EpisodeResult = results[row]
            if outcomes and result.outcome not in outcomes:
                continue
            yield checked(
                RecordedEpisode(
                    level=document,
                    control=np.stack([step[row] for step in driven[: result.length]]),
                    reward=np.array([step[row] for step in rewards[: result.length]], np.float32),
                    outcome=result.outcome,
                    physics=provenance.physics,
                    frame_skip=player.card.environment.frame_skip,
                    source="agent",
                    player=provenance.agent,
                    digest=provenance.digest,
                    seed=settings.seed,
                    attempt=attempt,
                    deterministic=settings.deterministic,
                )
            )


def _steps(
    env: KinetixEnv, player: Player, prepared: Prepared, settings: Settings, attempts: range
) -> Iterator[Episodes]:
    """The batch after each of its steps."""
    state = jax.tree.map(np.asarray, level_state(prepared.level.source, env.static_env_params))
    asked = [(state, prepared.key, attempt) for attempt in attempts]
    episodes = begin(env, player, asked, settings.seed)
    while not bool(jnp.all(episodes.over)):
        episodes = go_on(env, player, episodes, 1, settings)
        yield episodes


def _unified(env: KinetixEnv, actions: Any) -> Any:
    return jax.vmap(env.actions.unified)(actions)
