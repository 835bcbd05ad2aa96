"""PPO from end to end on the default device, ours or kinetix-env's: a JSON line for each row.

Usage: PYTHON scripts/gpu/ppo.py --engine ours|kinetix-env [--levels FOLDER] [--sizes m]
[--batches 2048 8192], with the interpreter of the engine; see ours.py and kinetix_env.py. Network
`entity` and what is learnt are those of scripts/peers/ppo_loop.py. Several updates are one
program, and what it carries is changed in place; the median of the runs counts.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array
from loop import arguments, report, started

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "peers"))

from ppo_loop import OPTIMISER, Entity, update

JOB = {"steps": 64, "minibatches": 16, "epochs": 4}
UPDATES, LIMIT = 2, 256


def learner(env: Any, params: Any) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """(what there is before the first update, several updates)."""
    network = Entity()

    def begin(start: Any, key: Array) -> Any:
        # Or all episodes would end in the same step.
        spread = jax.random.randint(key, start.timestep.shape, 0, LIMIT, start.timestep.dtype)
        state = start.replace(timestep=spread)
        seen = jax.vmap(env.get_obs)(state)
        weights = network.init(key, jax.tree.map(lambda x: x[:1], seen))
        return weights, OPTIMISER.init(weights), seen, state, key

    def updates(start: Any, carry: Any) -> tuple[Any, Array]:
        def step(keys: Array, _: Any, state: Any, action: Array) -> Any:
            many = jax.vmap(env.step, in_axes=(0, 0, 0, None, 0))
            return many(keys, state, action, params, start)

        return jax.lax.scan(lambda c, _: update(network, step, JOB, c), carry, None, UPDATES)

    return begin, updates


def measure(env: Any, params: Any, states: list[Any], count: int, runs: int) -> dict[str, Any]:
    """Measure the rate and the compile time."""
    begin, updates = learner(env, params)
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
        "env_steps_per_s": round(count * JOB["steps"] * UPDATES / statistics.median(seconds[1:])),
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
