"""The loop and its timing for both engines: nothing of either is here."""

import argparse
import json
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

FIRST = 16
"""Steps of the first run, which finds out how many a run must have."""


def arguments() -> argparse.ArgumentParser:
    """Return the options that both have."""
    parser = argparse.ArgumentParser(formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--sizes", nargs="+", default=["s", "m", "l"])
    parser.add_argument("--batches", nargs="+", type=int, default=[1024, 65536])
    parser.add_argument("--seconds", type=float, default=0.5, help="a run lasts at least as long")
    parser.add_argument("--runs", type=int, default=5, help="the median of them counts")
    return parser


def on_processor() -> Any:
    """Levels are loaded by many small operations, which an accelerator is slow at."""
    return jax.default_device(jax.devices("cpu")[0])


def started(states: Sequence[Any], batch: int) -> Any:
    """Return states of one shape, in turn, with a leading axis, on the device."""
    chosen = np.arange(batch) % len(states)
    together = jax.tree.map(lambda *x: np.stack([np.asarray(y) for y in x])[chosen], *states)
    return jax.device_put(together)


def choices_of(env: Any, params: Any) -> Array:
    """Return the number of choices of each part of an action."""
    return jnp.asarray(env.action_space(params).number_of_dims_per_distribution, jnp.int32)


def loop_of(env: Any, params: Any, batch: int) -> Callable[..., Any]:
    """`count` environment steps of a batch; an episode begins again where its world began.

    Args:
        env: Of either engine.
        params: Its parameters.
        batch: Worlds.
    """
    choices = choices_of(env, params)
    step = jax.vmap(env.step, in_axes=(0, 0, 0, None, 0))

    def loop(start: Any, key: Array, count: Array) -> Any:
        def once(_: Array, carry: Any) -> Any:
            key, state, _, total = carry
            key, for_actions, for_steps = jax.random.split(key, 3)
            actions = jax.random.randint(for_actions, (batch, choices.size), 0, choices)
            keys = jax.random.split(for_steps, batch)
            seen, state, reward, _, _ = step(keys, state, actions, params, start)
            return key, state, seen, total + reward

        first = jax.vmap(env.get_obs)(start)
        return jax.lax.fori_loop(0, count, once, (key, start, first, jnp.zeros(batch)))[1:]

    return loop


def measure(loop: Callable[..., Any], start: Any, batch: int, options: Any) -> dict[str, Any]:
    """Rate and compile time of a loop."""
    key = jax.random.PRNGKey(0)
    begin = time.perf_counter()
    compiled = jax.jit(loop).lower(start, key, jnp.int32(1)).compile()
    compile_s = time.perf_counter() - begin

    def run(count: int) -> tuple[float, Any]:
        number = jax.block_until_ready(jnp.int32(count))
        begin = time.perf_counter()
        result = jax.block_until_ready(compiled(start, key, number))
        return time.perf_counter() - begin, result

    run(1)
    steps = FIRST
    while (taken := run(steps)[0]) < options.seconds:
        steps = max(2 * steps, int(1.1 * steps * options.seconds / taken))
    runs = [run(steps) for _ in range(options.runs)]
    return {
        "env_steps_per_s": round(batch * steps / statistics.median(taken for taken, _ in runs)),
        "compile_s": round(compile_s, 1),
        "finite": bool(jnp.isfinite(runs[-1][1][1]).all()),
        "device": jax.devices()[0].device_kind,
        "jax": jax.__version__,
    }


def report(head: dict[str, Any], row: dict[str, Any]) -> None:
    """Print a row."""
    print(json.dumps(head | row), flush=True)
