"""Our environment's steps per second on the default device: a JSON line for each row.

Usage: .venv/bin/python scripts/gpu/ours.py [--sizes s m l] [--batches 1024 65536]
[--physics fast balanced]. Bundled levels, random actions, frame_skip 2, flat observations; see
kinetix_env.py beside it for the same of kinetix-env.
"""

from typing import Any

from loop import arguments, loop_of, measure, on_processor, report, started

from kinetix.bench.speed import levels_of
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.level.sizes import parse_capacity
from kinetix.paths import levels_dir


def environment(size: str, observation: str, physics: str) -> tuple[Any, Any, list[Any]]:
    """(the environment, its parameters, states of the bundled levels)."""
    static = static_env_params_from_size(size, physics=physics, frame_skip=2)
    with on_processor():
        files = levels_of(levels_dir(), parse_capacity(size))
        states = [level_state(file, static) for file in files]
    return make_kinetix_env("multi_discrete", observation, None, EnvParams(), static), None, states


def main() -> None:
    """Measure and print."""
    parser = arguments()
    parser.add_argument("--physics", nargs="+", default=["fast", "balanced"])
    options = parser.parse_args()
    for size in options.sizes:
        for physics in options.physics:
            env, params, states = environment(size, "symbolic_flat", physics)
            for batch in options.batches:
                head = {"engine": "ours", "physics": physics, "size": size, "batch": batch}
                loop = loop_of(env, params, batch)
                report(head, measure(loop, started(states, batch), batch, options))


if __name__ == "__main__":
    main()
