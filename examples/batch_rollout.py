"""A large batch of random levels, spread over all cores, played with random actions."""

import argparse
import time

import jax

from kinetix import (
    EnvParams,
    make_kinetix_env,
    make_reset_fn_sample_kinetix_level,
    static_env_params_from_size,
    use_all_cores,
    vectorize,
)
from kinetix.errors import one_sentence


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", type=int, default=512)
    parser.add_argument("--steps", type=int, default=128)
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()
    for word in ("worlds", "steps"):
        if (count := getattr(arguments, word)) < 1:
            parser.error(f"--{word} {count}: expected at least 1")
    use_all_cores()  # before the first array: one CPU device does little work in parallel
    devices = jax.local_device_count()
    worlds = -(-arguments.worlds // devices) * devices

    env_params = EnvParams()
    static_env_params = static_env_params_from_size("s", physics=arguments.physics)
    env = make_kinetix_env(
        action_type="multi_discrete",
        observation_type="symbolic_entity",
        reset_fn=make_reset_fn_sample_kinetix_level(env_params, static_env_params),
        env_params=env_params,
        static_env_params=static_env_params,
    )

    many = vectorize(env)

    @jax.jit
    def run(keys):
        """Every device steps its share of the worlds."""
        _, states = many.reset(keys)

        def step(states, index):
            now = jax.vmap(lambda key: jax.random.fold_in(key, index))(keys)
            actions = jax.vmap(env.action_space(env_params).sample)(now)
            _, states, reward, done, _ = many.step(now, states, actions)
            return states, (reward, done)

        rewards, dones = jax.lax.scan(step, states, jax.numpy.arange(arguments.steps))[1]
        return rewards.sum(axis=0), dones.sum(axis=0)

    keys = jax.random.split(jax.random.PRNGKey(0), worlds)
    jax.block_until_ready(run(keys))
    start = time.perf_counter()
    returns, episodes = jax.block_until_ready(run(keys))
    rate = worlds * arguments.steps / (time.perf_counter() - start)
    print(f"{devices} devices, {worlds} worlds: {rate:,.0f} environment steps a second")
    print(f"mean return {returns.mean():.3f}, {int(episodes.sum())} episodes ended")


if __name__ == "__main__":
    with one_sentence():
        main()
