"""PPO steps per second, ours and kinetix-env's in turn: one loop, see scripts/peers/ppo_loop.py.

Usage: .venv/bin/python scripts/training_speed.py [NETWORK …] [--physics P] > bench/training.jsonl
`make bench-peers` installs kinetix-env; without it only our rows are printed. Of each network there
is also a row for an environment that costs nothing: no environment can be faster in this loop.
"""

import argparse
import dataclasses
import json
from typing import Any

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
        if "theirs" in speed:
            ratios = {
                "ratio": speed["ours"] / speed["theirs"],
                "ratio_of_a_free_environment": speed["free"] / speed["theirs"],
            }
            print(json.dumps({"network": network, **ratios}), flush=True)


if __name__ == "__main__":
    main()
