"""Futures: groups of plans played on the simulator, each from a state, on all devices at once.

The first plans of a group are played as they are. The others are a beam: after every stretch its
attempts continue from the best states of the group, each with its own actions. The beam finds
solutions that need many small correct actions; whole plans find those that need few.
"""

import dataclasses
import functools
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.environment.devices import devices_for, in_shares
from kinetix.environment.env import KinetixEnv
from kinetix.environment.goal import BLUE, GREEN
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree

STRETCH: Final = 16
"""Environment steps between two choices of what the beam goes on from."""
LOST: Final = 10.0
"""Worth of a loss when plans are ranked [m of distance]."""
LATE: Final = 0.004
"""Worth of an environment step [m of distance]."""
WON: Final = -1000.0
WAY: Final = 32
"""Places that are noted of a way."""
EVERY: Final = 2
"""Environment steps between two of them."""
_MOVING: Final = ("physics", "timestep", "last_distance")


@pytree
class Futures:
    """Results of plans; axes: group, plan of the group."""

    plans: Int[Array, "g n t 6"]
    """Plans as they were played: of the beam, not what was proposed."""
    score: Float[Array, "g n"]
    """The less the better; below 0 only where the plan won."""
    won: Bool[Array, "g n"]
    lost: Bool[Array, "g n"]
    steps: Int[Array, "g n"]
    """Environment steps until it ended."""
    ways: Float[Array, "g n k 2"]
    """Way of the green body (of the blue one where that cannot move), every few steps; it stays
    where the plan ends [m]."""


@pytree
class _Attempts:
    """Plans on their way."""

    plans: Int[Array, "g n t 6"]
    moving: dict[str, Any]
    over: Bool[Array, "g n"]
    won: Bool[Array, "g n"]
    lost: Bool[Array, "g n"]
    steps: Int[Array, "g n"]
    distance: Float[Array, "g n"]
    """Now [m]."""
    least: Float[Array, "g n"]
    """Least of distance plus `LATE` per step so far [m]."""
    ways: Float[Array, "g n k 2"]


def play_futures(
    env: KinetixEnv,
    states: EnvState,
    plans: Int[Array, "g n t 6"],
    noise: Float[Array, "g n s"],
    wholes: Int[Array, " g"],
    stretches: Int[Array, ""],
) -> Futures:
    """Play groups of plans, each group until one of it has won.

    Args:
        env: The environment, without auto-reset.
        states: Where the plans of each group begin.
        plans: Proposals; the length is a multiple of `STRETCH`.
        noise: Added to the distances by which the beam chooses, per stretch [m].
        wholes: Plans of each group before its beam begins.
        stretches: How many stretches of the plans are played.
    """
    run = functools.partial(_run, env)
    alone = bool(jax.sharding.get_abstract_mesh().manual_axes)
    devices = jax.local_devices()[:1] if alone else devices_for(plans.shape[0])
    return in_shares(run, replicated=(4,), devices=devices)(states, plans, noise, wholes, stretches)


def best_first(score: Float[Array, " n"]) -> Int[Array, " n"]:
    """Return the indices of the least, the second least and so on.

    There are few, and a sort would take longer to compile.
    """
    index = jnp.arange(score.shape[0])
    ties = (score[None] == score[:, None]) & (index[None] < index[:, None])
    place = jnp.sum((score[None] < score[:, None]) | ties, axis=1)
    return jnp.argmax(place[None] == index[:, None], axis=1)


def _run(
    env: KinetixEnv,
    states: EnvState,
    plans: Int[Array, "g n t 6"],
    noise: Float[Array, "g n s"],
    wholes: Int[Array, " g"],
    stretches: Int[Array, ""],
) -> Futures:
    groups, count = plans.shape[:2]
    moving = jax.tree.map(
        # Strong types, so that loops can carry them.
        lambda x: jnp.repeat(jnp.asarray(x, jnp.result_type(x))[:, None], count, axis=1),
        {name: getattr(states, name) for name in _MOVING},
    )
    no = jnp.zeros((groups, count), bool)
    far = jnp.full((groups, count), jnp.inf, jnp.float32)
    begins = _shown(states, states.physics.position[:, None])[:, :, None]
    begun = _Attempts(
        plans=plans,
        moving=moving,
        over=no,
        won=no,
        lost=no,
        steps=jnp.zeros((groups, count), jnp.int32),
        distance=far,
        least=far,
        ways=jnp.broadcast_to(begins, (groups, count, WAY, 2)).astype(jnp.float32),
    )

    def going_on(loop: tuple[Array, _Attempts]) -> Array:
        index, attempts = loop
        settled = jnp.any(attempts.won, axis=1) | jnp.all(attempts.over, axis=1)
        return (index < stretches) & ~jnp.all(settled)

    def stretch(loop: tuple[Array, _Attempts]) -> tuple[Array, _Attempts]:
        index, attempts = loop
        attempts = _chosen(attempts, index, noise, wholes)
        advance = functools.partial(_advance, env, states, index * STRETCH)
        return index + 1, jax.lax.fori_loop(0, STRETCH, advance, attempts)

    _, ended = jax.lax.while_loop(going_on, stretch, (jnp.int32(0), begun))
    steps = ended.steps.astype(jnp.float32)
    ranked = ended.least + ended.lost * (LOST - LATE * steps)
    return Futures(
        plans=ended.plans,
        score=jnp.where(ended.won, WON + steps, ranked),
        won=ended.won,
        lost=ended.lost,
        steps=ended.steps,
        ways=ended.ways,
    )


