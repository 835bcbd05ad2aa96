"""The ways that the green shape takes in all attempts of an evaluation."""

import dataclasses
from collections.abc import Iterator
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from kinetix.agents.environments import environment_for
from kinetix.agents.episodes import Episodes, rows
from kinetix.agents.evaluate import (
    NamedLevel,
    Settings,
    begin,
    episode_results,
    go_on,
    prepare,
)
from kinetix.agents.player import Player
from kinetix.agents.results import EpisodeResult
from kinetix.environment.goal import GREEN
from kinetix.environment.outcome import Outcome
from kinetix.environment.reset import level_state

_EVERY = 2
"""Environment steps between two places."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Paths:
    """Attempts on one level; axis `n` attempts, `k` places in time, the start included."""

    step: Int[np.ndarray, " k"]
    """Environment steps since the start."""
    position: Float[np.ndarray, "n k 2"]
    """Of the first green shape [m]; it stays where it was when the attempt ended."""
    results: tuple[EpisodeResult, ...]


def attempt_paths(
    player: Player, level: NamedLevel, settings: Settings | None = None
) -> Iterator[Paths | None]:
    """Play all attempts of an evaluation again and note where the green shape is.

    Args:
        player: Who plays.
        level: The level.
        settings: Of the evaluation: the same attempts.

    Yields:
        None after every few steps, so that it can be cancelled; at last the paths.

    Raises:
        CheckpointError: The player cannot play the level.
        LevelError: The level is bad.
    """
    settings = settings or Settings()
    prepared = prepare(player, level)
    env = environment_for(player, prepared.capacity, physics=settings.physics_for(player))
    state = jax.tree.map(np.asarray, level_state(level.source, env.static_env_params))
    role, active = np.asarray(state.labels.role), np.asarray(state.world.bodies.active)
    green = int(np.argmax((role == GREEN) & active))
    parts: list[np.ndarray] = []
    results: list[EpisodeResult] = []
    batch = rows(player.policy)
    for first in range(0, settings.attempts, batch):
        chosen = range(first, min(first + batch, settings.attempts))
        asked = [(state, prepared.key, attempt) for attempt in chosen]
        episodes = begin(env, player, asked, settings.seed)
        places = [_place(episodes, green)]
        while not bool(jnp.all(episodes.over)):
            place = places[-1]
            for _ in range(_EVERY):
                over = np.asarray(episodes.over)
                episodes = go_on(env, player, episodes, 1, settings)
                # What is over goes on being stepped, but it is of no interest.
                place = np.where(over[:, None], place, _place(episodes, green))
            places.append(place)
            yield None
        parts.append(np.stack(places, axis=1)[: len(asked)])
        results += episode_results(episodes)[: len(asked)]
    longest = max(part.shape[1] for part in parts)
    missing = [((0, 0), (0, longest - part.shape[1]), (0, 0)) for part in parts]
    padded = [np.pad(part, more, "edge") for part, more in zip(parts, missing, strict=True)]
    yield Paths(
        step=np.arange(longest, dtype=np.int32) * _EVERY,
        position=np.concatenate(padded),
        results=tuple(results),
    )


def _place(episodes: Episodes, body: int) -> np.ndarray:
    return np.asarray(episodes.state.physics.position[:, body], np.float32)


def parting(paths: Paths) -> int | None:
    """Return the step at which attempts that are won leave those that are not.

    It is the first place from which on the means of both stay further apart than both spread.

    Returns:
        Environment steps; None where all end alike, or never part.
    """
    won = np.array([result.outcome == "won" for result in paths.results])
    if won.all() or not won.any():
        return None
    wins, losses = paths.position[won], paths.position[~won]
    apart = np.linalg.norm(wins.mean(axis=0) - losses.mean(axis=0), axis=-1)
    spread = _spread(wins) + _spread(losses)
    clear = apart > spread
    if not clear[-1]:
        return None
    # The last place where they are still together, and one on.
    together = np.flatnonzero(~clear)
    index = int(together[-1]) + 1 if len(together) else 0
    return int(paths.step[index])


@dataclasses.dataclass(frozen=True, kw_only=True)
class Ending:
    """Attempts that end alike: with the same outcome, in the same place."""

    outcome: Outcome
    attempts: tuple[int, ...]
    place: tuple[float, float]
    """Mean of where the green shape is at the end [m]."""
    length: int
    """Median of the environment steps."""
    parting: int | None
    """Step at which they leave the attempts that are won; None for those, or where they do not."""


NEAR: Final = 0.5
"""Ends that are this near to each other, or joined by others, are one place [m]."""


def endings(paths: Paths) -> tuple[Ending, ...]:
    """Return the attempts grouped by how they end, the largest group first.

    Args:
        paths: The ways of all attempts on a level.
    """
    last = paths.position[:, -1]
    outcomes = np.array([result.outcome for result in paths.results])
    lengths = np.array([result.length for result in paths.results])
    won = outcomes == "won"
    found = []
    for outcome in dict.fromkeys(outcomes.tolist()):
        rows = np.flatnonzero(outcomes == outcome)
        for members in _clusters(rows, last):
            step = None
            if outcome != "won" and won.any():
                among = np.concatenate([np.flatnonzero(won), members])
                step = parting(
                    Paths(
                        step=paths.step,
                        position=paths.position[among],
                        results=tuple(paths.results[k] for k in among.tolist()),
                    )
                )
            x, y = last[members].mean(axis=0).tolist()
            found.append(
                Ending(
                    outcome=outcome,
                    attempts=tuple(members.tolist()),
                    place=(x, y),
                    length=int(np.median(lengths[members])),
                    parting=step,
                )
            )
    return tuple(sorted(found, key=lambda one: -len(one.attempts)))


def _clusters(rows: Int[np.ndarray, " r"], places: Float[np.ndarray, "n 2"]) -> list[np.ndarray]:
    """Return rows whose places are joined by steps of at most `NEAR`."""
    left = rows.tolist()
    clusters = []
    while left:
        members, edge = [], [left.pop(0)]
        while edge:
            members += edge
            apart = np.linalg.norm(places[left][:, None] - places[edge][None], axis=-1)
            near = (apart <= NEAR).any(axis=1) if left else np.zeros(0, bool)
            edge = [row for row, is_near in zip(left, near, strict=True) if is_near]
            left = [row for row, is_near in zip(left, near, strict=True) if not is_near]
        clusters.append(np.array(sorted(members)))
    return clusters


def _spread(positions: Float[np.ndarray, "n k 2"]) -> Float[np.ndarray, " k"]:
    """Return the standard deviation of the place."""
    return np.sqrt(positions.var(axis=0).sum(axis=-1))
