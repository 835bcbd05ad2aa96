"""Protocol of the other engines' programs: the job, the answer, the law of our motors.

A program is run by its peer's own Python as `PROGRAM JOB.json FOLDER`. The job has a `task`:

- `record`: `sets`, lists of scenes by name; the answer is FOLDER/motions.npz with an array
  (step, body, 6) for `NAME/INDEX` of every scene that the engine can say.
- `time`: `scenes`, each timed for itself over `steps` from its start; the answer has the seconds
  per step of each, and `call_s`, those of a world without bodies. Motors then pull as at a
  standstill and thrusters rest (`lawful` is false in the settings), as our laws would be computed
  in Python.

FOLDER/answer.json has the engine's version and, in `unsaid`, the scenes that it cannot say and why.
Nothing of the product is imported here.
"""

import json
import math
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np

MOTOR_SPEED = 6.0
"""Target speed of a motor of speed 1 under full action [rad/s]."""
MOTOR_POWER = 900.0
"""Angular acceleration that a motor of power 1 gives at most [rad/s²]."""
MOTOR_DECAY = 0.1
"""Growth of the torque with the error of the speed [s/rad]."""
LIMIT_FADE = 0.1
"""Distance from a limit at which a motor begins to fade [rad]."""
THRUSTER_POWER = 10.0
"""Force of a thruster of power 1 [N]."""

RUNS = 5
"""Timed runs a figure; the median counts."""

Scene = dict[str, Any]


class UnsaidError(Exception):
    """The engine has no words for something in the scene."""


# An engine that refuses a scene says so; what it refuses is no failure of a step.
_REFUSALS = (UnsaidError, AssertionError, ValueError, RuntimeError)


class World(Protocol):
    """A scene in an engine that is driven from Python."""

    def step(self) -> None:
        """Advance by the scene's time step."""
        ...

    def state(self) -> list[tuple[float, ...]]:
        """x, y, angle and their velocities of the first `recorded` bodies."""
        ...


def motor_law(joint: dict[str, Any], action: float, angle: float, speed: float) -> float:
    """Angular acceleration that a motor gives its joint [rad/s²].

    Args:
        joint: As in the scene.
        action: −1 … 1.
        angle: Angle of b minus angle of a minus the reference [rad].
        speed: Angular velocity of b minus that of a [rad/s].
    """
    wanted, power = joint["motor"]
    error = speed - MOTOR_SPEED * wanted * action
    fade = 1.0
    if joint["limits"]:
        low, high = joint["limits"]
        beyond = angle - min(max(angle, low + LIMIT_FADE), high - LIMIT_FADE)
        if beyond * action > 0:
            fade = max(0.0, 1 - abs(beyond) / LIMIT_FADE)
    return -MOTOR_POWER * power * fade * math.tanh(MOTOR_DECAY * error)


def axial_inertia(a: dict[str, Any], b: dict[str, Any]) -> float:
    """Return the inertia against a motor between two bodies [kg m²]; a fixed body's is infinite."""
    inverse = sum(1 / body["inertia"] for body in (a, b) if body["inertia"])
    return 1 / inverse if inverse else 0.0


def motors_of(scene: Scene) -> list[dict[str, Any]]:
    """Return joints whose motor is driven and can move something."""
    return [
        joint
        for joint in scene["joints"]
        if joint["motor"] and scene["motor"] and not both_fixed(scene, joint)
    ]


def both_fixed(scene: Scene, joint: dict[str, Any]) -> bool:
    """Return whether a joint holds two fixed bodies, or a body to itself: then it does nothing."""
    masses = scene["bodies"][joint["a"]]["mass"], scene["bodies"][joint["b"]]["mass"]
    return joint["a"] == joint["b"] or not any(masses)


def serve(build: Callable[[Scene, dict[str, Any]], World], version: str) -> None:
    """Do the job of an engine that is driven from Python.

    Args:
        build: Makes a world of a scene with the job's settings; raises `UnsaidError`.
        version: Of the engine.
    """
    job, folder = read_job()
    tasks = {"record": _record, "time": _time}
    answer = tasks[job["task"]](job, folder, build)
    write_answer(folder, answer | {"version": version})


def read_job() -> tuple[dict[str, Any], Path]:
    """Return the job and the folder for its answer, from the command line."""
    return json.loads(Path(sys.argv[1]).read_text()), Path(sys.argv[2])


def write_answer(folder: Path, answer: dict[str, Any]) -> None:
    """Write the part of the answer that is no array."""
    (folder / "answer.json").write_text(json.dumps(answer))


def _record(
    job: dict[str, Any], folder: Path, build: Callable[[Scene, dict[str, Any]], World]
) -> dict[str, Any]:
    motions, unsaid = {}, {}
    settings = job["settings"] | {"lawful": True}
    for name, scenes in job["sets"].items():
        for index, scene in enumerate(scenes):
            key = f"{name}/{index}"
            try:
                motions[key] = _motion(build(scene, settings), scene["steps"])
            except _REFUSALS as reason:
                unsaid[key] = f"{type(reason).__name__}: {reason}"
    np.savez(folder / "motions.npz", **motions)
    return {"unsaid": unsaid}


def _motion(world: World, steps: int) -> np.ndarray:
    rows = [world.state()]
    for _ in range(steps):
        world.step()
        rows.append(world.state())
    return np.array(rows, dtype=np.float64)


def _time(
    job: dict[str, Any], folder: Path, build: Callable[[Scene, dict[str, Any]], World]
) -> dict[str, Any]:
    del folder
    seconds, unsaid = {}, {}
    settings = job["settings"] | {"lawful": False}

    def median(scene: Scene) -> float:
        # The first is the warm-up.
        runs = [_seconds(build(scene, settings), job["steps"]) for _ in range(RUNS + 1)][1:]
        return statistics.median(runs) / job["steps"]

    for index, scene in enumerate(job["scenes"]):
        try:
            seconds[str(index)] = median(scene)
        except _REFUSALS as reason:
            unsaid[str(index)] = f"{type(reason).__name__}: {reason}"
    empty = job["scenes"][0] | {"bodies": [], "joints": [], "thrusters": [], "recorded": 0}
    return {"seconds_per_step": seconds, "unsaid": unsaid, "call_s": median(empty)}


def _seconds(world: World, steps: int) -> float:
    step = world.step
    start = time.perf_counter()
    for _ in range(steps):
        step()
    return time.perf_counter() - start
