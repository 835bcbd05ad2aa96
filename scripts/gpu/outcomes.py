"""Compare how episodes end on a GPU and on the processor, and count NaN in random play.

Usage: .venv/bin/python scripts/gpu/outcomes.py [--sizes s m l] [--physics balanced] [--million 100]
Every bundled level is played 16 times with random actions that are held for eight steps, the same
on both; then so many million physics steps are played at random on the default device.
"""

import argparse
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from loop import choices_of, started
from ours import environment

COPIES, LENGTH, HELD, BATCH, ROUND = 16, 256, 8, 65536, 64


def outcomes(env: Any, start: Any) -> tuple[Array, Array, Array]:
    """(won, lost, how long) of the first episode of each world."""
    choices = choices_of(env, None)
    count = start.timestep.shape[0]

    def once(carry: Any, turn: Array) -> tuple[Any, None]:
        state, going, won, lost, length = carry
        key = jax.random.fold_in(jax.random.PRNGKey(5), turn // HELD)
        action = jax.random.randint(key, (count, choices.size), 0, choices)
        step = jax.vmap(env.step, in_axes=(None, 0, 0, None, 0))
        _, state, _, done, info = step(key, state, action, None, start)
        ends = going & done
        won, lost = won | (ends & info["GoalR"]), lost | (ends & info["terminated"])
        return (state, going & ~done, won, lost & ~won, length + going), None

    no = jnp.zeros(count, bool)
    carry = (start, ~no, no, no, jnp.zeros(count, jnp.int32))
    _, _, *told = jax.lax.scan(once, carry, jnp.arange(LENGTH))[0]
    return tuple(told)


def nans(env: Any, start: Any, key: Array) -> Array:
    """Count the NaN in some steps of random play."""
    choices, count = choices_of(env, None), start.timestep.shape[0]

    def once(carry: Any, key: Array) -> tuple[Any, Array]:
        action = jax.random.randint(key, (count, choices.size), 0, choices)
        step = jax.vmap(env.step, in_axes=(None, 0, 0, None, 0))
        _, state, _, _, info = step(key, carry, action, None, start)
        return state, jnp.sum(info["nan"])

    return jnp.sum(jax.lax.scan(once, start, jax.random.split(key, ROUND))[1])


def main() -> None:
    """Play and print."""
    parser = argparse.ArgumentParser(formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--sizes", nargs="+", default=["s", "m", "l"])
    parser.add_argument("--physics", default="balanced")
    parser.add_argument("--million", type=int, default=100, help="physics steps of random play")
    parser.add_argument("--batch", type=int, default=BATCH)
    options = parser.parse_args()
    here, processor = jax.devices()[0], jax.devices("cpu")[0]
    for size in options.sizes:
        env, _, states = environment(size, "symbolic_flat", options.physics)
        start = started(states, COPIES * len(states))
        play = jax.jit(lambda start, env=env: outcomes(env, start))
        one, other = (
            [np.asarray(x) for x in play(jax.device_put(start, device))]
            for device in (here, processor)
        )
        same = (one[0] == other[0]) & (one[1] == other[1])
        print(
            f"{size} {here.device_kind}: of {len(same)} episodes {same.sum()} end alike, "
            f"{(one[2] == other[2]).sum()} at the same step; won {one[0].mean():.3f}, "
            f"lost {one[1].mean():.3f}",
            flush=True,
        )
        start = started(states, options.batch)
        count = jax.jit(lambda start, key, env=env: nans(env, start, key))
        rounds = -(-options.million * 1_000_000 // (2 * options.batch * ROUND))
        found = sum(int(count(start, jax.random.PRNGKey(turn))) for turn in range(rounds))
        print(f"{size}: {rounds * 2 * options.batch * ROUND} physics steps, NaN in {found}")


if __name__ == "__main__":
    main()
