"""How good is a player: levels × attempts, in batches of one size, a generator of progress.

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
from jaxtyping import Array, Bool, Float, Int

from kinetix.agents.player import Player, Policy
from kinetix.agents.results import LevelResult
from kinetix.agents.shapes import observations_of_card
from kinetix.engine.spec import Capacity
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from kinetix.errors import CheckpointError
from kinetix.level.codec import level_hash, load_document
from kinetix.level.compile import capacity_of_world
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of
from kinetix.pytree import pytree

ATTEMPTS: Final = 20
"""Attempts a level of the published protocol."""
BATCH: Final = 128
"""Episodes that run at once. Always the same number, so that rounding does not depend on how many
levels are asked for."""
_SEGMENT: Final = 32
"""Environment steps between two reports of progress."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class NamedLevel:
    """A level to be played, and what it is called in results."""

    name: str
    source: str | Level | EnvState
    """A file or bundled name, a document, or a state."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Progress:
    """Where an evaluation stands."""

    done: int
    """Episodes that are over."""
    total: int
    """Episodes in all."""
    results: tuple[LevelResult, ...]
    """Levels of which all attempts are over, in the order they were asked for."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Settings:
    """How to evaluate."""

    attempts: int = ATTEMPTS
    """Independent episodes a level."""
    seed: int = 0
    """Equal seeds give equal results."""
    physics: str = "balanced"
    """Physics preset or solver, whatever the agent was trained on."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""


@pytree
class _Episodes:
    """A batch of episodes on their way."""

    state: EnvState
    observation: Any
    carry: Any
    keys: Array
    begins: Bool[Array, " n"]
    over: Bool[Array, " n"]
    solved: Bool[Array, " n"]
    returns: Float[Array, " n"]
    lengths: Int[Array, " n"]


def evaluate(
    player: Player, levels: Sequence[NamedLevel], settings: Settings | None = None
) -> Iterator[Progress]:
    """Play every level several times.

    Closing the generator cancels; at most `_SEGMENT` environment steps of one batch are wasted.

    Args:
        player: Who plays; actions are drawn from its policy unless `settings.deterministic`.
        levels: What it plays; levels of one capacity are played together.
        settings: Attempts, seed, physics.

    Yields:
        Progress; the last one has every level's result.

    Raises:
        CheckpointError: The player cannot play one of the levels; the sentence says why.
        LevelError: A level is bad.
    """
    settings = settings or Settings()
    prepared = [_prepare(player, level) for level in levels]
    total = len(levels) * settings.attempts
    outcomes: dict[int, list[tuple[bool, float, int]]] = defaultdict(list)
    finished = 0
    for capacity, members in _by_capacity(prepared).items():
        env = environment_for(player, capacity, physics=settings.physics)
        states = {i: _numpy(level_state(levels[i].source, env.static_env_params)) for i in members}
        jobs = [(index, attempt) for index in members for attempt in range(settings.attempts)]
        for first in range(0, len(jobs), BATCH):
            chosen = jobs[first : first + BATCH]
            # Rows that are left over repeat the first job and are over at once.
            rows = [*chosen, *[chosen[0]] * (BATCH - len(chosen))]
            state = jax.tree.map(lambda *x: np.stack(x), *(states[index] for index, _ in rows))
            seeds = [prepared[index].key for index, _ in rows]
            keys = _keys(seeds, [attempt for _, attempt in rows], settings.seed)
            episodes = _start(env, player.policy, state, keys, np.arange(BATCH) >= len(chosen))
            while not bool(jnp.all(episodes.over)):
                over = int(jnp.sum(episodes.over[: len(chosen)]))
                yield _progress(finished + over, total, levels, outcomes, settings)
                episodes = _advance(
                    env,
                    player.policy,
                    player.params,
                    episodes,
                    deterministic=settings.deterministic,
                )
            finished += len(chosen)
            solved, returns, lengths = _numpy((episodes.solved, episodes.returns, episodes.lengths))
            for row, (index, _) in enumerate(chosen):
                outcomes[index].append((bool(solved[row]), float(returns[row]), int(lengths[row])))
    yield _progress(finished, total, levels, outcomes, settings)


def _numpy(tree: Any) -> Any:
    return jax.tree.map(np.asarray, tree)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Prepared:
    level: NamedLevel
    capacity: Capacity
    key: int
    """Identifies the level whatever it is called; seeds its episodes."""


def _prepare(player: Player, level: NamedLevel) -> _Prepared:
    capacity, key = _capacity_and_key(level.source)
    own = player.card.capacity
    if own is not None and not player.card.plays_any_capacity:
        fixed = Capacity(
            polygons=own.polygons,
            circles=own.circles,
            joints=own.joints,
            thrusters=own.thrusters,
        )
        if not fixed.covers(capacity):
            raise CheckpointError(
                f"agent {player.card.name!r} sees exactly {_sizes(fixed)}, which is too small for "
                f"{level.name} with {_sizes(capacity)}"
            )
        capacity = fixed
    return _Prepared(level=level, capacity=capacity, key=key)


def _capacity_and_key(source: str | Level | EnvState) -> tuple[Capacity, int]:
    if isinstance(source, EnvState):
        leaves = jax.tree.leaves((source.world, source.labels, source.physics.position))
        key = functools.reduce(lambda crc, x: zlib.crc32(np.asarray(x).tobytes(), crc), leaves, 0)
        return capacity_of_world(source.world), key
    if isinstance(source, Level):
        return capacity_of(source), int(level_hash(source)[:8], 16)
    document = load_document(source)
    level = document.level
    capacity = document.source.capacity if document.source is not None else capacity_of(level)
    return capacity, int(level_hash(level)[:8], 16)


def _sizes(capacity: Capacity) -> str:
    return ", ".join(f"{value} {name}" for name, value in dataclasses.asdict(capacity).items())


def _by_capacity(prepared: Sequence[_Prepared]) -> dict[Capacity, list[int]]:
    groups: dict[Capacity, list[int]] = defaultdict(list)
    for index, level in enumerate(prepared):
        groups[level.capacity].append(index)
    return groups


@functools.partial(jax.jit, static_argnums=(0, 1))
def _start(
    env: KinetixEnv, policy: Policy, state: EnvState, keys: Array, over: Bool[Array, " n"]
) -> _Episodes:
    return _Episodes(
        state=state,
        observation=jax.vmap(env.get_obs)(state),
        carry=policy.init_carry(BATCH),
        keys=keys,
        begins=jnp.ones(BATCH, bool),
        over=over,
        solved=jnp.zeros(BATCH, bool),
        returns=jnp.zeros(BATCH),
        lengths=jnp.zeros(BATCH, jnp.int32),
    )


@functools.partial(jax.jit, static_argnums=(0, 1), static_argnames="deterministic")
def _advance(
    env: KinetixEnv, policy: Policy, params: Any, episodes: _Episodes, *, deterministic: bool
) -> _Episodes:
    """`_SEGMENT` environment steps of every episode; those that are over count no more."""

    def step(episodes: _Episodes, _: None) -> tuple[_Episodes, None]:
        keys = jax.vmap(jax.random.fold_in)(episodes.keys, episodes.lengths)
        action, carry, __ = policy.decide(
            params,
            episodes.carry,
            episodes.observation,
            keys,
            episodes.begins,
            deterministic=deterministic,
        )
        stepped = jax.vmap(env.step)(keys, episodes.state, action)
        observation, state, reward, done, info = stepped
        running = ~episodes.over
        return dataclasses.replace(
            episodes,
            state=state,
            observation=observation,
            carry=carry,
            begins=jnp.zeros_like(episodes.begins),
            over=episodes.over | done,
            solved=episodes.solved | (running & done & info["GoalR"]),
            returns=episodes.returns + jnp.where(running, reward, 0.0),
            lengths=episodes.lengths + running,
        ), None

    return jax.lax.scan(step, episodes, length=_SEGMENT)[0]


def _keys(levels: Sequence[int], attempts: Sequence[int], seed: int) -> Array:
    """A key for every episode, from the level's content, the attempt and the seed alone."""

    @jax.jit
    @jax.vmap
    def fold(level: Array, attempt: Array) -> Array:
        base = jax.random.PRNGKey(seed)
        return jax.random.fold_in(jax.random.fold_in(base, level), attempt)

    return fold(jnp.asarray(levels, jnp.uint32), jnp.asarray(attempts, jnp.uint32))


