"""The accuracy suite: every scene in our engine, judged against its known answer."""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, Final

from kinetix.bench.judges import JUDGES, Metric
from kinetix.bench.motion import Motion
from kinetix.bench.probes import PROBES
from kinetix.bench.runner import run_trials
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.engine.presets import solver_named
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import SceneSpec
from kinetix.level.sizes import needed_capacity, smallest_capacity
from kinetix.scenes import SuiteScene, scenes_named

SIZED: Final = "in its size's step"
"""Name of the variants of `SuiteScene.sized`."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AccuracySettings:
    """Settings of the accuracy suite."""

    scenes: str = "core"
    """`core`, `all`, or ids with commas between them."""
    physics: str = DEFAULT_PHYSICS
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
    motions = _motions(scene, solver, scene.precise or physics == "reference")
    found = JUDGES[scene.id](motions)
    overflow = max(motion.overflow for motion in motions)
    if overflow > 0:
        found.append(Metric(name="steps that left contacts out", unit="1", value=overflow))
    return found


def _motions(scene: SuiteScene, solver: AbstractSolver, binary64: bool) -> list[Motion]:
    """Every trial in a step of its own capacity, as a user gets it; the trials' order is kept."""
    trials = scene.make_trials()
    needed = [needed_capacity(trial.level) for trial in trials]
    own: dict[int, Motion] = {}
    sized: dict[int, Motion] = {}
    for capacity in dict.fromkeys(needed):
        numbers = [k for k, each in enumerate(needed) if each == capacity]
        chosen = [trials[k] for k in numbers]
        own |= dict(zip(numbers, run_trials(chosen, solver, binary64=binary64), strict=True))
        if scene.sized:
            spec = SceneSpec(capacity=smallest_capacity(capacity))
            again = [dataclasses.replace(t, name=f"{t.name} {SIZED}".strip()) for t in chosen]
            motions = run_trials(again, solver, binary64=binary64, spec=spec)
            sized |= dict(zip(numbers, motions, strict=True))
    return [found[k] for found in (own, sized) for k in sorted(found)]


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
