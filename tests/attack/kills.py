"""Every writer is killed at random moments: what it writes is the old or the new, and whole.

`python -m tests.attack.kills --writer level --kills 100` forks a child that writes without end,
kills it (SIGKILL), looks at what is there, and goes on. Writers without JAX die fifty times a
second.
"""

import argparse
import dataclasses
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from tests.attack.tally import Tally


@dataclasses.dataclass(frozen=True, kw_only=True)
class Writer:
    """Something that is written again and again."""

    write: Callable[[Path, int], None]
    """Writes content number `k` below a folder."""
    read: Callable[[Path], int]
    """Reads it and returns its number; raises when it is not whole."""
    longest: float = 0.03
    """Longest life of a child [s]."""
    kills: int = 40
    """How often in one round."""
    forks: bool = True
    """Whether the child is a fork, which dies at once; what knows JAX must start anew."""


def _level(number: int):
    from kinetix.level.codec import load_level

    return load_level("s/first_flight").replace(name=f"number {number}")


def _write_level(folder: Path, number: int) -> None:
    from kinetix.level.codec import save_level

    save_level(_level(number), folder / "x.json")


def _read_level(folder: Path) -> int:
    from kinetix.level.codec import load_level

    return int(load_level(folder / "x.json").name.split()[1])


def _write_set(folder: Path, number: int) -> None:
    from kinetix.level.sets import build_set, gather_levels, save_set

    made = build_set(gather_levels(["s/first_flight"]), name=f"n {number}", folder=folder)
    save_set(made, folder / "set.json", inline=True)


def _read_set(folder: Path) -> int:
    from kinetix.level.sets import load_set

    return int(load_set(folder / "set.json").manifest.name.split()[1])


def _write_settings(folder: Path, number: int) -> None:
    from editor.base.settings import Settings

    Settings(palette=str(number)).save(folder / "settings.json")


def _read_settings(folder: Path) -> int:
    from editor.base.settings import Settings

    return int(Settings.load(folder / "settings.json").palette)


def _write_results(folder: Path, number: int) -> None:
    from editor.gallery.results import Record, Results, Trial

    record = Record(attempts=number, solved=0)
    Results(folder / "results.json").record(Trial(player="x"), {"a": record})


def _read_results(folder: Path) -> int:
    from editor.gallery.results import Results, Trial

    return Results(folder / "results.json").of("a")[Trial(player="x")].attempts


def _write_metrics(folder: Path, number: int) -> None:
    """One more row; the three files agree after the next start."""
    from kinetix.training.logging import MetricsLog

    log = MetricsLog(folder, updates=number - 1)
    row = {"timing/num_updates": number, "timing/num_env_steps": 10 * number}
    log.write(row | {f"loss/{number % 7}": 0.5})
    log.close()


def _read_metrics(folder: Path) -> int:
    from kinetix.training.logging import read_metrics

    updates = [int(row["timing/num_updates"]) for row in read_metrics(folder)]
    assert updates == list(range(1, len(updates) + 1)), updates
    return len(updates)


def _write_trace(folder: Path, number: int) -> None:
    import numpy as np

    from editor.play.trace_files import write_trace
    from editor.worker.recording import Snapshot, Trace

    level = _level(number)
    bodies = len(level.bodies)
    moment = Snapshot(
        step=0,
        position=np.zeros((bodies, 2), np.float32),
        angle=np.zeros(bodies, np.float32),
        velocity=np.zeros((bodies, 2), np.float32),
        angular_velocity=np.zeros(bodies, np.float32),
        motor=np.zeros(len(level.joints), np.float32),
        thruster=np.zeros(len(level.thrusters), np.float32),
    )
    trace = Trace(physics="fast", perturbed=False, snapshots=(moment,), actions=(), seed=number)
    write_trace(trace, level, folder / "x.npz")


def _read_trace(folder: Path) -> int:
    from editor.play.trace_files import read_trace

    found = read_trace(folder / "x.npz")
    assert found.level.name == f"number {found.trace.seed}"
    return found.trace.seed


def _write_agent(folder: Path, number: int) -> None:
    from kinetix.agents.checkpoint import read_checkpoint, write_checkpoint
    from kinetix.paths import checkpoints_dir

    card, params = read_checkpoint(checkpoints_dir() / "unicyclist")
    write_checkpoint(folder / "agent", card.replace(description=str(number)), params)


def _read_agent(folder: Path) -> int:
    from kinetix.agents.agent import load_agent

    return int(load_agent(folder / "agent").card.description)


WRITERS: dict[str, Writer] = {
    "level": Writer(write=_write_level, read=_read_level),
    "level set": Writer(write=_write_set, read=_read_set, longest=0.06),
    "settings": Writer(write=_write_settings, read=_read_settings),
    "results": Writer(write=_write_results, read=_read_results),
    "trace": Writer(write=_write_trace, read=_read_trace),
    "metrics": Writer(write=_write_metrics, read=_read_metrics, longest=0.1),
    "agent": Writer(write=_write_agent, read=_read_agent, longest=2.0, kills=3, forks=False),
}
"""Everything that writes, by name."""


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
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        row = tally.row(f"kills: {name}")
        if done.returncode:
            row.wrong.append(done.stderr.strip().splitlines()[-1][:300])
            continue
        told = json.loads(done.stdout.splitlines()[-1])
        row.tried += told["kills"]
        row.accepted += told["whole"]
        row.wrong += told["wrong"]


def _child(name: str, folder: Path, number: int) -> int:
    """Start a process that writes without end; returns when it has begun."""
    if not WRITERS[name].forks:
        command = [sys.executable, "-m", "tests.attack.kills", "--writer", name]
        command += ["--folder", str(folder), "--from", str(number)]
        child = subprocess.Popen(command, stdout=subprocess.PIPE)
        assert child.stdout is not None
        child.stdout.readline()
        return child.pid
    child = os.fork()
    if child == 0:
        try:
            _write_for_ever(WRITERS[name], folder, number)
        finally:
            os._exit(1)
    return child


def _write_for_ever(writer: Writer, folder: Path, number: int) -> None:
    while True:
        number += 1
        writer.write(folder, number)


def kill(name: str, folder: Path, random_: random.Random, kills: int) -> dict[str, object]:
    """Start a child, let it write, kill it, look; again and again."""
    writer = WRITERS[name]
    writer.write(folder, 1)
    number, whole, wrong = 1, 0, []
    for _ in range(kills):
        child = _child(name, folder, number)
        time.sleep(random_.uniform(0.0, writer.longest))
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        if os.WIFEXITED(status):
            wrong.append("the writer failed before it was killed")
        try:
            found = writer.read(folder)
        except Exception as error:
            wrong.append(f"{type(error).__name__}: {str(error)[:200]}")
            writer.write(folder, number)
            continue
        if found < number:
            wrong.append(f"number {number} was there, {found} was found")
        number, whole = found, whole + 1
    return {"kills": kills, "whole": whole, "wrong": wrong}


def main() -> None:
    """Kill one writer and print what came of it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--writer", choices=WRITERS, required=True)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--from", dest="start", type=int)
    parser.add_argument("--folder", type=Path, required=True)
    options = parser.parse_args()
    random_ = random.Random(options.seed)
    if options.start is not None:
        WRITERS[options.writer].read(options.folder)  # everything is imported
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        _write_for_ever(WRITERS[options.writer], options.folder, options.start)
    told = kill(options.writer, options.folder, random_, options.kills)
    sys.stdout.write(json.dumps(told) + "\n")


if __name__ == "__main__":
    main()