def environment_for(
    player: Player, capacity: Capacity, *, physics: str, auto_reset: bool = False
) -> KinetixEnv:
    """The environment that a player expects: its bindings, frame skip, step and observation.

    Args:
        player: Who will play.
        capacity: Sizes of the levels.
        physics: Physics preset or solver.
        auto_reset: Whether episodes go on by themselves.
    """
    card = player.card
    sizes = card.capacity
    bindings: Any = (
        {}
        if sizes is None
        else {
            "num_motor_bindings": sizes.motor_bindings,
            "num_thruster_bindings": sizes.thruster_bindings,
        }
    )
    static_env_params = static_env_params_of(
        capacity, frame_skip=card.environment.frame_skip, physics=physics, **bindings
    )
    env_params = EnvParams(
        dt=card.environment.dt, dense_reward_scale=card.environment.dense_reward_scale
    )
    env: Any = make_kinetix_env(
        action_type=card.action.type,
        observation_type=card.observation.type,
        env_params=env_params,
        static_env_params=static_env_params,
        auto_reset=auto_reset,
    )
    observations = observations_of_card(card, env_params, static_env_params)
    return dataclasses.replace(env, observations=observations)


def _progress(
    done: int,
    total: int,
    levels: Sequence[NamedLevel],
    outcomes: dict[int, list[tuple[bool, float, int]]],
    settings: Settings,
) -> Progress:
    results = []
    for index, level in enumerate(levels):
        episodes = outcomes.get(index, [])
        if len(episodes) == settings.attempts:
            results.append(
                LevelResult(
                    level=level.name,
                    attempts=settings.attempts,
                    solved=sum(solved for solved, _, _ in episodes),
                    mean_return=float(np.mean([value for _, value, _ in episodes])),
                    mean_length=float(np.mean([length for _, _, length in episodes])),
                )
            )
    return Progress(done=done, total=total, results=tuple(results))
