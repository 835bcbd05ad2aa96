"""PPO from end to end on the default device, ours or kinetix-env's: a JSON line for each row.

Usage: PYTHON scripts/gpu/ppo.py --engine ours|kinetix-env [--levels FOLDER] [--sizes m]
[--batches 2048 8192], with the interpreter of the engine; see ours.py and kinetix_env.py. Network
`entity`, loss and constants are those of scripts/peers/ppo_loop.py. Several updates are one
program, and what it carries is changed in place; the median of the runs counts.
"""

import functools
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import optax
from jax import Array
from loop import arguments, report, started

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "peers"))

from ppo_loop import GAMMA, LAMBDA, SIZES, Entity, by_part, log_prob, loss

STEPS, MINIBATCHES, EPOCHS, UPDATES, LIMIT = 64, 16, 4, 2, 256


def learner(env: Any, params: Any, count: int) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """(what there is before the first update, several updates)."""
    network = Entity()
    optimiser = optax.chain(optax.clip_by_global_norm(1.0), optax.adam(1e-3, eps=1e-5))
    step = jax.vmap(env.step, in_axes=(0, 0, 0, None, 0))

    def begin(start: Any, key: Array) -> Any:
        # Or all episodes would end in the same step.
        spread = jax.random.randint(key, start.timestep.shape, 0, LIMIT, start.timestep.dtype)
        state = start.replace(timestep=spread)
        seen = jax.vmap(env.get_obs)(state)
        weights = network.init(key, jax.tree.map(lambda x: x[:1], seen))
        return weights, optimiser.init(weights), seen, state, key

    def play(weights: Any, start: Any, carry: Any, key: Array) -> tuple[Any, Any]:
        seen, state = carry
        act_key, step_key = jax.random.split(key)
        logits, value = network.apply(weights, seen)
        keys = jax.random.split(act_key, len(SIZES))
        drawn = [jax.random.categorical(k, p) for k, p in zip(keys, by_part(logits), strict=True)]
        action = jnp.stack(drawn, axis=-1)
        keys = jax.random.split(step_key, count)
        after, state, reward, done, _ = step(keys, state, action, params, start)
        return (after, state), (seen, action, log_prob(logits, action), value, reward, done)

    def advantages(last: Array, value: Array, reward: Array, done: Array) -> Array:
        def back(carry: Any, row: Any) -> Any:
            advantage, following = carry
            value, reward, done = row
            error = reward + GAMMA * following * (1.0 - done) - value
            advantage = error + GAMMA * LAMBDA * (1.0 - done) * advantage
            return (advantage, value), advantage

        rows = (value, reward, done.astype(jnp.float32))
        return jax.lax.scan(back, (jnp.zeros_like(last), last), rows, reverse=True)[1]

    def update(start: Any, carry: Any, _: None) -> tuple[Any, Array]:
        weights, memory, seen, state, key = carry
        key, play_key, learn_key = jax.random.split(key, 3)
        keys = jax.random.split(play_key, STEPS)
        plays = functools.partial(play, weights, start)
        (seen, state), rows = jax.lax.scan(plays, (seen, state), keys)
        looked, action, chosen, value, reward, done = rows
        advantage = advantages(network.apply(weights, seen)[1], value, reward, done)
        batch = (looked, action, chosen, value, advantage, advantage + value)

        def epoch(learnt: Any, key: Array) -> Any:
            order = jax.random.permutation(key, count).reshape(MINIBATCHES, -1)

            def gradient_step(learnt: Any, columns: Array) -> Any:
                weights, memory = learnt
                part = jax.tree.map(lambda x: jnp.take(x, columns, axis=1), batch)
                lost, gradient = jax.value_and_grad(functools.partial(loss, network))(weights, part)
                change, memory = optimiser.update(gradient, memory, weights)
                return (optax.apply_updates(weights, change), memory), lost

            return jax.lax.scan(gradient_step, learnt, order)

        keys = jax.random.split(learn_key, EPOCHS)
        (weights, memory), lost = jax.lax.scan(epoch, (weights, memory), keys)
        return (weights, memory, seen, state, key), lost.mean()

    def updates(start: Any, carry: Any) -> tuple[Any, Array]:
        return jax.lax.scan(functools.partial(update, start), carry, None, UPDATES)

    return begin, updates


def measure(env: Any, params: Any, states: list[Any], count: int, runs: int) -> dict[str, Any]:
    """Rate and compile time."""
    begin, updates = learner(env, params, count)
    start = started(states, count)
    carry = jax.block_until_ready(jax.jit(begin)(start, jax.random.PRNGKey(0)))
    began = time.perf_counter()
    compiled = jax.jit(updates, donate_argnums=1).lower(start, carry).compile()
    compile_s, seconds, lost = time.perf_counter() - began, [], None
    for _ in range(runs + 1):
        began = time.perf_counter()
        carry, lost = jax.block_until_ready(compiled(start, carry))
        seconds.append(time.perf_counter() - began)
    return {
        "env_steps_per_s": round(count * STEPS * UPDATES / statistics.median(seconds[1:])),
        "compile_s": round(compile_s, 1),
        "finite": bool(jnp.isfinite(lost).all()),
        "device": jax.devices()[0].device_kind,
        "jax": jax.__version__,
    }


def main() -> None:
    """Measure and print."""
    parser = arguments()
    parser.set_defaults(sizes=["m"], batches=[2048, 8192])
    parser.add_argument("--engine", choices=["ours", "kinetix-env"], default="ours")
    parser.add_argument("--physics", default="balanced")
    parser.add_argument("--levels", type=Path)
    options = parser.parse_args()
    for size in options.sizes:
        if options.engine == "ours":
            from ours import environment

            made = environment(size, "symbolic_entity", options.physics)
        else:
            from kinetix_env import environment

            made = environment(size, "symbolic_entity", options.levels)
        for count in options.batches:
            head = {"engine": options.engine, "size": size, "environments": count}
            report(head, measure(*made, count, options.runs))


if __name__ == "__main__":
    main()
