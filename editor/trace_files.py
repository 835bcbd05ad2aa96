"""Episodes as `.npz` files: what was played, with its level, to look at again or compute with."""

import dataclasses
import math
import zipfile
from pathlib import Path
from typing import Any, Final

import numpy as np

from editor.recording import Mind, OutcomeName, Snapshot, Trace
from kinetix.errors import KinetixError
from kinetix.level.codec import dumps, loads
from kinetix.level.model import Level

SUFFIX: Final = ".npz"
_OUTCOMES: Final[tuple[OutcomeName, ...]] = ("won", "lost", "timeout")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recorded:
    """What a file holds."""

    level: Level
    trace: Trace


def write_trace(trace: Trace, level: Level, path: Path) -> None:
    """Write an episode with its level.

    Raises:
        KinetixError: The file cannot be written.
    """
    arrays = trace.arrays() | {"level": np.array(dumps(level))}
    try:
        np.savez_compressed(path, **arrays)  # pyright: ignore[reportArgumentType]
    except OSError as error:
        raise KinetixError(f"{path}: cannot be saved: {error.strerror or error}") from error


def read_trace(path: Path) -> Recorded:
    """Read an episode that `write_trace` wrote.

    Raises:
        KinetixError: The file is missing, or is no such episode; one sentence.
    """
    try:
        # NumPy does not close a file that it opened itself and could not read.
        with path.open("rb") as file, zipfile.ZipFile(file):
            file.seek(0)
            with np.load(file, allow_pickle=False) as stored:
                arrays = {name: stored[name] for name in stored.files}
    except OSError as error:
        raise KinetixError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise KinetixError(f"{path}: expected an episode of the editor (.npz): {error}") from error
    try:
        level = loads(str(arrays["level"]), f"{path}: level")
        return Recorded(level=level, trace=_trace(arrays, level))
    except KeyError as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error} is missing") from (
            error
        )
    except (ValueError, TypeError, IndexError) as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error}") from error


def _trace(arrays: dict[str, np.ndarray], level: Level) -> Trace:
    count = len(arrays["step"])
    if count == 0 or arrays["position"].shape != (count, len(level.bodies), 2):
        raise ValueError("its states do not belong to its level")
    return Trace(
        physics=str(arrays["physics"]),
        perturbed=bool(arrays["perturbed"]),
        snapshots=tuple(_snapshot(arrays, k, last=k == count - 1) for k in range(count)),
        actions=tuple(tuple(row) for row in arrays["action"].tolist()),
        player=str(arrays["player"]),
        seed=int(arrays["seed"]),
        attempt=int(arrays["attempt"]),
        deterministic=bool(arrays["deterministic"]),
        from_file=True,
    )


def _snapshot(arrays: dict[str, np.ndarray], k: int, *, last: bool) -> Snapshot:
    def number(name: str) -> float:
        return float(arrays[name][k])

    end = str(arrays["outcome"])
    unified: tuple[float, ...] = tuple(arrays["unified"][k].tolist())
    rows: dict[str, Any] = {
        name: arrays[name][k]
        for name in ("position", "angle", "velocity", "angular_velocity", "motor", "thruster")
    }
    return Snapshot(
        step=int(arrays["step"][k]),
        **rows,
        reward=number("reward"),
        total_reward=number("total_reward"),
        distance=number("distance"),
        kinetic_energy=number("kinetic_energy"),
        potential_energy=number("potential_energy"),
        momentum=(float(arrays["momentum"][k][0]), float(arrays["momentum"][k][1])),
        outcome=next((name for name in _OUTCOMES if last and name == end), None),
        action=() if any(map(math.isnan, unified)) else unified,
        mind=_mind(arrays, k, unified),
        frame_skip=int(arrays["frame_skip"]),
    )


def _mind(arrays: dict[str, np.ndarray], k: int, unified: tuple[float, ...]) -> Mind | None:
    value, entropy = float(arrays["value"][k]), float(arrays["entropy"][k])
    if math.isnan(value):
        return None
    intention = tuple(arrays["intention"][k].tolist())
    return Mind(intention=intention, own_action=unified, value=value, entropy=entropy)