def _advance(
    env: KinetixEnv, states: EnvState, before: Array, index: Array, attempts: _Attempts
) -> _Attempts:
    """Play one environment step of every attempt."""
    t = before + index
    actions = jax.lax.dynamic_index_in_dim(attempts.plans, t, axis=2, keepdims=False)
    key = jax.random.key(0)  # nothing in a step of one level is random

    def step(
        state: EnvState, moving: dict[str, Any], action: Array
    ) -> tuple[dict[str, Any], Array, dict[str, Any]]:
        _, after, _, done, info = env.step(key, dataclasses.replace(state, **moving), action)
        return {name: getattr(after, name) for name in _MOVING}, done, info

    steps = jax.vmap(jax.vmap(step, in_axes=(None, 0, 0)))
    moving, done, info = steps(states, attempts.moving, actions.astype(jnp.int32))
    # What comes after the first win of a group is not played, whatever other groups do.
    fresh = ~attempts.over & ~jnp.any(attempts.won, axis=1, keepdims=True)
    broken = info["nan"] | ~jnp.isfinite(info["distance"])
    distance = jnp.where(fresh & ~broken, info["distance"], attempts.distance)
    least = jnp.minimum(attempts.least, distance + LATE * t)
    # All later places too: what ends stays where it is.
    later = jnp.arange(WAY) * EVERY > t
    place = _shown(states, moving["physics"].position)[:, :, None]
    return dataclasses.replace(
        attempts,
        moving=moving,
        over=attempts.over | (fresh & (done | broken)),
        won=attempts.won | (fresh & info["GoalR"]),
        lost=attempts.lost | (fresh & ((info["terminated"] & ~info["GoalR"]) | broken)),
        steps=attempts.steps + fresh,
        distance=distance,
        least=jnp.where(fresh, least, attempts.least),
        ways=jnp.where(fresh[..., None, None] & later[:, None], place, attempts.ways),
    )


def _shown(states: EnvState, position: Float[Array, "g n b 2"]) -> Float[Array, "g n 2"]:
    """Return the place of the body with the path: green or blue, the first that can move."""
    role, bodies = states.labels.role, states.world.bodies
    moves = bodies.active & (bodies.inverse_mass > 0)
    green = (role == GREEN) & bodies.active
    rank = 3 * (green & moves) + 2 * ((role == BLUE) & moves) + green
    first = jnp.arange(role.shape[1]) == jnp.argmax(rank, axis=1)[:, None]
    return jnp.sum(position * first[:, None, :, None], axis=2)


def _chosen(
    attempts: _Attempts, index: Array, noise: Float[Array, "g n s"], wholes: Int[Array, " g"]
) -> _Attempts:
    """The attempts that go on: in the beam, those of the group that are nearest to the goal."""
    count, length = attempts.plans.shape[1:3]
    kept = max(count // 8, 1)
    column = jnp.arange(count)
    past = jnp.arange(length)[:, None] < index * STRETCH

    def one(group: _Attempts, noise: Float[Array, " n"], whole: Int[Array, ""]) -> _Attempts:
        rank = best_first(jnp.where(group.over, jnp.inf, group.distance + noise))
        beam = (column >= whole) & (index > 0) & ~jnp.all(group.over)
        alive = jnp.maximum(jnp.minimum(jnp.sum(~group.over), kept), 1)
        parents = jnp.where(beam, rank[column % alive], column)
        taken = jax.tree.map(lambda x: x[parents], group)
        return dataclasses.replace(taken, plans=jnp.where(past, taken.plans, group.plans))

    now = jax.lax.dynamic_index_in_dim(noise, index, axis=2, keepdims=False)
    return jax.vmap(one)(attempts, now, wholes)
