"""A large batch of random levels, spread over all cores, played with random actions."""

import argparse
import os
import time

# One CPU device does little work in parallel, so JAX is given one a core, before it starts.
os.environ.setdefault("JAX_NUM_CPU_DEVICES", str(os.cpu_count() or 1))

import jax

from kinetix import (
    EnvParams,
    make_kinetix_env,
    make_reset_fn_sample_kinetix_level,
    static_env_params_from_size,
)
from kinetix.environment.devices import place, spread


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", type=int, default=512)
    parser.add_argument("--steps", type=int, default=128)
    arguments = parser.parse_args()

    env_params = EnvParams()
    static_env_params = static_env_params_from_size("s")
    env = make_kinetix_env(
        action_type="multi_discrete",
        observation_type="symbolic_entity",
        reset_fn=make_reset_fn_sample_kinetix_level(env_params, static_env_params),
        env_params=env_params,
        static_env_params=static_env_params,
    )

    def rollout(keys):
        """Works on whatever share of the batch a device gets."""
        _, states = jax.vmap(env.reset, in_axes=(0, None))(keys, env_params)

        def step(states, index):
            now = jax.vmap(lambda key: jax.random.fold_in(key, index))(keys)
            actions = jax.vmap(env.action_space(env_params).sample)(now)
            _, states, reward, done, _ = jax.vmap(env.step, in_axes=(0, 0, 0, None))(
                now, states, actions, env_params
            )
            return states, (reward, done)

        rewards, dones = jax.lax.scan(step, states, jax.numpy.arange(arguments.steps))[1]
        return rewards.sum(axis=0), dones.sum(axis=0)

    devices = jax.local_device_count()
    worlds = -(-arguments.worlds // devices) * devices
    keys = place(jax.random.split(jax.random.PRNGKey(0), worlds))
    run = spread(rollout)
    jax.block_until_ready(run(keys))
    start = time.perf_counter()
    returns, episodes = jax.block_until_ready(run(keys))
    rate = worlds * arguments.steps / (time.perf_counter() - start)
    print(f"{devices} devices, {worlds} worlds: {rate:,.0f} environment steps a second")
    print(f"mean return {returns.mean():.3f}, {int(episodes.sum())} episodes ended")


if __name__ == "__main__":
    main()
