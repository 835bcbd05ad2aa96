"""Evaluation of a player: levels × attempts, in batches of one size, a generator of progress.

The command `kinetix eval` and the editor call this one function, so they give the same numbers.
"""

import dataclasses
import functools
import zlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np

from kinetix.agents.environments import capacity_for, environment_for
from kinetix.agents.episodes import Episodes, advance, episode_keys, rows, start
from kinetix.agents.identity import card_digest_of, digest_of
from kinetix.agents.live import Reading, read_policy
from kinetix.agents.player import Player
from kinetix.agents.results import (
    EpisodeResult,
    LevelFailure,
    LevelResult,
    Provenance,
)
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv
from kinetix.environment.outcome import OUTCOMES
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.errors import CheckpointError, LevelError
from kinetix.level.codec import LoadedLevel, level_hash, load_document
from kinetix.level.features import capacity_of_world
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of
from kinetix.programs import make_room

ATTEMPTS: Final = 20
"""Attempts a level of the published protocol."""
SEGMENT: Final = 32
"""Environment steps between two reports of progress."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class NamedLevel:
    """A level to be played, and what it is called in results."""

    name: str
    source: str | Level | LoadedLevel | EnvState
    """A file or bundled name, a document, what was read of a file, or a state."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Progress:
    """Progress of an evaluation."""

    done: int
    """Episodes that are over."""
    total: int
    """Episodes in all."""
    results: tuple[LevelResult, ...]
    """Levels of which all attempts are over, in the order they were asked for."""
    failures: tuple[LevelFailure, ...] = ()
    """Levels that the player cannot play, or that are bad, in the same order."""

    def in_order(self, names: Sequence[str]) -> list[LevelResult | LevelFailure]:
        """Return results and failures in the order of the levels' names."""
        found: dict[str, list[LevelResult | LevelFailure]] = defaultdict(list)
        for one in (*self.results, *self.failures):
            found[one.level].append(one)
        return [found[name].pop(0) for name in names if found[name]]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of an evaluation."""

    attempts: int = ATTEMPTS
    """Independent episodes a level."""
    seed: int = 0
    """Equal seeds give equal results."""
    physics: str = ""
    """Physics preset or solver; empty: what the player was trained under."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""

    def physics_for(self, player: Player) -> str:
        """Return the physics under which a player is measured."""
        return self.physics or player.card.environment.physics

    def provenance(self, player: Player) -> Provenance:
        """Return what a player's results depend on, levels aside."""
        return Provenance(
            agent=player.card.name,
            digest=digest_of(player),
            physics=self.physics_for(player),
            seed=self.seed,
            attempts=self.attempts,
            deterministic=self.deterministic,
            frame_skip=player.card.environment.frame_skip,
            dense_reward_scale=player.card.environment.dense_reward_scale,
            card_digest=card_digest_of(player),
        )


