"""Prioritised replay with jaxued's own level buffer: levels that random play sometimes wins.

Needs `pip install jaxued six` (its gymnax imports six without asking for it).
"""

import argparse
from typing import Any

import jax
import jax.numpy as jnp

# jaxued 0.0.1 calls a name that JAX has dropped.
jax.tree_map = jax.tree.map
from jaxued.level_sampler import LevelSampler  # noqa: E402

from kinetix import (  # noqa: E402
    EnvParams,
    make_kinetix_env,
    make_reset_fn_sample_kinetix_level,
    static_env_params_from_size,
)
from kinetix.environment.jaxued import as_underspecified_env  # noqa: E402
from kinetix.errors import one_sentence  # noqa: E402


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--levels", type=int, default=64)
    parser.add_argument("--attempts", type=int, default=8)
    parser.add_argument("--steps", type=int, default=256)
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()
    for word in ("levels", "attempts", "steps"):
        if (count := getattr(arguments, word)) < 1:
            parser.error(f"--{word} {count}: expected at least 1")

    params, static = EnvParams(), static_env_params_from_size("s", physics=arguments.physics)
    env = as_underspecified_env(
        make_kinetix_env("multi_discrete", "symbolic_flat", None, params, static)
    )
    draw = jax.jit(jax.vmap(make_reset_fn_sample_kinetix_level(params, static)))

    def attempt(level: Any, key: jax.Array) -> jax.Array:
        """Return whether random play wins a level."""
        key, reset_key = jax.random.split(key)
        _, state = env.reset_to_level(reset_key, level, params)

        def step(carry: tuple[Any, ...], key: jax.Array) -> tuple[tuple[Any, ...], None]:
            state, alive, won = carry
            action = env.action_space(params).sample(key)
            _, state, _, done, info = env.step(key, state, action, params)
            return (state, alive & ~done, won | (alive & info["GoalR"])), None

        start = (state, jnp.array(True), jnp.array(False))
        keys = jax.random.split(key, arguments.steps)
        return jax.lax.scan(step, start, keys)[0][2]

    @jax.jit
    def learnability(levels: Any, key: jax.Array) -> jax.Array:
        """p(1 − p) of each level, p the share of attempts that win it."""
        keys = jax.random.split(key, (arguments.levels, arguments.attempts))
        won = jax.vmap(jax.vmap(attempt, in_axes=(None, 0)))(levels, keys)
        rate = won.mean(axis=1)
        return rate * (1 - rate)

    level_key, score_key, replay_key = jax.random.split(jax.random.key(0), 3)
    levels = draw(jax.random.split(level_key, arguments.levels))
    scores = learnability(levels, score_key)

    buffer = LevelSampler(arguments.levels // 2)
    first = jax.tree.map(lambda x: x[0], levels)
    sampler = buffer.initialize(first, {"score": jnp.zeros(())})
    sampler, _ = buffer.insert_batch(sampler, levels, scores, {"score": scores})
    sampler, (index, replayed) = buffer.sample_replay_levels(sampler, replay_key, 8)
    print(f"{int((scores > 0).sum())} of {arguments.levels} levels are won sometimes")
    print(f"replayed: {index.tolist()}, scores {sampler['scores'][index].round(3).tolist()}")
    assert replayed.timestep.shape == (8,)


if __name__ == "__main__":
    with one_sentence():
        main()
