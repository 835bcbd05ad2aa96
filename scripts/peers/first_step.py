"""Seconds that the first `env.step` of many worlds takes: compiling it, mostly. For either package.

The job has `size`, `worlds` and `random`: whether episodes begin on random levels, which are then
drawn inside of the step, or all on the same one. What is timed begins when the worlds are there.
"""

import importlib.metadata
import time

import jax
import jax.numpy as jnp
from ppo_loop import is_ours, make_env
from protocol import read_job, write_answer

from kinetix.environment import ObservationType


def main() -> None:
    """Do the job."""
    job, folder = read_job()
    env, params = make_env(
        ObservationType.SYMBOLIC_FLAT, "balanced", size=job["size"], random=job["random"]
    )
    keys = jax.random.split(jax.random.PRNGKey(1), job["worlds"])
    _, state = jax.jit(jax.vmap(env.reset, in_axes=(0, None)))(keys, params)
    actions = jax.block_until_ready(jnp.zeros((job["worlds"], 6), jnp.int32))
    began = time.perf_counter()
    step = jax.jit(jax.vmap(env.step, in_axes=(0, 0, 0, None)))
    jax.block_until_ready(step(keys, state, actions, params))
    answer = {
        "seconds": time.perf_counter() - began,
        "engine": "kinetix" if is_ours() else "kinetix-env",
        "jax": importlib.metadata.version("jax"),
    }
    write_answer(folder, answer)


if __name__ == "__main__":
    main()
