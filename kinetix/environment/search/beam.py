"""Searching a stretch at a time: from where the best attempts are, in many directions at once.

A beam search over held actions. Every stretch plays `BATCH` attempts on for `STRETCH` steps; those
that are lost drop out, those with green and blue closest together go on, several times each. One
pass to the time limit costs as much as one batch of whole plans, and can string together what no
whole plan hits upon by chance, such as the steps of a walk. A little noise in the ranking keeps
attempts alive that must first go away from the goal.

Batched and single episodes round differently; over many steps the difference can turn a walk into a
fall. Where plans win in the batch only, the best one is followed alone for a while, and the search
goes on from where that really leads, until what remains is short enough.
"""

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from kinetix.environment.devices import devices_for, in_shares
from kinetix.environment.env import KinetixEnv
from kinetix.environment.search.plans import Plans, random_plans
from kinetix.environment.state import EnvState

BATCH: Final = 256
"""Plans a round: enough variety, and small enough for a first result within seconds on a CPU."""
STRETCH: Final = 16
"""Environment steps between two choices of what goes on (1/30 s each)."""
KEPT: Final = 48
"""Attempts that go on after a stretch."""
NOISE: Final = 0.05
"""Scale of the noise in the ranking [m]."""
HELD: Final = 0.25
"""Share of the attempts that hold what they last did for a while."""
FOLLOWED: Final = 32
"""Most environment steps that a plan is followed alone before the search goes on from there."""
PROVEN: Final = 8
"""Most winners of a stretch that are played alone: those of one batch are much alike."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Task:
    """The level of a search, and the environment that plays it."""

    env: KinetixEnv
    start: EnvState
    limit: int
    """The level's time limit [environment steps]."""
    channels: tuple[int, ...]
    """Entries of an action that drive anything."""
    random: np.random.Generator
    wins: Callable[[Int[np.ndarray, "k 6"]], bool]
    """True where actions that won in a batch also win alone."""
    after: Callable[[Int[np.ndarray, "k 6"]], EnvState | None]
    """State after actions that are played alone; None where the episode is over by then."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Round:
    """Result of one round of a search."""

    plans: int
    """Plans played."""
    won: int
    """Plans that won in the batch."""
    actions: Int[np.ndarray, "k 6"] | None
    """The shortest that also win alone."""
    distance: float
    """Least distance between green and blue in a plan that was not lost [m]."""
    unproven: Int[np.ndarray, "k 6"] | None = None
    """The first plan that won in the batch, where none wins alone."""


def stretches(task: Task) -> Iterator[Round]:
    """Yield one round per pass, each with other random numbers, without end.

    A pass goes from the start to the time limit, or from where a plan really leads that won in the
    batch only.
    """
    while True:
        guide, followed = np.zeros((0, 6), np.int32), 0
        start: EnvState | None = task.start
        while start is not None:
            found = _pass(task, start, guide, followed)
            yield found
            rest = 0 if found.unproven is None else len(found.unproven) - followed
            if found.unproven is None or rest < 2:
                break
            guide, followed = found.unproven, followed + min(FOLLOWED, rest // 2)
            start = task.after(guide[:followed])


def _pass(task: Task, start: EnvState, guide: Int[np.ndarray, "k 6"], followed: int) -> Round:
    """Do one pass; the first attempt goes on with the guide's actions as far as they last."""
    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (BATCH, *jnp.shape(x))), start)
    parents = np.arange(BATCH)
    plans = np.repeat(guide[None, :followed], BATCH, axis=0)
    won, closest = 0, np.inf
    actions = unproven = None
    while plans.shape[1] < task.limit:
        before = plans.shape[1]
        fresh = _continued(task, plans)
        guided = guide[before : before + STRETCH]
        fresh[0, : len(guided)] = guided
        plans = np.concatenate([plans, fresh], axis=1)
        states, *rest = _stretch(task.env, states, parents, fresh)
        winning, over, steps, distance = (np.asarray(x) for x in rest)
        winners = np.flatnonzero(winning)[np.argsort(steps[winning])]
        won += len(winners)
        candidates = [plans[index, : before + steps[index]] for index in winners[:PROVEN]]
        actions = next(filter(task.wins, candidates), None)
        going = np.flatnonzero(~over)
        closest = min(closest, distance[going].min(initial=np.inf))
        if candidates and actions is None:
            unproven = candidates[0]
        if candidates or not len(going):
            break
        rank = distance[going] + NOISE * task.random.gumbel(size=len(going))
        parents = np.resize(going[np.argsort(rank, kind="stable")][:KEPT], BATCH)
        if len(guide) > plans.shape[1] and not over[0]:
            parents[0] = 0
        plans = plans[parents]
    return Round(plans=BATCH, won=won, actions=actions, distance=float(closest), unproven=unproven)


def _continued(task: Task, plans: Plans) -> Plans:
    """Draw the next stretch of each attempt: random actions, some after holding on."""
    fresh = random_plans(task.random, BATCH, STRETCH, task.channels)
    if plans.shape[1] == 0:
        return fresh
    longest = np.where(task.random.random(BATCH) < HELD, STRETCH, 1)
    held = np.arange(STRETCH) < task.random.integers(0, longest)[:, None]
    return np.where(held[..., None], plans[:, -1:], fresh)


@functools.partial(jax.jit, static_argnums=0)
def _stretch(
    env: KinetixEnv, states: EnvState, parents: Int[Array, " n"], plans: Int[Array, "n k 6"]
) -> tuple[Any, ...]:
    """Play a stretch on from chosen states.

    Returns:
        The states after it; per attempt: won, over, steps played, distance [m].
    """
    key = jax.random.key(0)  # nothing in a step of one level is random
    step = steps_of(env, len(plans))

    def advance(carry: tuple[Any, ...], actions: Array) -> tuple[tuple[Any, ...], None]:
        state, won, over, steps, _ = carry
        _, state, _, ended, info = step(key, state, actions)
        fresh = ~over
        over = over | ended | info["nan"]
        return (state, won | (fresh & info["GoalR"]), over, steps + fresh, info["distance"]), None

    count = len(plans)
    no, zero = jnp.zeros(count, bool), jnp.zeros(count, jnp.int32)
    states = jax.tree.map(lambda x: x[parents], states)
    carry = (states, no, no, zero, jnp.zeros(count, jnp.float32))
    return jax.lax.scan(advance, carry, jnp.swapaxes(plans, 0, 1))[0]


def steps_of(env: KinetixEnv, count: int) -> Callable[..., Any]:
    """Step so many attempts at once, on all devices that can have equal shares.

    Args:
        env: Where.
        count: How many attempts.

    Returns:
        A function of one key, the states and the actions.
    """
    step = jax.vmap(env.step, in_axes=(None, 0, 0))
    return in_shares(step, replicated=(0,), devices=devices_for(count))
