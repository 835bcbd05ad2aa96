"""Random steps in the bundled levels: nothing becomes NaN, nothing leaves its bounds."""

import functools
from typing import Any

from kinetix.paths import levels_dir
from tests.attack.tally import Tally

WORLDS = 64
STEPS = 256
SIZES = ("s", "m", "l")
"""Tried in turn; the whole of one round has WORLDS × STEPS steps of each."""


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
        bodies = state.bodies
        speed = jnp.abs(bodies.velocity).max()
        bad = bad | ~jnp.isfinite(observation).all() | ~jnp.isfinite(reward).all()
        bad = bad | ~jnp.isfinite(bodies.position).all() | (speed > 100.5)
        return (state, bad), done.sum()

    def rollout(key):
        first, rest = jax.random.split(key)
        _, state = jax.vmap(lambda key: env.reset(key, params))(jax.random.split(first, WORLDS))
        (_, bad), done = jax.lax.scan(
            step, (state, jnp.asarray(False)), jax.random.split(rest, STEPS)
        )
        return bad, done.sum()

    return jax.jit(rollout)


def step_at_random(tally: Tally, seed: int, sizes: tuple[str, ...] = SIZES) -> None:
    """Random actions in batches of levels, some of them absurd."""
    import jax

    for size in sizes:
        row = tally.row(f"steps at size {size}")
        bad, _ = _rollout(size)(jax.random.key(seed))
        row.tried += WORLDS * STEPS
        row.accepted += WORLDS * STEPS
        if bool(bad):
            row.wrong.append(f"seed {seed}: a number that is not finite or out of bounds")