def evaluate(
    player: Player,
    levels: Sequence[NamedLevel],
    settings: Settings | None = None,
    *,
    segment: int = SEGMENT,
) -> Iterator[Progress]:
    """Play every level several times.

    Closing the generator cancels; at most `segment` environment steps of one batch are wasted.

    Args:
        player: Who plays; actions are drawn from its policy unless `settings.deterministic`.
        levels: What it plays; levels of one capacity are played together.
        settings: Attempts, seed, physics.
        segment: Environment steps between two reports; changes no result.

    Yields:
        Progress; the last one has a result or a failure of every level.

    Raises:
        KinetixError: The player cannot play anything under the physics.
    """
    settings = settings or Settings()
    prepared, failures = _prepare_all(player, levels)
    total = len(prepared) * settings.attempts
    outcomes: dict[int, list[EpisodeResult]] = defaultdict(list)
    finished = 0

    def progress(done: int) -> Progress:
        results = [
            LevelResult.of(level.name, outcomes[index])
            for index, level in enumerate(levels)
            if len(outcomes.get(index, ())) == settings.attempts
        ]
        return Progress(done=done, total=total, results=tuple(results), failures=failures)

    for capacity, members in _by_capacity(prepared).items():
        make_room()
        env = environment_for(player, capacity, physics=settings.physics_for(player))
        states = {i: _numpy(level_state(levels[i].source, env.static_env_params)) for i in members}
        jobs = [(index, attempt) for index in members for attempt in range(settings.attempts)]
        batch = rows(player.policy)
        for first in range(0, len(jobs), batch):
            chosen = jobs[first : first + batch]
            asked = [(states[index], prepared[index].key, attempt) for index, attempt in chosen]
            episodes = begin(env, player, asked, settings.seed)
            while not bool(jnp.all(episodes.over)):
                over = int(jnp.sum(episodes.over[: len(chosen)]))
                yield progress(finished + over)
                episodes = go_on(env, player, episodes, segment, settings)
            finished += len(chosen)
            told = episode_results(episodes)
            for row, (index, _) in enumerate(chosen):
                outcomes[index].append(told[row])
    yield progress(finished)


@dataclasses.dataclass(frozen=True, kw_only=True)
class RecordedStep:
    """One moment of a recorded episode, as numpy arrays."""

    state: EnvState
    carry: Any
    """The player's memory after this moment's step, one row."""
    action: np.ndarray | None
    """The unified action that led here; None at the start."""
    reward: float
    distance: float
    """Distance of the green and blue shapes [m]."""
    reading: Reading | None
    """Output of the network, as numpy arrays; None for scripted players and at the start."""
    result: EpisodeResult | None
    """Result of the episode, at its last moment."""


def record(
    player: Player, level: NamedLevel, attempt: int, settings: Settings | None = None
) -> Iterator[RecordedStep]:
    """Play one episode of an evaluation again, moment by moment: the same to the bit.

    It runs in a batch of the same size through the same compiled code, so it costs as much as the
    whole batch did.

    Args:
        player: Who played.
        level: Which level.
        attempt: Which attempt, from 0.
        settings: Of the evaluation.

    Raises:
        CheckpointError: The player cannot play the level.
        LevelError: The level is bad.
    """
    settings = settings or Settings()
    prepared = prepare(player, level)
    env = environment_for(player, prepared.capacity, physics=settings.physics_for(player))
    state = _numpy(level_state(level.source, env.static_env_params))
    episodes = begin(env, player, [(state, prepared.key, attempt)], settings.seed)
    yield _moment(env, episodes, first=True)
    while not bool(episodes.over[0]):
        episodes = go_on(env, player, episodes, 1, settings)
        yield _moment(env, episodes, first=False)


def go_on(
    env: KinetixEnv, player: Player, episodes: Episodes, steps: int, settings: Settings
) -> Episodes:
    """Let the player of a batch play some environment steps; episodes that are over count no more.

    Args:
        env: The environment.
        player: Who plays.
        episodes: Where they are.
        steps: How many steps; any number runs the same compiled code.
        settings: Of the evaluation.
    """
    return advance(
        env, player.policy, player.params, episodes, steps, deterministic=settings.deterministic
    )


def begin(
    env: KinetixEnv, player: Player, asked: Sequence[tuple[EnvState, int, int]], seed: int
) -> Episodes:
    """Begin a batch of (first state, the level's number, attempt); other rows are over.

    Args:
        env: The environment.
        player: Who plays.
        asked: At most `rows(player.policy)` of them.
        seed: Of the evaluation.
    """
    # They repeat the first row, which costs nothing extra: the batch has its size anyway.
    count = rows(player.policy)
    filled = [*asked, *[asked[0]] * (count - len(asked))]
    states, levels, attempts = zip(*filled, strict=True)
    keys = episode_keys(levels, attempts, seed)
    over = np.arange(count) >= len(asked)
    return start(env, player.policy, player.params, states, keys, over)


