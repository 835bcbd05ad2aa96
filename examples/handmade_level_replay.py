"""Open a hand-made level, play its recorded solution (or nothing), and say how it ends."""

import argparse
import dataclasses

import jax
import jax.numpy as jnp

from kinetix import load_from_json_file, load_level, make_kinetix_env
from kinetix.errors import one_sentence


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--level", default="s/first_flight")
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()

    level, static_env_params, env_params = load_from_json_file(
        arguments.level, physics=arguments.physics
    )
    solution = load_level(arguments.level).solution
    if solution is not None:
        # A recorded action lasts as many engine steps as it did when it was recorded.
        static_env_params = dataclasses.replace(static_env_params, frame_skip=solution.frame_skip)
    env = make_kinetix_env(
        action_type="multi_discrete",
        observation_type="symbolic_entity",
        reset_fn=None,
        env_params=env_params,
        static_env_params=static_env_params,
        auto_reset=False,
    )
    noop = [(0, 0, 0, 0, 0, 0)] * env_params.max_timesteps
    actions = jnp.array(noop if solution is None else list(solution.unrolled()))

    def step(state, action):
        _, state, reward, done, info = env.step(jax.random.PRNGKey(0), state, action, env_params)
        return state, (reward, done, info["GoalR"])

    _, state = env.reset(jax.random.PRNGKey(0), env_params, level)
    _, (rewards, dones, won) = jax.jit(lambda s, a: jax.lax.scan(step, s, a))(state, actions)
    last = int(dones.argmax()) if dones.any() else len(actions) - 1
    outcome, total = "won" if won[last] else "not won", rewards[: last + 1].sum()
    print(f"{arguments.level}: {outcome} after {last + 1} steps, return {total:.3f}")


if __name__ == "__main__":
    with one_sentence():
        main()
