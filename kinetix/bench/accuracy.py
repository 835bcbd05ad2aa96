"""The accuracy suite: every scene in our engine, judged against its known answer."""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

from kinetix.bench.metrics import JUDGES, Metric
from kinetix.bench.probes import PROBES
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import solver_named
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.scenes import SuiteScene, scenes_named


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
    motions = run_trials(
        scene.make_trials(), solver, binary64=scene.precise or physics == "reference"
    )
    found = JUDGES[scene.id](motions)
    overflow = max(motion.overflow for motion in motions)
    if overflow > 0:
        found.append(Metric(name="steps without room for all contacts", unit="1", value=overflow))
    return found


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
