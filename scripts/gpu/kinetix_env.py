"""kinetix-env's steps per second on the default device, as ours.py beside it measures ours.

Usage: PYTHON scripts/gpu/kinetix_env.py --levels FOLDER [--sizes s m l] [--batches 1024 65536],
with the interpreter of an environment that has kinetix-env and JAX for the device. FOLDER/s/ and so
on hold levels in its format: `kinetix convert levels/s/circus_act.json FOLDER/s/circus_act.json`.
"""

import functools
import importlib.metadata
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
from loop import arguments, cycled, loop_of, measure, on_processor, report


def take_old_names() -> None:
    """jax2d 1.0.1 calls jnp.clip with names that JAX has given up; they mean the same."""
    clip = jnp.clip

    @functools.wraps(clip)
    def either(
        x: Any = None, /, min: Any = None, max: Any = None, *, a_min: Any = None, a_max: Any = None
    ) -> Any:
        return clip(x, a_min if min is None else min, a_max if max is None else max)

    jnp.clip = either


def main() -> None:
    """Measure and print."""
    parser = arguments()
    parser.add_argument("--levels", type=Path, required=True)
    options = parser.parse_args()
    take_old_names()
    from kinetix.util import load_from_json_file

    from kinetix.environment import ActionType, ObservationType, make_kinetix_env

    version = importlib.metadata.version("kinetix-env")
    for size in options.sizes:
        with on_processor():
            files = sorted((options.levels / size).glob("*.json"))
            found = [load_from_json_file(str(file)) for file in files]
        _, static, params = found[0]
        env = make_kinetix_env(
            action_type=ActionType.MULTI_DISCRETE,
            observation_type=ObservationType.SYMBOLIC_FLAT,
            reset_fn=None,
            env_params=params,
            static_env_params=static.replace(frame_skip=2),
        )
        ways = env.action_space(params).number_of_dims_per_distribution
        states = [jax.tree.map(jnp.asarray, state) for state, _, _ in found]
        for batch in options.batches:
            loop = loop_of(env, params, ways, batch)
            head = {"engine": f"kinetix-env {version}", "size": size, "batch": batch}
            report(head, measure(loop, cycled(states, batch), batch, options))


if __name__ == "__main__":
    main()
