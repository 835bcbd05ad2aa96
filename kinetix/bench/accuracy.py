"""The accuracy suite: every scene in our engine, judged against its known answer."""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, Final

from kinetix.bench.metrics import JUDGES, Metric
from kinetix.bench.motion import Motion
from kinetix.bench.probes import PROBES
from kinetix.bench.runner import run_trials, spec_for
from kinetix.engine.collide import Slots
from kinetix.engine.fitting import fitted
from kinetix.engine.pairs import pair_counts
from kinetix.engine.presets import solver_named
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.room import HasRoom
from kinetix.engine.spec import SceneSpec
from kinetix.scenes import SuiteScene, scenes_named

ROOM_FACTORS: Final = (2, 4)
"""By how much the room for contacts grows where a scene has more than usual."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AccuracySettings:
    """What to measure."""

    scenes: str = "core"
    """`core`, `all`, or ids with commas between them."""
    physics: str = "balanced"
    """A preset or a solver."""


def measure_accuracy(settings: AccuracySettings) -> Iterator[dict[str, Any]]:
    """One row a scene as soon as it is known: see `row_of`.

    Raises:
        KinetixError: A scene or the physics is unknown.
    """
    chosen = scenes_named(settings.scenes)
    solver = solver_named(settings.physics)
    for scene in chosen:
        yield row_of(scene, settings.physics, metrics_of(scene, solver, settings.physics))


def metrics_of(scene: SuiteScene, solver: AbstractSolver, physics: str) -> list[Metric]:
    """Run a scene and judge it."""
    if scene.id in PROBES:
        return PROBES[scene.id](scene, solver, physics)
    motions, overflow = _with_room(scene, solver, scene.precise or physics == "reference")
    found = JUDGES[scene.id](motions)
    if overflow > 0:
        found.append(
            Metric(name="steps beyond the usual room for contacts", unit="1", value=overflow)
        )
    return found


def _with_room(
    scene: SuiteScene, solver: AbstractSolver, binary64: bool
) -> tuple[list[Motion], float]:
    """The motions, with room for all contacts, and how often the solver's usual room was too small.

    How many contacts fit is a capacity, as the number of bodies is, and no part of the method.
    """
    trials = scene.make_trials()
    motions = run_trials(trials, solver, binary64=binary64)
    usual = overflow = max(motion.overflow for motion in motions)
    for factor in ROOM_FACTORS:
        if overflow == 0 or not isinstance(solver, HasRoom):
            break
        roomy = roomier(solver, spec_for(trials, solver), factor)
        motions = run_trials(trials, roomy, binary64=binary64)
        overflow = max(motion.overflow for motion in motions)
    return motions, usual


def roomier(solver: HasRoom, spec: SceneSpec, factor: int) -> Any:
    """The same method with so many times the room for contacts."""
    spec = fitted(spec)
    usual, most = solver.slots_for(spec), pair_counts(spec.capacity)
    near = (usual.polygon_polygon, usual.circle_polygon, usual.circle_circle)
    room = [min(factor * slots, count) for slots, count in zip(near, most, strict=True)]
    return dataclasses.replace(
        solver,
        slots=Slots(
            polygon_polygon=room[0],
            circle_polygon=room[1],
            circle_circle=room[2],
            points=min(factor * usual.points, 2 * room[0] + room[1] + room[2]),
        ),
    )


def row_of(scene: SuiteScene, physics: str, metrics: Sequence[Metric]) -> dict[str, Any]:
    """A scene's result as commands print it: its worst metric, and all of them in `metrics`."""
    head = {"scene": scene.id, "class": scene.group, "physics": physics}
    worst = max(metrics, key=lambda metric: (metric.verdict is not None, metric.error))
    return head | _fields(worst) | {"metrics": [head | _fields(metric) for metric in metrics]}


def _fields(metric: Metric) -> dict[str, Any]:
    return {
        "metric": metric.label,
        "unit": metric.unit,
        "value": metric.value,
        "good": metric.good,
        "fail": metric.fail,
        "verdict": metric.verdict,
    }
