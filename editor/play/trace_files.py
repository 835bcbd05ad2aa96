"""Episodes as `.npz` files: what was played, with its level, to look at again or compute with."""

import dataclasses
import io
import math
from pathlib import Path
from typing import Any, Final

import numpy as np

from editor.base.wording import describe
from editor.worker.recording import Mind, OutcomeName, Snapshot, Trace
from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.files.regular import FileError
from kinetix.level.atomic import write_atomically
from kinetix.level.codec import dumps, loads
from kinetix.level.model import MAX_STEPS, Level

SUFFIX: Final = ".npz"
_TEXTS: Final = ("outcome", "physics", "player")
_SCALARS: Final = (*_TEXTS, "perturbed", "seed", "attempt", "deterministic", "frame_skip")
_COLUMNS: Final = (
    "reward",
    "total_reward",
    "distance",
    "kinetic_energy",
    "potential_energy",
    "value",
    "entropy",
)
_RANGES: Final = {
    "step": (0, MAX_STEPS),
    "frame_skip": (1, 1000),
    "seed": (-(2**63), 2**63 - 1),
    "attempt": (0, 2**31 - 1),
}
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
    names = {
        f"{kind}_names": np.array([describe(level, entity.id) for entity in entities], np.str_)
        for kind, entities in (
            ("body", level.bodies),
            ("joint", level.joints),
            ("thruster", level.thrusters),
        )
    }
    arrays = trace.arrays() | {"level": np.array(dumps(level))} | names
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # pyright: ignore[reportArgumentType]
    target = path if path.suffix == SUFFIX else path.with_name(path.name + SUFFIX)
    write_atomically(target, packed.getvalue())


def read_trace(path: Path) -> Recorded:
    """Read an episode that `write_trace` wrote.

    Raises:
        KinetixError: The file is missing, or is no such episode; one sentence.
    """
    try:
        arrays = read_npz(path, "trace")
    except FileError as error:
        if not path.is_file():
            raise
        raise KinetixError(f"{path}: expected an episode of the editor: {error.reason}") from error
    try:
        level = loads(str(arrays["level"]), f"{path}: level")
        return Recorded(level=level, trace=_trace(arrays, level))
    except KeyError as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error} is missing") from (
            error
        )
    except (ValueError, TypeError, IndexError, OverflowError) as error:
        raise KinetixError(f"{path}: expected an episode of the editor: {error}") from error


def _trace(arrays: dict[str, np.ndarray], level: Level) -> Trace:
    count = _checked_count(arrays, level)
    return Trace(
        physics=str(arrays["physics"]),
        perturbed=bool(arrays["perturbed"]),
        snapshots=tuple(_snapshot(arrays, k, last=k == count - 1) for k in range(count)),
        actions=tuple(tuple(row) for row in arrays["action"].tolist()),
        player=str(arrays["player"]),
        seed=int(arrays["seed"]),
        attempt=int(arrays["attempt"]),
        deterministic=bool(arrays["deterministic"]),
        digest=str(arrays.get("digest", "")),
        from_file=True,
    )


def _checked_count(arrays: dict[str, np.ndarray], level: Level) -> int:
    """How many moments there are, after every array's type and shape were compared with that."""
    steps = arrays["step"]
    if steps.ndim != 1 or not 1 <= len(steps) <= MAX_STEPS + 1:
        raise ValueError(f"expected 1 to {MAX_STEPS + 1} moments")
    count, bodies = len(steps), len(level.bodies)
    shapes: dict[str, tuple[int | None, ...]] = {
        "position": (count, bodies, 2),
        "velocity": (count, bodies, 2),
        "angle": (count, bodies),
        "angular_velocity": (count, bodies),
        "motor": (count, len(level.joints)),
        "thruster": (count, len(level.thrusters)),
        "momentum": (count, 2),
        "action": (count - 1, None),
        **dict.fromkeys(("unified", "intention"), (count, None)),
        **dict.fromkeys(_COLUMNS, (count,)),
        **dict.fromkeys(_SCALARS, ()),
    }
    for name, shape in shapes.items():
        array = arrays[name]
        fits = array.ndim == len(shape) and all(
            wanted is None or length == wanted
            for length, wanted in zip(array.shape, shape, strict=True)
        )
        if not fits:
            raise ValueError(f"its states do not belong to its level: {name} is {array.shape}")
        if (array.dtype.kind == "U") != (name in _TEXTS):
            raise ValueError(f"{name} has the type {array.dtype}")
    if arrays["unified"].shape != arrays["intention"].shape:
        raise ValueError("unified and intention have different widths")
    for name, (low, high) in _RANGES.items():
        if not np.all((arrays[name] >= low) & (arrays[name] <= high)):
            raise ValueError(f"expected {name} from {low} to {high}")
    for name in ("step", "position", "angle", "velocity", "angular_velocity", "motor", "thruster"):
        if not np.isfinite(arrays[name]).all():
            raise ValueError(f"{name} is not finite")
    return count


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
