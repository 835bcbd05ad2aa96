"""PPO steps per second, ours and kinetix-env's in turn: one loop, see scripts/peers/ppo_loop.py.

Usage: .venv/bin/python scripts/training_speed.py [NETWORK …] [--physics P] > bench/training.jsonl
`make bench-peers` installs kinetix-env; without it only our rows are printed. Of each network there
is also a row for an environment that costs nothing: no environment can be faster in this loop. And
one for `kinetix train` with the same numbers, on all cores, as users have it; where the loop has a
transformer, with our own network of entities.
"""

import argparse
import dataclasses
import json
import statistics
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Final

from kinetix.bench.peers.launch import ENVIRONMENTS, Peer, ask

JOB = {"environments": 256, "steps": 64, "minibatches": 8, "epochs": 4, "updates": 5}
"""As in the preset `small`."""
PEER = Peer(
    name="kinetix-env",
    family="kinetix-env",
    environment="jax2d",
    program="ppo_loop.py",
    settings={},
    compiled=True,
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Ours(Peer):
    """Our own environment, by the same program."""

    @property
    def python(self) -> Any:
        """Our interpreter."""
        return ENVIRONMENTS.parent / ".venv" / "bin" / "python"


OURS = Ours(**(dataclasses.asdict(PEER) | {"name": "kinetix", "family": "kinetix"}))


TRAINED: Final = {
    "flat": (),
    "entity": ("--observation-type", "symbolic_entity", "--kind", "relational"),
}
"""Options of `kinetix train ppo --preset small` by network."""


def trained(network: str, physics: str) -> float:
    """Return steps per second of `kinetix train`: the median over its updates.

    Args:
        network: A name of `TRAINED`.
        physics: Preset or solver.
    """
    steps = JOB["environments"] * JOB["steps"] * 4 * JOB["updates"]
    with tempfile.TemporaryDirectory() as folder:
        command = [str(OURS.python), "-m", "kinetix", "train", "ppo", "--preset", "small"]
        command += ["--physics", physics, "--eval-freq", "0", *TRAINED[network]]
        command += ["--total-timesteps", str(steps), "--out", f"{folder}/run"]
        subprocess.run(command, check=True, capture_output=True)
        rows = (Path(folder) / "run" / "metrics.jsonl").read_text().splitlines()
    return statistics.median(json.loads(row)["timing/sps"] for row in rows)


def main() -> None:
    """Measure and print a row a figure, then the ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("networks", nargs="*", default=["flat", "entity"])
    parser.add_argument("--physics", default="balanced")
    options = parser.parse_args()
    for network in options.networks:
        speed = {}
        for name, peer in (("ours", OURS), ("free", OURS), ("theirs", PEER)):
            if not peer.installed:
                continue
            job = JOB | {"network": network, "physics": options.physics, "free": name == "free"}
            told = ask(peer, job).told
            speed[name] = told["steps_per_s"]
            print(json.dumps({**job, **told}), flush=True)
        speed["trained"] = trained(network, options.physics)
        print(json.dumps({"network": network, "trained_steps_per_s": speed["trained"]}), flush=True)
        if "theirs" in speed:
            ratios = {
                "ratio": speed["ours"] / speed["theirs"],
                "ratio_of_a_free_environment": speed["free"] / speed["theirs"],
                "ratio_of_kinetix_train": speed["trained"] / speed["theirs"],
            }
            print(json.dumps({"network": network, **ratios}), flush=True)


if __name__ == "__main__":
    main()
