"""Seconds that the first `env.step` of many worlds takes: compiling it, mostly. For either package.

The job has `size`, `worlds` and `random`: whether episodes begin on random levels, which are then
drawn inside of the step, or all on the same one. What is timed begins when the worlds are there.
"""

import importlib.metadata
import time

import jax
import jax.numpy as jnp
from ppo_loop import is_ours
from protocol import read_job, write_answer

from kinetix.environment import (
    ActionType,
    EnvParams,
    ObservationType,
    UEDParams,
    make_kinetix_env,
    sample_kinetix_level,
    static_env_params_from_size,
)


def main() -> None:
    """Do the job."""
    job, folder = read_job()
    static, params = static_env_params_from_size(job["size"]), EnvParams()
    options = ActionType.MULTI_DISCRETE, ObservationType.SYMBOLIC_FLAT
    engine = make_kinetix_env(*options, None, params, static).physics_engine

    def draw(key: jax.Array) -> object:
        return sample_kinetix_level(key, engine, params, static, UEDParams())

    level = jax.jit(draw)(jax.random.PRNGKey(0))
    env = make_kinetix_env(*options, draw if job["random"] else lambda _: level, params, static)
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
