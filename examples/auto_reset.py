"""Many episodes of random levels in one compiled loop: where one ends, the next begins."""

import argparse

import jax
import jax.numpy as jnp

from kinetix import (
    EnvParams,
    LogWrapper,
    make_kinetix_env,
    make_reset_fn_sample_kinetix_level,
    static_env_params_from_size,
)
from kinetix.errors import one_sentence


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", type=int, default=16)
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()
    for word in ("worlds", "steps"):
        if (count := getattr(arguments, word)) < 1:
            parser.error(f"--{word} {count}: expected at least 1")

    env_params = EnvParams()
    static_env_params = static_env_params_from_size("s", physics=arguments.physics)
    env = LogWrapper(
        make_kinetix_env(
            action_type="continuous",
            observation_type="symbolic_flat",
            reset_fn=make_reset_fn_sample_kinetix_level(env_params, static_env_params),
            env_params=env_params,
            static_env_params=static_env_params,
            auto_reset=True,
        )
    )

    def step(state, key):
        act_key, step_key = jax.random.split(key)
        keys = jax.random.split(act_key, arguments.worlds)
        action = jax.vmap(env.action_space(env_params).sample)(keys)
        keys = jax.random.split(step_key, arguments.worlds)
        _, state, _, done, info = jax.vmap(env.step, in_axes=(0, 0, 0, None))(
            keys, state, action, env_params
        )
        return state, (done, info["GoalR"], info["returned_episode_lengths"])

    @jax.jit
    def play(key):
        reset_key, key = jax.random.split(key)
        keys = jax.random.split(reset_key, arguments.worlds)
        _, state = jax.vmap(env.reset, in_axes=(0, None))(keys, env_params)
        return jax.lax.scan(step, state, jax.random.split(key, arguments.steps))[1]

    done, goal, lengths = play(jax.random.PRNGKey(0))
    episodes = int(done.sum())
    mean = jnp.where(done, lengths, 0).sum() / max(episodes, 1)
    print(f"{episodes} episodes, {int((goal & done).sum())} won, {mean:.1f} steps on average")


if __name__ == "__main__":
    with one_sentence():
        main()
