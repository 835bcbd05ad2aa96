"""Episodes as `.npz` files: what was played, with its level, to look at again or compute with."""

import dataclasses
import io
import math
from pathlib import Path
from typing import Any, Final

import numpy as np

from editor.base.wording import describe
from editor.worker.snapshots import Mind, Snapshot, Trace
from kinetix.environment.outcome import OUTCOMES
from kinetix.files.atomic import write_atomically
from kinetix.level.codec import dumps
from kinetix.level.model import Level
from kinetix.pages.episode_file import read_episode

SUFFIX: Final = ".npz"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recorded:
    """Content of a file."""

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
    target = path if path.suffix.lower() == SUFFIX else path.with_name(path.name + SUFFIX)
    write_atomically(target, packed.getvalue())


def read_trace(path: Path) -> Recorded:
    """Read an episode that `write_trace` wrote.

    Raises:
        KinetixError: The file is missing, or not an episode; one sentence.
    """
    level, arrays = read_episode(path)
    return Recorded(level=level, trace=_trace(arrays))


def _trace(arrays: dict[str, np.ndarray]) -> Trace:
    count = len(arrays["step"])
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
        outcome=next((name for name in OUTCOMES if last and name == end), None),
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
