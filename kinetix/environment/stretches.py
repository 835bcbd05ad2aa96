"""Searching a stretch at a time: from where the best attempts are, in many directions at once.

A beam search over held actions. Every stretch plays `BATCH` attempts on for `STRETCH` steps; those
that are lost drop out, those with green and blue closest together go on, several times each. One
pass to the time limit costs as much as one batch of whole plans, and can string together what no
whole plan hits upon by chance, such as the steps of a walk. A little noise in the ranking keeps
attempts alive that must first go away from the goal.
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
from kinetix.environment.plans import Plans, random_plans
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


def stretches(task: Task) -> Iterator[Round]:
    """One round a pass from the start to the time limit, each with other draws, without end."""
    while True:
        yield _pass(task)


def _pass(task: Task) -> Round:
    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (BATCH, *jnp.shape(x))), task.start)
    parents = np.arange(BATCH)
    plans = np.zeros((BATCH, 0, 6), np.int32)
    won, closest = 0, np.inf
    while plans.shape[1] < task.limit:
        before = plans.shape[1]
        plans = np.concatenate([plans, _continued(task, plans)], axis=1)
        states, *rest = _stretch(task.env, states, parents, plans[:, before:])
        winning, over, steps, distance = (np.asarray(x) for x in rest)
        winners = np.flatnonzero(winning)[np.argsort(steps[winning])]
        won += len(winners)
        candidates = (plans[index, : before + steps[index]] for index in winners)
        actions = next(filter(task.wins, candidates), None)
        going = np.flatnonzero(~over)
        closest = min(closest, distance[going].min(initial=np.inf))
        if actions is not None or not len(going):
            return Round(plans=BATCH, won=won, actions=actions, distance=float(closest))
        rank = distance[going] + NOISE * task.random.gumbel(size=len(going))
        parents = np.resize(going[np.argsort(rank, kind="stable")][:KEPT], BATCH)
        plans = plans[parents]
    return Round(plans=BATCH, won=won, actions=None, distance=float(closest))


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
        state, over, won, steps, _ = carry
        _, state, _, ended, info = step(key, state, actions)
        fresh = ~over
        over = over | ended | info["nan"]
        return (state, over, won | (fresh & info["GoalR"]), steps + fresh, info["distance"]), None

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
