"""Seconds until the first `env.step` is there, ours and kinetix-env's in turn, without a cache.

Usage: python -m scripts.compile_time [SIZE …] [--worlds N] [--runs N] > bench/compile.jsonl
`make bench-peers` installs kinetix-env; without it only our rows are printed. See
scripts/peers/first_step.py.
"""

import argparse
import dataclasses
import json
import statistics

from kinetix.bench.peers.launch import ask
from scripts.training_speed import OURS, PEER

PROGRAM = "first_step.py"
NO_CACHE = {"JAX_ENABLE_COMPILATION_CACHE": "false"}


def main() -> None:
    """Measure and print a row a run, then the ratios of the medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sizes", nargs="*", default=["s", "m", "l"])
    parser.add_argument("--worlds", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    peers = [dataclasses.replace(peer, program=PROGRAM) for peer in (OURS, PEER) if peer.installed]
    for size in options.sizes:
        for random in (False, True):
            job = {"size": size, "worlds": options.worlds, "random": random}
            seconds: dict[str, list[float]] = {peer.name: [] for peer in peers}
            for _ in range(options.runs):
                for peer in peers:
                    told = ask(peer, job, variables=NO_CACHE).told
                    seconds[peer.name].append(told["seconds"])
                    print(json.dumps({**job, **told}), flush=True)
            medians = {name: statistics.median(taken) for name, taken in seconds.items()}
            if len(medians) > 1:
                ratio = medians[OURS.name] / medians[PEER.name]
                print(json.dumps({**job, "medians": medians, "ratio": ratio}), flush=True)


if __name__ == "__main__":
    main()
