"""kinetix-env: its environment and its bare engine on level files in its own format.

The job has `files` (of one size), `batch` and `what`: `env` for an environment step with the flat
observation, `engine` for a physics step. Levels are cycled over the batch; where it has room for
fewer, all are timed batch by batch, and the median counts. Actions are random.
"""

import importlib.metadata
import statistics
from typing import Any

import jax
import jax.numpy as jnp
from jax_timing import SECONDS, stacked, time_loop
from kinetix.util import load_from_json_file
from protocol import read_job, write_answer

from kinetix.environment import ActionType, ObservationType, make_kinetix_env

SHORTEST_SECONDS = 0.1
"""A run is no shorter than about this where many levels share the time of one."""
DRAWN = 16
"""So many actions are drawn beforehand and used in turn, so that drawing them is not timed."""


def levels_of(files: list[str], batch: int) -> tuple[list[Any], Any, Any]:
    """(batches of states with a leading axis, static parameters, parameters)."""
    found = [load_from_json_file(file) for file in files]
    starts = []
    for first in range(0, len(found), batch):
        states = [state for state, _, _ in found[first : first + batch]]
        starts.append(stacked([states[k % len(states)] for k in range(batch)]))
    _, static, params = found[0]
    return starts, static, params


def environment_loop(static: Any, params: Any, batch: int) -> tuple[Any, Any]:
    """Return a loop of env.step, and the actions."""
    env = make_kinetix_env(
        action_type=ActionType.MULTI_DISCRETE,
        observation_type=ObservationType.SYMBOLIC_FLAT,
        reset_fn=None,
        env_params=params,
        static_env_params=static.replace(frame_skip=1),
    )
    space = env.action_space(params)
    keys = jax.random.split(jax.random.PRNGKey(0), (batch, DRAWN))
    actions = jax.vmap(jax.vmap(space.sample))(keys)

    def loop(state: Any, actions: Any, keys: Any, count: jax.Array) -> Any:
        def once(index: jax.Array, carry: Any) -> Any:
            current, _, _ = carry
            step = jax.vmap(env.step, in_axes=(0, 0, 0, None, 0))
            seen, current, reward, _, _ = step(
                keys, current, actions[:, index % DRAWN], params, state
            )
            return current, seen, reward

        first = jax.vmap(env.get_obs)(state)
        start = (state, first, jnp.zeros(keys.shape[0], jnp.float32))
        return jax.lax.fori_loop(0, count[0], once, start)

    return loop, actions


def engine_loop(static: Any, params: Any, batch: int) -> tuple[Any, Any]:
    """Return a loop of the bare engine's step, and the actions."""
    env = make_kinetix_env(
        action_type=ActionType.MULTI_DISCRETE,
        observation_type=ObservationType.SYMBOLIC_FLAT,
        reset_fn=None,
        env_params=params,
        static_env_params=static,
    )
    size = static.num_joints + static.num_thrusters
    actions = jax.random.uniform(jax.random.PRNGKey(0), (batch, DRAWN, size), minval=-1.0)
    actions = actions.at[..., static.num_joints :].set(abs(actions[..., static.num_joints :]))

    def loop(state: Any, actions: Any, keys: Any, count: jax.Array) -> Any:
        del keys

        def once(index: jax.Array, state: Any) -> Any:
            step = jax.vmap(lambda s, a: env.physics_engine.step(s, params, a)[0])
            return step(state, actions[:, index % DRAWN])

        return jax.lax.fori_loop(0, count[0], once, state)

    return loop, actions


def main() -> None:
    """Do the job."""
    job, folder = read_job()
    batch = job["batch"]
    starts, static, params = levels_of(job["files"], batch)
    make = environment_loop if job["what"] == "env" else engine_loop
    loop, actions = make(static, params, batch)
    keys = jax.random.split(jax.random.PRNGKey(1), batch)
    about = max(SECONDS / len(starts), SHORTEST_SECONDS)
    each = [time_loop(loop, batch, states, actions, keys, about=about) for states in starts]
    answer = each[0] | {  # compiled by the first
        "seconds_per_step": statistics.median(told["seconds_per_step"] for told in each)
    }
    versions = {name: importlib.metadata.version(name) for name in ("kinetix-env", "jax2d", "jax")}
    write_answer(folder, answer | {"version": versions["kinetix-env"]} | versions)


if __name__ == "__main__":
    main()
