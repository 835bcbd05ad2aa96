"""Steps per second and compile time against the number of bodies and of worlds."""

import dataclasses
from collections.abc import Iterator
from typing import Any, Final

from kinetix.bench.processes import measured_apart
from kinetix.bench.scene_speed import scene_speed
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.presets import solver_named
from kinetix.scenes.model import Trial
from kinetix.scenes.stage import Stage

TOWER: Final = 4
"""Boxes on top of each other in the scene that is made larger and larger."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ScalingSettings:
    """Settings of the measurement."""

    bodies: tuple[int, ...]
    worlds: tuple[int, ...]
    devices: tuple[int, ...]
    size: str = "m"
    """Of the hand-made levels that are cycled over the worlds."""
    physics: str = DEFAULT_PHYSICS


def measure_scaling(settings: ScalingSettings) -> Iterator[dict[str, Any]]:
    """A row a figure as soon as it is known.

    First one world with more and more bodies (towers of four boxes on a floor), then more and more
    worlds of hand-made levels, over each number of devices. Rows have `bodies` or `size` and
    `worlds`, `devices`, `physics`, `steps_per_s` (of all worlds together) and `compile_s`.

    Raises:
        KinetixError: The physics or the size is unknown.
    """
    solver = solver_named(settings.physics)
    for count in settings.bodies:
        rate = scene_speed(towers(count), solver, 1)
        yield {
            "bodies": count,
            "worlds": 1,
            "devices": rate.devices,
            "physics": settings.physics,
            "steps_per_s": round(rate.steps_per_s, 1),
            "compile_s": round(rate.compile_s or 0.0, 2),
        }
    for devices in settings.devices:
        for worlds in settings.worlds:
            if worlds % devices == 0:
                yield _many_worlds(settings, worlds, devices)


def towers(count: int) -> Trial:
    """So many boxes of .2 m in towers of four, .4 m apart, on a floor."""
    stage = Stage("Towers", floor=True)
    for index in range(count):
        tower, storey = divmod(index, TOWER)
        stage.box(0.2, 0.2, 0.4 * (tower - count / TOWER / 2), 0.1 + 0.2 * storey)
    return Trial(level=stage.level(), duration=1.0)


def _many_worlds(settings: ScalingSettings, worlds: int, devices: int) -> dict[str, Any]:
    """Return the bare step on levels."""
    (row,) = measured_apart(
        *("speed", "--sizes", settings.size, "--batches", str(worlds)),
        *("--physics", settings.physics),
        devices=devices,
    )
    return {
        "size": settings.size,
        "worlds": worlds,
        "devices": row["devices"],
        "physics": settings.physics,
        "steps_per_s": row["engine_steps_per_s"],
        "compile_s": row["compile_s"],
    }
