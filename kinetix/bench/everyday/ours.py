"""Everyday scenes in our engine: those of a size share one compiled step."""

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Final

from kinetix.bench.everyday.judge import Recorded
from kinetix.bench.motion import Motion
from kinetix.bench.runner import run_trials
from kinetix.engine.presets import solver_named
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.spec import ARENA_BODIES, Capacity, SceneSpec
from kinetix.level.sizes import SIZES
from kinetix.scenes.everyday.model import ROOMS, EverydayScene
from kinetix.scenes.model import Trial

BATCH: Final = 8
"""Worlds that are stepped together: one compilation serves any number of scenes."""
FINE: Final = (16, 32)
"""By how much the steps of the fine runs are shorter."""


def record(scenes: Sequence[EverydayScene], physics: str) -> list[Recorded]:
    """Run scenes of any sizes, each with its size's step.

    Raises:
        KinetixError: The physics is unknown.
    """
    solver = solver_named(physics)
    found: dict[int, Recorded] = {}
    for room in dict.fromkeys(scene.room for scene in scenes):
        numbers = [k for k, scene in enumerate(scenes) if scene.room == room]
        run = _Runner(spec=SceneSpec(capacity=capacity_of_room(room)), solver=solver)
        found |= dict(zip(numbers, _record([scenes[k] for k in numbers], run), strict=True))
    return [found[k] for k in range(len(scenes))]


def capacity_of_room(name: str) -> Capacity:
    """Return what the scenes of a room are compiled to, whatever they fill of it."""
    room = ROOMS[name]
    return SIZES.get(name) or Capacity(
        polygons=ARENA_BODIES + room.polygons,
        circles=room.circles,
        joints=room.joints,
        thrusters=0,
    )


def _record(scenes: Sequence[EverydayScene], run: "_Runner") -> Iterator[Recorded]:
    motions = run([scene.trial for scene in scenes])
    twins = iter(run([_twin(scene) for scene in scenes if scene.twin is not None]))
    compared = [scene.trial for scene in scenes if scene.compared]
    fine = zip(*(run(compared, parts) for parts in FINE), strict=True)
    for scene, motion in zip(scenes, motions, strict=True):
        yield Recorded(
            scene=scene,
            motion=motion,
            twin=next(twins) if scene.twin is not None else None,
            fine=next(fine) if scene.compared else None,
        )


def _twin(scene: EverydayScene) -> Trial:
    assert scene.twin is not None
    return dataclasses.replace(scene.trial, level=scene.twin)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Runner:
    """Runs trials in batches of one size."""

    spec: SceneSpec
    solver: AbstractSolver

    def __call__(self, trials: Sequence[Trial], parts: int = 1) -> list[Motion]:
        """Motions at whole frames, each of so many steps."""
        # Scenes of like length are run together.
        order = sorted(range(len(trials)), key=lambda k: trials[k].duration)
        found: dict[int, Motion] = {}
        for first in range(0, len(order), BATCH):
            numbers = order[first : first + BATCH]
            padded = numbers + numbers[-1:] * (BATCH - len(numbers))
            batch = [_finer(trials[k], parts) for k in padded]
            motions = run_trials(batch, self.solver, spec=self.spec, every=parts)
            found |= dict(zip(numbers, motions, strict=False))
        return [found[k] for k in range(len(trials))]


def _finer(trial: Trial, parts: int) -> Trial:
    # Whole frames, so that runs with any step end at one moment.
    return dataclasses.replace(trial, duration=trial.steps * trial.dt, dt=trial.dt / parts)
