"""kinetix-env's steps per second on the default device, as ours.py beside it measures ours.

Usage: PYTHON scripts/gpu/kinetix_env.py --levels FOLDER [--sizes s m l] [--batches 1024 65536],
with the interpreter of an environment that has kinetix-env and JAX for the device. FOLDER/s/ and so
on hold levels in its format: `kinetix convert levels/s/circus_act.json FOLDER/s/circus_act.json`.
"""

import functools
import importlib.metadata
from pathlib import Path
from typing import Any

import jax.numpy as jnp
from loop import arguments, loop_of, measure, on_processor, report, started


def take_old_names() -> None:
    """jax2d 1.0.1 calls jnp.clip with names that JAX has given up; they mean the same."""
    clip = jnp.clip

    @functools.wraps(clip)
    def either(
        x: Any = None, /, min: Any = None, max: Any = None, *, a_min: Any = None, a_max: Any = None
    ) -> Any:
        return clip(x, a_min if min is None else min, a_max if max is None else max)

    jnp.clip = either


def environment(size: str, observation: str, levels: Path) -> tuple[Any, Any, list[Any]]:
    """(the environment, its parameters, states of the levels)."""
    take_old_names()
    from kinetix.util import load_from_json_file

    from kinetix.environment import ActionType, ObservationType, make_kinetix_env

    with on_processor():
        files = sorted((levels / size).glob("*.json"))
        found = [load_from_json_file(str(file)) for file in files]
    _, static, params = found[0]
    env = make_kinetix_env(
        action_type=ActionType.MULTI_DISCRETE,
        observation_type=ObservationType[observation.upper()],
        reset_fn=None,
        env_params=params,
        static_env_params=static.replace(frame_skip=2),
    )
    return env, params, [state for state, _, _ in found]


def main() -> None:
    """Measure and print."""
    parser = arguments()
    parser.add_argument("--levels", type=Path, required=True)
    options = parser.parse_args()
    version = importlib.metadata.version("kinetix-env")
    for size in options.sizes:
        env, params, states = environment(size, "symbolic_flat", options.levels)
        for batch in options.batches:
            head = {"engine": f"kinetix-env {version}", "size": size, "batch": batch}
            loop = loop_of(env, params, batch)
            report(head, measure(loop, started(states, batch), batch, options))


if __name__ == "__main__":
    main()
