"""`make attack`: damage every kind of input, kill every writer, step at random, print the table.

make attack                                             an hour of everything, by turns
make attack ARGS="--seconds 600 --seed 3"
make attack ARGS="--inputs 1000000 --kills 2000 --steps 100000000"    until so much was tried
make attack ARGS="--inputs 100000 --only 'schema beside reader'"

Ctrl+C and SIGTERM end it early, with what was counted until then.
"""

import argparse
import functools
import json
import logging
import math
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from tests.attack.mutate import Mutator
from tests.attack.tally import Tally
from tests.attack.targets import TARGETS

_PRINT_SECONDS = 60.0
Round = Callable[[Tally, random.Random, Path], None]


def main() -> int:
    """Attack until enough was tried, or the time is over; 1 if anything went wrong."""
    options = _options()
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    logging.getLogger("absl").setLevel(logging.CRITICAL)  # orbax complains of what is damaged
    tally, random_ = Tally(options.keep), random.Random(options.seed)
    rounds: dict[str, Round] = {
        "inputs": lambda *to: damage_inputs(*to, options.only or list(TARGETS)),
        "kills": _kill,
        "steps": _step,
    }
    goals = {name: getattr(options, name) for name in rounds}
    given = options.seconds is not None or any(goal is not None for goal in goals.values())
    seconds = options.seconds or (math.inf if given else 3600.0)
    if all(goal is None for goal in goals.values()):
        goals = dict.fromkeys(rounds, math.inf) if not options.only else {"inputs": math.inf}
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        _attack(tally, random_, options, rounds, goals, time.monotonic() + seconds)
    except KeyboardInterrupt:
        _print("\nended early")
    _print(f"\n{tally.table()}")
    _store(options.report, tally, options.seed)
    return 1 if tally.wrong else 0


def _attack(
    tally: Tally,
    random_: random.Random,
    options: argparse.Namespace,
    rounds: Mapping[str, Round],
    goals: Mapping[str, float | None],
    until: float,
) -> None:
    """Alternate the attacks until every goal is reached or the time is over."""
    began = printed = time.monotonic()
    tried = dict.fromkeys(goals, 0)
    spent = dict.fromkeys(goals, 0.0)
    with tempfile.TemporaryDirectory() as place:
        while (start := time.monotonic()) < until:
            left = [name for name, goal in goals.items() if goal and tried[name] < goal]
            if not left:
                break
            name = min(left, key=spent.__getitem__)  # each gets the same share of the time
            before = tally.tried
            folder = Path(place) / str(before)
            folder.mkdir(exist_ok=True)
            rounds[name](tally, random_, folder)
            shutil.rmtree(folder)
            tried[name] += tally.tried - before
            spent[name] += time.monotonic() - start
            if time.monotonic() > printed + _PRINT_SECONDS:
                printed = time.monotonic()
                _print(f"\n{printed - began:.0f} s\n{tally.table()}")
                _store(options.report, tally, options.seed)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="tests.attack", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seconds", type=float, help="by default 3600 where nothing is counted")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--inputs", type=int, help="damaged inputs to be read")
    parser.add_argument("--kills", type=int, help="of processes that write")
    parser.add_argument("--steps", type=int, help="of environments, over the sizes s, m and l")
    parser.add_argument("--only", nargs="*", choices=TARGETS, help="readers")
    parser.add_argument("--keep", type=Path, default=Path("out/attack"), help="what did harm")
    parser.add_argument("--report", type=Path, help="the table as JSON")
    return parser.parse_args()


def damage_inputs(tally: Tally, random_: random.Random, folder: Path, names: list[str]) -> None:
    """Attack each reader as often as its weight says."""
    for name in names:
        target = TARGETS[name]
        samples = target.samples()
        for k in range(target.weight):
            own = folder / f"{name.replace(' ', '_')}_{k}"
            own.mkdir()
            data = target.damage(Mutator(random_.getrandbits(64)), random_.choice(samples))
            tally.attempt(name, data, functools.partial(target.read, data, own))
            shutil.rmtree(own)


def _kill(tally: Tally, random_: random.Random, folder: Path) -> None:
    from tests.attack.kills import kill_writers

    kill_writers(tally, random_, folder)


def _step(tally: Tally, random_: random.Random, folder: Path) -> None:
    from tests.attack.environment import step_at_random

    step_at_random(tally, random_.getrandbits(31))


def _store(path: Path | None, tally: Tally, seed: int) -> None:
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"seed": seed, "rows": tally.as_dict()}, indent=1) + "\n")


def _print(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    raise SystemExit(main())
