"""Search for actions that win a level: it alternates two searches.

*Whole plans* (here) plays many random plans from the start, keeps those that came closest, and
replaces their ends: good where few actions decide. *Stretches* (`beam.py`) goes on from where
the best attempts are, half a second at a time: good where many small things must go right, such as
walking. Neither needs training.
"""

import dataclasses
import functools
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import LEVEL_FRAME_SKIP, static_env_params_of
from kinetix.environment.rearrange import expand_state
from kinetix.environment.replay import play_actions, playing_env, state_after
from kinetix.environment.reset import level_state, static_env_params_for_levels
from kinetix.environment.search.beam import BATCH, Round, Task, steps_of, stretches
from kinetix.environment.search.plans import HOLD, Plans, random_plans, runs_of
from kinetix.environment.state import EnvState
from kinetix.level.controls import channels_in_use
from kinetix.level.model import Level, Solution
from kinetix.level.sets import common_capacity
from kinetix.programs import make_room
from kinetix.pytree import on_device

ELITE: Final = 24
"""Plans that a round keeps."""
FRESH: Final = 64
"""Fresh random plans per round."""
ROWS: Final = 512
"""Plans are padded to a multiple of this many steps."""
LOST: Final = 10.0
"""Distance that a loss counts for when plans are ranked [m]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class SearchProgress:
    """Progress of a search after a round."""

    plans: int
    """Plans played so far."""
    won: int
    """Plans that won."""
    distance: float
    """Least distance between green and blue [m]; of plans that were not lost, if there are any."""
    seconds: float
    """Of the search, without the first round of each kind."""
    compiling: float
    """Seconds of the first rounds, which compile."""
    compiled: bool
    """True once each kind has had its first round."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlanResults:
    """Results of a batch of plans."""

    won: Bool[np.ndarray, " n"]
    steps: Int[np.ndarray, " n"]
    """Environment steps until the episode ended."""
    score: Float[np.ndarray, " n"]
    """The less the better."""
    closest: float
    """Least distance between green and blue [m], in a plan that was not lost where there is one."""


def solve_level(
    level: Level,
    *,
    physics: str,
    seed: int = 0,
    seconds: float = 60.0,
    report: Callable[[SearchProgress], None] = lambda progress: None,
    env: KinetixEnv | None = None,
) -> Solution | None:
    """Search for a solution of a level.

    Args:
        level: A level that is neither won nor lost at its start.
        physics: Physics preset under which the solution shall hold.
        seed: Same seed, same search (but for where the time runs out).
        seconds: How long to search; the round that is on when time is up is finished. The first
            round of each kind is not counted, as it compiles.
        report: Called after each round without a solution.
        env: One of `solving_env` that covers this level; by default it is made for this one alone.

    Returns:
        Actions from the start to the winning step, or None.

    Raises:
        KinetixError: The physics is unknown.
    """
    started = time.perf_counter()
    env = env or solving_env([level], physics=physics)
    task = search_task(level, env, physics=physics, seed=seed)
    played = won = 0
    closest = np.inf
    ways = _whole_plans(task), stretches(task)
    compiled: float | None = None
    for turn, way in enumerate(itertools.cycle(ways)):
        found = next(way)
        now = time.perf_counter()
        if turn == len(ways) - 1:
            compiled = now
        if found.actions is not None:
            return Solution(
                physics=physics,
                frame_skip=env.static_env_params.frame_skip,
                actions=runs_of(found.actions),
            )
        played, won = played + found.plans, won + found.won
        closest = min(closest, found.distance)
        searched = 0.0 if compiled is None else now - compiled
        report(
            SearchProgress(
                plans=played,
                won=won,
                distance=closest,
                seconds=searched,
                compiling=now - started - searched,
                compiled=compiled is not None,
            )
        )
        if not task.channels or (compiled is not None and searched >= seconds):
            return None
    raise AssertionError("a cycle has no end")


def search_task(level: Level, env: KinetixEnv, *, physics: str, seed: int = 0) -> Task:
    """Return the search task of a level.

    Args:
        level: The level.
        env: One of `solving_env` that covers it.
        physics: Physics preset under which a solution shall hold.
        seed: Of all draws.
    """
    alone: Any = {"physics": physics, "frame_skip": env.static_env_params.frame_skip}

    def wins(actions: Int[np.ndarray, "k 6"]) -> bool:
        # A batch of one may round differently; only what holds there too is a proof.
        return play_actions(level, actions.tolist(), **alone).outcome == "won"

    def after(actions: Int[np.ndarray, "k 6"]) -> EnvState | None:
        state = state_after(level, actions.tolist(), **alone)
        return None if state is None else expand_state(state, env.static_env_params)

    return Task(
        env=env,
        start=level_state(level, env.static_env_params),
        limit=level.max_timesteps,
        channels=channels_in_use(level),
        random=np.random.default_rng(seed),
        wins=wins,
        after=after,
    )


