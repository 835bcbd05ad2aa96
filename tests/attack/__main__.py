"""`make attack`: damage every kind of input for an hour, kill every writer, print the table."""

import argparse
import logging
import os
import random
import shutil
import sys
import tempfile
import time
from pathlib import Path

from tests.attack.mutate import Mutator
from tests.attack.tally import Tally
from tests.attack.targets import TARGETS

_READING_ROUNDS = 20
"""Killing takes a minute, so it is done once in so many rounds of reading."""


def main() -> int:
    """Attack until the time is over; 1 if anything went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3600.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", nargs="*", choices=[*TARGETS, "kills", "environment"])
    parser.add_argument("--keep", type=Path, default=Path("out/attack"))
    options = parser.parse_args()
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    logging.getLogger("absl").setLevel(logging.CRITICAL)  # orbax complains of what is damaged
    tally = Tally(options.keep)
    chosen = options.only or [*TARGETS, "kills", "environment"]
    readers = [name for name in chosen if name in TARGETS]
    random_ = random.Random(options.seed)
    until = time.monotonic() + options.seconds
    rounds = printed = 0
    with tempfile.TemporaryDirectory() as place:
        while time.monotonic() < until:
            folder = Path(place) / str(rounds)
            folder.mkdir()
            for name in readers:
                _attack(tally, name, random_, folder, until)
            if "kills" in chosen and rounds % _READING_ROUNDS == 0:
                from tests.attack.kills import kill_writers

                kill_writers(tally, random_, folder)
            if "environment" in chosen:
                from tests.attack.environment import step_at_random

                step_at_random(tally, random_.getrandbits(31))
            shutil.rmtree(folder)
            rounds += 1
            if time.monotonic() > printed + 60:
                printed = time.monotonic()
                _print(f"\n{rounds} rounds\n{tally.table()}")
    _print(f"\n{tally.table()}")
    return 1 if tally.wrong else 0


def _attack(tally: Tally, name: str, random_: random.Random, folder: Path, until: float) -> None:
    target = TARGETS[name]
    samples = target.samples()
    for k in range(target.weight):
        if time.monotonic() > until:
            return
        own = folder / f"{name.replace(' ', '_')}_{k}"
        own.mkdir()
        data = target.damage(Mutator(random_.getrandbits(64)), random_.choice(samples))
        if name == "command line":
            data = random_.randbytes(8)
        tally.attempt(name, data, lambda data=data, own=own: target.read(data, own))
        shutil.rmtree(own)


def _print(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    raise SystemExit(main())
