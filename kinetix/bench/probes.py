"""The scenes that take more than recorded trials: determinism, random and hand-made levels."""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from kinetix.bench.judges.base import Metric, rms
from kinetix.bench.motion import Motion
from kinetix.bench.random_levels import WildSettings, measure_wild
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import solver_named
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.scenes.model import SuiteScene, Trial

Probe = Callable[[SuiteScene, AbstractSolver, str], list[Metric]]
"""Takes a scene, the solver and the name of the physics; returns what was measured."""

FINE: Final = 16
"""By how much the steps of the fine runs of R6 are shorter; half of that checks them."""
HORIZON_ERROR: Final = 5e-4
"""Fine runs that differ by more have parted: a tenth of the scene's first threshold [m]."""
SHORTEST_HORIZON: Final = 0.25
"""A comparison over a smaller share of the duration has no verdict."""


def _determinism(scene: SuiteScene, solver: AbstractSolver, physics: str) -> list[Metric]:
    trials = scene.make_trials()
    binary64 = physics == "reference"
    half = len(trials) // 2
    first = run_trials(trials, solver, binary64=binary64)
    again = run_trials(trials, solver, binary64=binary64)
    alone = [
        run_trials([trial], solver, binary64=binary64, like=trials)[0] for trial in trials[:half]
    ]
    reversed_back = [_reversed(motion) for motion in first[half:]]
    same = all(
        np.array_equal(a.position, b.position, equal_nan=True)
        and np.array_equal(a.rotation, b.rotation, equal_nan=True)
        for a, b in zip(first, again, strict=True)
    )
    return [
        Metric(name="rerun differs", unit="1", value=float(not same), good=0.0, fail=0.0),
        Metric(
            name="alone against batch",
            unit="m",
            value=_difference(first[:half], alone),
            good=1e-5,
            fail=1e-5,
        ),
        Metric(name="bodies reversed", unit="m", value=_difference(first[:half], reversed_back)),
    ]


def _reversed(motion: Motion) -> Motion:
    return dataclasses.replace(
        motion, position=motion.position[:, ::-1], rotation=motion.rotation[:, ::-1]
    )


def _difference(first: Sequence[Motion], second: Sequence[Motion]) -> float | None:
    """Return the largest difference of any position at any time; None where one is not a number."""
    pairs = zip(first, second, strict=True)
    found = max(float(np.abs(a.position - b.position).max()) for a, b in pairs)
    return found if np.isfinite(found) else None


def _levels(scene: SuiteScene, solver: AbstractSolver, physics: str) -> list[Metric]:
    trials = scene.make_trials()
    motions = run_trials(trials, solver, binary64=physics == "reference")
    # Whatever is judged, the fine runs are those of our own default method.
    method = solver_named("balanced")
    fine, coarser = (
        run_trials([_finer(t, parts) for t in trials], method, binary64=True, every=parts)
        for parts in (FINE, FINE // 2)
    )
    return [
        metric
        for motion, wanted, check in zip(motions, fine, coarser, strict=True)
        for metric in _compared(motion, wanted, check)
    ]


def _finer(trial: Trial, parts: int) -> Trial:
    return dataclasses.replace(trial, dt=trial.dt / parts)


def _compared(motion: Motion, wanted: Motion, check: Motion) -> list[Metric]:
    """Error up to the horizon, and where the horizon is."""
    free = motion.free
    name = motion.trial.name
    parted = np.abs(wanted.position - check.position)[:, free].max(axis=(1, 2)) > HORIZON_ERROR
    horizon = int(np.argmax(parted)) if parted.any() else len(parted)
    error = np.linalg.norm(motion.position - wanted.position, axis=-1)[:horizon, free]
    judged = horizon >= SHORTEST_HORIZON * len(parted)
    return [
        Metric(
            name="position error",
            unit="m",
            value=None if motion.wild_after is not None else rms(error),
            good=5e-3 if judged else None,
            fail=0.1 if judged else None,
            variant=name,
        ),
        Metric(name="horizon", unit="s", value=horizon * motion.trial.dt, variant=name),
    ]


def _wild(scene: SuiteScene, solver: AbstractSolver, physics: str) -> list[Metric]:
    del scene, solver
    return measure_wild(WildSettings(physics=physics))


PROBES: Final[dict[str, Probe]] = {"R4": _determinism, "R5": _wild, "R6": _levels}
"""By the scene's id."""
