"""Every writer is killed at random moments: what it writes is the old or the new, and whole.

`python -m tests.attack.kills --writer level --kills 100` forks a child that writes without end,
kills it (SIGKILL), looks at what is there from another child, and goes on. The process itself never
starts JAX, whose threads no fork would survive.
"""

import argparse
import contextlib
import ctypes
import importlib
import json
import logging
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.attack.clock import OwnClock, ended
from tests.attack.tally import Tally
from tests.attack.writers import WRITERS, Writer

_STARTING = 0.2
"""Share of the kills that do not wait until a child has begun to write."""
_PR_SET_PDEATHSIG = 1
_LONGEST_START = 1200.0
"""A child that has not begun after so long by its own clock is a fault [s]."""
_LONGEST_READ = 600.0
"""Nor may a child take longer that ends by itself [s]."""


def kill_writers(
    tally: Tally, random_: random.Random, folder: Path, names: tuple[str, ...] = ()
) -> None:
    """Kill every writer some times, each in a process of its own that knows no JAX yet."""
    for name in names or WRITERS:
        place = folder / f"kills_{name.replace(' ', '_')}"
        place.mkdir(parents=True)
        command = [sys.executable, "-m", "tests.attack.kills", "--writer", name]
        command += ["--kills", str(WRITERS[name].kills), "--folder", str(place)]
        command += ["--seed", str(random_.getrandbits(31))]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        row = tally.row(f"kills: {name}")
        if done.returncode:
            row.wrong.append(done.stderr.strip().splitlines()[-1][:300])
            continue
        told = json.loads(done.stdout.splitlines()[-1])
        row.tried += told["kills"]
        row.accepted += told["whole"]
        row.wrong += told["wrong"]


@contextlib.contextmanager
def _child(work: Callable[[], None]) -> Iterator[int]:
    """Fork a process that does some work and ends; gives its id, and waits for it.

    Raises:
        TimeoutError: It has not ended after `_LONGEST_READ` seconds of its own clock.
    """
    child = os.fork()
    if child == 0:
        status = 1
        try:
            ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)  # nobody writes on alone
            work()
            status = 0
        except BaseException as error:
            os.write(2, f"{type(error).__name__}: {str(error)[-300:]}\n".encode())
        finally:
            os._exit(status)
    yield child
    in_time = ended(child, _LONGEST_READ)
    os.waitpid(child, 0)
    if not in_time:
        raise TimeoutError(f"a child has not ended after {_LONGEST_READ:g} s")


def _asked(question: Callable[[], int | None]) -> tuple[int | None, str]:
    """Return what a child found out, or what went wrong in it."""
    with tempfile.TemporaryFile("w+") as answer:

        def work() -> None:
            try:
                told = [question(), ""]
            except BaseException as error:
                told = [None, f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"]
            answer.write(json.dumps(told))
            answer.flush()

        try:
            with _child(work):
                pass
        except TimeoutError as error:
            return None, str(error)
        answer.seek(0)
        found, wrong = json.loads(answer.read() or '[null, "the child died"]')
        return found, wrong


def _write_for_ever(writer: Writer, folder: Path, number: int) -> None:
    while True:
        number += 1
        writer.write(folder, number)


def _await(writer: Writer, folder: Path, child: int, before: object) -> str:
    """Wait until a child has begun to write; returns what is wrong with it."""
    clock = OwnClock(child)
    while writer.begun is not None and writer.begun(folder) == before:
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            return "the writer failed before it was killed"
        if clock.seconds > _LONGEST_START:
            return f"the writer has not begun after {_LONGEST_START:g} s"
        time.sleep(0.002)
    return ""


def kill(name: str, folder: Path, random_: random.Random, kills: int) -> dict[str, object]:
    """Start a child, let it write, kill it, look; again and again."""
    writer = WRITERS[name]
    for module in writer.modules:
        importlib.import_module(module)
    number, whole, wrong = 0, 0, []
    if writer.last is None:  # whoever can begin with nothing at all does so
        with _child(lambda: writer.write(folder, 1)):
            number = 1
    for _ in range(kills):
        before = writer.begun(folder) if writer.begun is not None else None
        with _child(lambda: _write_for_ever(writer, folder, number)) as child:  # noqa: B023
            if random_.random() >= _STARTING:
                wrong += filter(None, [_await(writer, folder, child, before)])
            time.sleep(random_.uniform(0.0, writer.longest))
            os.kill(child, signal.SIGKILL)
        found, problem = _asked(lambda: writer.read(folder))
        if found is None:
            wrong.append(problem)
            _asked(lambda: writer.write(folder, number))  # noqa: B023
            continue
        if found < number:
            wrong.append(f"number {number} was there, {found} was found")
        number, whole = found, whole + 1
    if writer.last is not None:
        wrong += filter(None, [_asked(lambda: writer.last(folder))[1]])
    return {"kills": kills, "whole": whole, "wrong": wrong}


def main() -> None:
    """Kill one writer and print what came of it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--writer", choices=WRITERS, required=True)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, required=True)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    logging.getLogger("absl").setLevel(logging.CRITICAL)
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    # Children compile the same again and again, to run it for a moment.
    os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")
    os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(options.folder / "jax"))
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0")
    told = kill(options.writer, options.folder, random.Random(options.seed), options.kills)
    sys.stdout.write(json.dumps(told) + "\n")


if __name__ == "__main__":
    main()
