"""Our environment's steps per second on the default device: a JSON line for each row.

Usage: .venv/bin/python scripts/gpu/ours.py [--sizes s m l] [--batches 1024 65536]
[--physics fast balanced]. Bundled levels, random actions, frame_skip 2, flat observations; see
kinetix_env.py beside it for the same of kinetix-env.
"""

from loop import arguments, cycled, loop_of, measure, on_processor, report

from kinetix.bench.speed import level_files
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.level.sizes import parse_capacity
from kinetix.paths import levels_dir


def main() -> None:
    """Measure and print."""
    parser = arguments()
    parser.add_argument("--physics", nargs="+", default=["fast", "balanced"])
    options = parser.parse_args()
    for size in options.sizes:
        files = level_files(levels_dir(), parse_capacity(size))
        for physics in options.physics:
            static = static_env_params_from_size(size, physics=physics, frame_skip=2)
            with on_processor():
                states = [level_state(file, static) for file in files]
            env = make_kinetix_env("multi_discrete", "symbolic_flat", None, EnvParams(), static)
            ways = env.action_space().number_of_dims_per_distribution
            for batch in options.batches:
                loop = loop_of(env, EnvParams(), ways, batch)
                head = {"engine": "ours", "physics": physics, "size": size, "batch": batch}
                report(head, measure(loop, cycled(states, batch), batch, options))


if __name__ == "__main__":
    main()
