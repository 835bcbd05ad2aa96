"""Random play under Stoa, the interface of Stoix: its wrappers reset, batch and count episodes.

Needs `pip install stoa-env`. A Stoix system takes the same environment: where its `make_env` wraps
`KinetixToStoa`, `as_stoa_env` adds that a time limit truncates.
"""

import argparse
from typing import Any

import jax
from stoa import AddRNGKey, AutoResetWrapper, RecordEpisodeMetrics
from stoa.core_wrappers.vmap import VmapWrapper

from kinetix import load_from_json_file, make_kinetix_env, make_reset_fn_list_of_levels
from kinetix.environment.stoa import as_stoa_env
from kinetix.errors import one_sentence


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--level", default="s/goalkeeper")
    parser.add_argument("--worlds", type=int, default=64)
    parser.add_argument("--steps", type=int, default=512)
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()
    for word in ("worlds", "steps"):
        if (count := getattr(arguments, word)) < 1:
            parser.error(f"--{word} {count}: expected at least 1")

    _, static, params = load_from_json_file(arguments.level, physics=arguments.physics)
    reset_fn = make_reset_fn_list_of_levels([arguments.level], static)
    alone = as_stoa_env(
        make_kinetix_env("multi_discrete", "symbolic_flat", reset_fn, params, static)
    )
    env = VmapWrapper(AutoResetWrapper(RecordEpisodeMetrics(AddRNGKey(alone))))
    actions = env.action_space()

    def step(state: Any, key: jax.Array) -> tuple[Any, tuple[jax.Array, ...]]:
        action = jax.vmap(actions.sample)(jax.random.split(key, arguments.worlds))
        state, time_step = env.step(state, action)
        told = time_step.extras
        return state, (time_step.last(), time_step.truncated(), told["solve_rate"])

    reset_key, step_key = jax.random.split(jax.random.key(0))
    state, _ = jax.jit(env.reset)(jax.random.split(reset_key, arguments.worlds))
    keys = jax.random.split(step_key, arguments.steps)
    _, (ended, cut, solved) = jax.jit(lambda state: jax.lax.scan(step, state, keys))(state)
    episodes, won = int(ended.sum()), int((ended & (solved > 0)).sum())
    print(f"{episodes} episodes ended: {won} won, {int(cut.sum())} cut by the time limit")
    assert episodes >= won + int(cut.sum())


if __name__ == "__main__":
    with one_sentence():
        main()
