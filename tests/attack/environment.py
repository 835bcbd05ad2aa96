"""Random steps in the bundled levels: nothing becomes NaN, nothing leaves its bounds."""

import functools
import os
from collections.abc import Mapping
from typing import Any

from kinetix.paths import levels_dir
from tests.attack.tally import Tally

WORLDS = 256
STEPS = 256
SIZES = {"s": 8, "m": 4, "l": 1}
"""Tries of each size in a round, WORLDS × STEPS steps at a time; larger ones take longer."""
MOST_MB = 1000.0
"""Memory may grow by so much after the first round."""
_SETTLED: dict[str, float] = {}
"""Memory after the first round of each size [MB]."""
_LARGEST_SPEED = 100.5
"""No body may be faster, in any direction [m/s]."""


@functools.cache
def _rollout(size: str) -> Any:
    """A compiled function from a key to what was seen of so many steps."""
    import jax
    import jax.numpy as jnp

    import kinetix

    static = kinetix.static_env_params_from_size(size)
    params = kinetix.EnvParams()
    # Random levels would be more various, and take minutes to compile.
    levels = [str(path) for path in sorted((levels_dir() / size).glob("*.json"))]
    env = kinetix.make_kinetix_env(
        kinetix.ActionType.CONTINUOUS,
        kinetix.ObservationType.SYMBOLIC_FLAT,
        kinetix.make_reset_fn_list_of_levels(levels, static),
        params,
        static,
    )

    def step(carry, key):
        state, bad = carry
        act, go = jax.random.split(key)
        # Some actions are not allowed: they must do no harm either.
        kind = jax.random.uniform(act, (WORLDS, 1))
        action = jax.random.uniform(act, (WORLDS, 6), minval=-1.0, maxval=1.0)
        action = jnp.where(kind < 0.01, action * 1e30, action)
        observation, state, reward, done, _ = jax.vmap(
            lambda key, state, action: env.step(key, state, action, params)
        )(jax.random.split(go, WORLDS), state, action)
        numbers = (observation, reward, state.bodies.position, state.bodies.velocity)
        sound = jnp.abs(state.bodies.velocity).max((-1, -2)) <= _LARGEST_SPEED
        for array in numbers:
            sound &= jnp.isfinite(array).reshape(WORLDS, -1).all(-1)
        return (state, bad + (~sound).sum()), done.sum()

    def rollout(key):
        first, rest = jax.random.split(key)
        _, state = jax.vmap(lambda key: env.reset(key, params))(jax.random.split(first, WORLDS))
        (_, bad), done = jax.lax.scan(
            step, (state, jnp.zeros((), int)), jax.random.split(rest, STEPS)
        )
        return bad, done.sum()

    return jax.jit(rollout)


def step_at_random(tally: Tally, seed: int, sizes: Mapping[str, int] = SIZES) -> None:
    """Random actions in batches of levels, some of them absurd.

    Args:
        tally: Where the worlds' steps are counted; bad ones have a number that is not finite, or a
            body beyond its largest speed.
        seed: Of the actions and the levels.
        sizes: How often each is tried.
    """
    import jax

    for size, times in sizes.items():
        row = tally.row(f"steps at size {size}")
        for key in jax.random.split(jax.random.key(seed), times):
            bad, episodes = _rollout(size)(key)
            row.tried += WORLDS * STEPS
            row.accepted += WORLDS * STEPS - int(bad)
            if int(bad):
                row.wrong.append(f"seed {seed}: {int(bad)} bad steps")
            if not int(episodes):
                row.wrong.append(f"seed {seed}: no episode has ended")
        more = _resident_mb() - _SETTLED.setdefault(size, _resident_mb())
        if more > MOST_MB:
            row.wrong.append(f"seed {seed}: took {more:.0f} MB more than after the first round")


def _resident_mb() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