def _moment(env: KinetixEnv, episodes: Episodes, *, first: bool) -> RecordedStep:
    row = jax.tree.map(lambda x: np.asarray(x[0]), (episodes.state, episodes.carry, episodes.last))
    state, carry, last = row
    over = bool(episodes.over[0])
    return RecordedStep(
        state=state,
        carry=jax.tree.map(lambda x: x[None], carry),
        action=None if first else np.asarray(env.actions.unified(last.action)),
        reward=float(last.reward),
        distance=float(last.distance),
        reading=None if first or "policy" not in last.info else _reading(env, episodes),
        result=episode_results(episodes)[0] if over else None,
    )


@functools.partial(jax.jit, static_argnums=0)
def _read(env: KinetixEnv, said: dict[str, Any], state: EnvState) -> Reading:
    return read_policy(env, said, env.actions.live(state.world, state.labels))


def _reading(env: KinetixEnv, episodes: Episodes) -> Reading:
    state = jax.tree.map(lambda x: x[0], episodes.state)
    return _numpy(_read(env, episodes.last.info, state))


def episode_results(episodes: Episodes) -> list[EpisodeResult]:
    """Return how every episode of a batch ended; a row that is not over counts as a timeout."""
    columns = _numpy((episodes.ending, episodes.returns, episodes.lengths, episodes.dropped))
    return [
        EpisodeResult(
            outcome=OUTCOMES[ending - 1] if ending else "timeout",
            total_reward=float(reward),
            length=int(length),
            dropped_contacts=int(dropped),
        )
        for ending, reward, length, dropped in zip(*columns, strict=True)
    ]


def _numpy(tree: Any) -> Any:
    return jax.tree.map(np.asarray, tree)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Prepared:
    """A level as a player meets it."""

    level: NamedLevel
    capacity: Capacity
    """At which it is played."""
    key: int
    """Identifies the level whatever it is called; seeds its episodes."""


def prepare(player: Player, level: NamedLevel) -> Prepared:
    """Return a level as a player meets it.

    Raises:
        CheckpointError: The player cannot play it.
        LevelError: The level has errors.
    """
    capacity, key = capacity_and_key(level.source)
    capacity = capacity_for(player.card, capacity, level=level.name)
    return Prepared(level=level, capacity=capacity, key=key)


def capacity_and_key(source: str | Level | LoadedLevel | EnvState) -> tuple[Capacity, int]:
    """Sizes of a level, and the number that identifies its content: it seeds its episodes.

    Args:
        source: A file or bundled name, a document, what was read of a file, or a state.

    Raises:
        LevelError: The file is bad.
    """
    if isinstance(source, EnvState):
        leaves = jax.tree.leaves((source.world, source.labels, source.physics.position))
        key = functools.reduce(lambda crc, x: zlib.crc32(np.asarray(x).tobytes(), crc), leaves, 0)
        return capacity_of_world(source.world), key
    if isinstance(source, Level):
        return capacity_of(source), int(level_hash(source)[:8], 16)
    document = source if isinstance(source, LoadedLevel) else load_document(source)
    return document.capacity, int(level_hash(document.level)[:8], 16)


def _prepare_all(
    player: Player, levels: Sequence[NamedLevel]
) -> tuple[dict[int, Prepared], tuple[LevelFailure, ...]]:
    """Return the levels that can be played, by index, and why the others cannot."""
    prepared, failures = {}, []
    for index, level in enumerate(levels):
        try:
            prepared[index] = prepare(player, level)
        except (CheckpointError, LevelError) as error:
            failures.append(LevelFailure(level=level.name, error=str(error)))
    return prepared, tuple(failures)


def _by_capacity(prepared: dict[int, Prepared]) -> dict[Capacity, list[int]]:
    groups: dict[Capacity, list[int]] = defaultdict(list)
    for index, level in prepared.items():
        groups[level.capacity].append(index)
    return groups
