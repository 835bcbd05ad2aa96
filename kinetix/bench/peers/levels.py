"""Speed on levels, other engines and ours in turn: where the documentation's ratios come from."""

import dataclasses
import statistics
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

from kinetix.bench.peers.catalogue import KINETIX_ENV, NATIVE
from kinetix.bench.peers.exchange import scene_of
from kinetix.bench.peers.launch import Peer, ask
from kinetix.bench.processes import host_devices, measured_apart
from kinetix.bench.speed import levels_of
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.level.sizes import parse_capacity
from kinetix.paths import levels_dir
from kinetix.scenes.model import Trial

NATIVE_STEPS: Final = 256
"""Steps from a level's start over which engines driven from Python are timed."""
OURS: Final = "kinetix"
"""Our own name in the rows."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class LevelSettings:
    """Settings of the measurement."""

    sizes: tuple[str, ...] = ("s", "m", "l")
    batch: int = 1024
    """Worlds of the environment step; the bare engine is also measured with one."""
    physics: str = DEFAULT_PHYSICS
    levels: Path | None = None
    """Folder of levels; the bundled ones by default."""
    devices: tuple[int, ...] = (1, 2)
    """Host devices of our own runs, and of the other engine's."""


def measure_levels(settings: LevelSettings) -> Iterator[dict[str, Any]]:
    """A row a figure as soon as it is known.

    Rows have `engine`, `version`, `what` (`env`: environment step with the flat observation;
    `engine`: bare step), `size`, `batch`, `devices`, `steps_per_s`, `compile_s` (None where nothing
    is compiled) and `levels`. One world alone is timed on each level, and the median counts.
    Engines that are not installed are left out.

    Raises:
        KinetixError: A size has no level, or a program failed.
    """
    folder = settings.levels or levels_dir()
    for size in settings.sizes:
        files = levels_of(folder, parse_capacity(size))
        if not files:
            raise KinetixError(f"{folder}: there is no level of size {size}")
        for what, batch in (("env", settings.batch), ("engine", settings.batch), ("engine", 1)):
            head = {"what": what, "size": size, "batch": batch, "levels": len(files)}
            for devices in settings.devices if batch > 1 else (1,):
                if KINETIX_ENV.installed:
                    yield _row(head, KINETIX_ENV.name, _kinetix_env(files, head, devices))
                yield _row(head, OURS, _ours(folder, head, settings.physics, devices))
        for peer in NATIVE:
            if peer.installed:
                head = {"what": "engine", "size": size, "batch": 1, "levels": len(files)}
                yield _row(head, peer.name, native_speed(peer, [_trial(f) for f in files]))


def ratios(rows: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Return our speed over the other's by observation, size and batch."""
    for ours in rows:
        if ours["engine"] != OURS:
            continue
        for peer in rows:
            same = all(peer[key] == ours[key] for key in ("what", "size", "devices"))
            batches = peer["batch"] == ours["batch"] or peer["compile_s"] is None
            if peer["engine"] != OURS and same and batches:
                yield {
                    "against": peer["engine"],
                    **{key: ours[key] for key in ("what", "size", "batch", "devices")},
                    "ratio": ours["steps_per_s"] / peer["steps_per_s"],
                }


def native_speed(peer: Peer, trials: Sequence[Trial]) -> dict[str, Any]:
    """Return steps per second of an engine that is driven from Python: the median over trials.

    Its motors pull as hard as they can at a standstill and its thrusters rest: our laws for them
    would be computed in Python, and that is not what is timed.
    """
    job = {"task": "time", "steps": NATIVE_STEPS, "scenes": [scene_of(trial) for trial in trials]}
    told = ask(peer, job).told
    seconds = list(told["seconds_per_step"].values())
    if not seconds:
        raise KinetixError(f"{peer.name} could say none of the scenes: {told['unsaid']}")
    return {
        "version": told["version"],
        "devices": 1,
        "steps_per_s": 1 / statistics.median(seconds),
        "compile_s": None,
        "call_s": told["call_s"],
    }


def _row(head: dict[str, Any], engine: str, found: dict[str, Any]) -> dict[str, Any]:
    return {"engine": engine, **head, **found, "steps_per_s": round(found["steps_per_s"], 1)}


def _trial(file: Path) -> Trial:
    return Trial(level=load_level(file), duration=NATIVE_STEPS / 60, motor=1.0, thruster=1.0)


def _kinetix_env(files: Sequence[Path], head: dict[str, Any], devices: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory(prefix="kinetix-levels-") as folder:
        copies = []
        for index, file in enumerate(files):
            copies.append(str(Path(folder) / f"{index:03}.json"))
            save_level(load_level(file), Path(copies[-1]), format="kinetix-env")
        job = {"files": copies, "batch": head["batch"], "what": head["what"]}
        told = ask(KINETIX_ENV, job, variables=host_devices(devices)).told
    return {
        "version": told["version"],
        "devices": told["devices"],
        "steps_per_s": 1 / told["seconds_per_step"],
        "compile_s": round(told["compile_s"], 2),
    }


def _ours(folder: Path, head: dict[str, Any], physics: str, devices: int) -> dict[str, Any]:
    """Our own figures, from a new process: the number of devices is fixed when one starts."""
    observation = "symbolic_flat" if head["what"] == "env" else "none"
    (row,) = measured_apart(
        *("speed", "--sizes", head["size"], "--batches", str(head["batch"])),
        *("--physics", physics, "--observation", observation, "--levels", str(folder)),
        devices=devices,
    )
    rate = row["env_steps_per_s" if head["what"] == "env" else "engine_steps_per_s"]
    return {
        "version": physics,
        "devices": row["devices"],
        "steps_per_s": rate,
        "compile_s": row["compile_s"],
    }