def solving_env(
    levels: Sequence[Level], *, physics: str, frame_skip: int = LEVEL_FRAME_SKIP
) -> KinetixEnv:
    """Return an environment for searching these levels, which ends its episodes.

    It computes what at least one of them can do. For one level that is least work a step; for
    many, one compilation serves them all.

    Args:
        levels: The levels.
        physics: Physics preset.
        frame_skip: Engine steps per environment step.

    Raises:
        KinetixError: The physics is unknown.
    """
    capacity = common_capacity(levels)
    static = static_env_params_of(capacity, physics=physics, frame_skip=frame_skip)
    static = static_env_params_for_levels(levels, static)
    return playing_env(static)


def _whole_plans(task: Task) -> Iterator[Round]:
    """Rounds of whole plans: random ones first, then the best so far varied and fresh ones."""
    plans = random_plans(task.random, BATCH, task.limit, task.channels)
    elite, scores = plans[:0], np.empty(0)
    while True:
        outcome = play_plans(task, plans)
        winners = np.flatnonzero(outcome.won)[np.argsort(outcome.steps[outcome.won])]
        candidates = (plans[index, : outcome.steps[index]] for index in winners)
        elite, scores = _best(
            np.concatenate([elite, plans]), np.concatenate([scores, outcome.score])
        )
        yield Round(
            plans=len(plans),
            won=len(winners),
            actions=next(filter(task.wins, candidates), None),
            distance=outcome.closest,
        )
        fresh = random_plans(task.random, FRESH, task.limit, task.channels)
        plans = np.concatenate([_varied(task, elite, BATCH - FRESH), fresh])


def _varied(task: Task, elite: Plans, count: int) -> Plans:
    """Children of good plans: another end, another stretch, or the same a little shifted."""
    random, steps = task.random, elite.shape[1]
    # Squared: the best parents have the most children.
    children = elite[(len(elite) * random.random(count) ** 2).astype(int)].copy()
    other = random_plans(random, count, steps, task.channels)
    for child, source in zip(children, other, strict=True):
        first = random.integers(0, steps)
        kind = random.integers(0, 3)
        if kind == 0:
            child[first:] = source[first:]
        elif kind == 1:
            last = first + random.integers(2, HOLD[1])
            channel = random.choice(task.channels)
            child[first:last, channel] = source[first:last, channel]
        else:
            child[first:] = np.roll(child[first:], random.integers(-6, 7), axis=0)
    return children


def _best(plans: Plans, scores: Float[np.ndarray, " n"]) -> tuple[Plans, Float[np.ndarray, " n"]]:
    order = np.argsort(scores, kind="stable")[:ELITE]
    return plans[order], scores[order]


def play_plans(task: Task, plans: Plans, *, all_to_the_end: bool = False) -> PlanResults:
    """Play a batch of plans from the start.

    Args:
        task: The level.
        plans: What to play.
        all_to_the_end: Whether to go on when one has won.
    """
    make_room()
    # Levels of different time limits share a compilation; their own limits end the episodes.
    missing = -plans.shape[1] % ROWS
    padded = on_device(np.pad(plans, ((0, 0), (0, missing), (0, 0))))
    played = _rollout(task.env, all_to_the_end, task.start, padded)
    won, lost, steps, distance = (np.asarray(x) for x in played)
    going = distance[~lost] if not lost.all() else distance
    return PlanResults(
        won=won, steps=steps, score=distance + LOST * lost, closest=float(going.min())
    )


@functools.partial(jax.jit, static_argnums=(0, 1))
def _rollout(
    env: KinetixEnv, all_to_the_end: bool, start: EnvState, plans: Int[Array, "n k 6"]
) -> tuple[Array, ...]:
    """Play plans until one has won (unless all go to the end), or each has ended.

    Returns:
        Per plan: won, lost, steps played, least distance [m].
    """
    count, limit = plans.shape[:2]
    key = jax.random.key(0)  # nothing in a step of one level is random
    step = steps_of(env, count)

    def going_on(carry: tuple[Any, ...]) -> Array:
        t, _, done, won, *_ = carry
        playing = (t < limit) & ~jnp.all(done)
        return playing if all_to_the_end else playing & ~jnp.any(won)

    def advance(carry: tuple[Any, ...]) -> tuple[Any, ...]:
        t, state, done, won, lost, steps, distance = carry
        _, state, _, ended, info = step(key, state, plans[:, t])
        fresh = ~done
        return (
            t + 1,
            state,
            done | ended,
            won | (fresh & info["GoalR"]),
            lost | (fresh & info["terminated"] & ~info["GoalR"]) | (fresh & info["nan"]),
            steps + fresh,
            jnp.where(fresh, jnp.minimum(distance, info["distance"]), distance),
        )

    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *jnp.shape(x))), start)
    no, zero = jnp.zeros(count, bool), jnp.zeros(count, jnp.int32)
    nowhere = jnp.full(count, jnp.inf, jnp.float32)
    carry = (jnp.int32(0), states, no, no, no, zero, nowhere)
    return jax.lax.while_loop(going_on, advance, carry)[3:]
