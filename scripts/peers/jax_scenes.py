"""Scenes of engines in JAX whose models their own tools make. See protocol.py.

Scenes that differ in numbers only run together in one program.
"""

import importlib.metadata
import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax_timing import time_loop
from protocol import (
    LIMIT_FADE,
    MOTOR_DECAY,
    MOTOR_POWER,
    MOTOR_SPEED,
    THRUSTER_POWER,
    Scene,
    UnsaidError,
    read_job,
    write_answer,
)

_REFUSALS = (UnsaidError, ValueError, NotImplementedError)


class CompiledScene(Protocol):
    """A scene in an engine's words. Its functions are pure and are for one world."""

    given: Any
    """A pytree of all that differs from scene to scene of a kind."""

    def begin(self, given: Any) -> Any:
        """Return the state at the start."""
        ...

    def advance(self, given: Any, state: Any) -> Any:
        """Return the state a frame later."""
        ...

    def seen(self, given: Any, state: Any) -> jax.Array:
        """x, y, angle and their velocities of the recorded bodies."""
        ...


Say = Callable[[Scene, dict[str, Any]], CompiledScene]


def motor_law(joint: dict[str, Any], action: float, angle: jax.Array, speed: jax.Array) -> Any:
    """As in protocol.py, for traced angles and speeds."""
    wanted, power = joint["motor"]
    fade: Any = 1.0
    if joint["limits"]:
        low, high = joint["limits"]
        beyond = angle - jnp.clip(angle, low + LIMIT_FADE, high - LIMIT_FADE)
        fading = jnp.maximum(0.0, 1 - jnp.abs(beyond) / LIMIT_FADE)
        fade = jnp.where(beyond * action > 0, fading, 1.0)
    error = speed - MOTOR_SPEED * wanted * action
    return -MOTOR_POWER * power * fade * jnp.tanh(MOTOR_DECAY * error)


def thrust(told: dict[str, Any], action: Any, angle: jax.Array) -> jax.Array:
    """Return the force and torque of a thruster on a body turned by an angle."""
    force = THRUSTER_POWER * told["power"] * action
    heading = angle + told["angle"]
    x, y = told["position"]
    c, s = jnp.cos(angle), jnp.sin(angle)
    pushed = force * jnp.cos(heading), force * jnp.sin(heading)
    turning = (c * x - s * y) * pushed[1] - (s * x + c * y) * pushed[0]
    return jnp.stack([*pushed, turning])


def part(told: dict[str, Any], *names: str) -> dict[str, Any]:
    """Return some of what a joint or a thruster has."""
    return {name: told[name] for name in names}


def repeated(step: Callable[[Any], Any], state: Any, times: int) -> Any:
    """Return a step so many times, compiled once."""
    if times == 1:
        return step(state)
    return jax.lax.fori_loop(0, times, lambda _, state: step(state), state)


def serve_compiled(say: Say, package: str) -> None:
    """Do the job.

    Args:
        say: Makes the words of a scene with the job's settings; raises `UnsaidError`.
        package: Whose version is told.
    """
    job, folder = read_job()
    jax.config.update("jax_compilation_cache_dir", os.environ.get("KINETIX_PEER_CACHE"))
    if job["task"] == "record":
        answer, motions = _record(job, say)
        np.savez(folder / "motions.npz", **motions)
    else:
        answer = _measure(job, say)
    versions = {"version": importlib.metadata.version(package), "jax": jax.__version__}
    write_answer(folder, answer | versions)


def _record(job: dict[str, Any], say: Say) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    motions, unsaid = {}, {}
    for name, scenes in job["sets"].items():
        said: dict[int, CompiledScene] = {}
        for index, scene in enumerate(scenes):
            try:
                said[index] = say(scene, job["settings"])
            except _REFUSALS as reason:
                unsaid[f"{name}/{index}"] = f"{type(reason).__name__}: {reason}"
        for kind in _kinds(said):
            steps = max(scenes[index]["steps"] for index in kind)
            rows = _rollout([said[index] for index in kind], steps)
            for world, index in enumerate(kind):
                motions[f"{name}/{index}"] = rows[world, : scenes[index]["steps"] + 1]
    return {"unsaid": unsaid}, motions


def _kinds(said: dict[int, CompiledScene]) -> Iterator[list[int]]:
    """Group the scenes of the same structure and array shapes."""
    groups: list[tuple[Any, list[int]]] = []
    for index, each in said.items():
        shape = jax.tree.structure(each.given), [np.shape(x) for x in jax.tree.leaves(each.given)]
        for known, members in groups:
            if known == shape:
                members.append(index)
                break
        else:
            groups.append((shape, [index]))
    return (members for _, members in groups)


def _rollout(said: Sequence[CompiledScene], steps: int) -> np.ndarray:
    """(world, step, body, 6), with the start; angles without jumps."""
    # What all have in common is a constant: models read sizes and indices out of their arrays.
    leaves = [jax.tree.leaves(each.given) for each in said]
    kind = jax.tree.structure(said[0].given)
    columns = [[np.asarray(row[k]) for row in leaves] for k in range(len(leaves[0]))]
    different = [
        k
        for k, column in enumerate(columns)
        if any(not np.array_equal(each, column[0], equal_nan=True) for each in column)
    ]
    own = [jnp.asarray(np.stack(columns[k])) for k in different]
    words = said[0]

    def run(own: list[jax.Array]) -> jax.Array:
        every = list(leaves[0])
        for k, value in zip(different, own, strict=True):
            every[k] = value
        given = jax.tree.unflatten(kind, every)
        start = words.begin(given)

        def once(state: Any, _: None) -> Any:
            state = words.advance(given, state)
            return state, words.seen(given, state)

        rest = jax.lax.scan(once, start, None, length=steps)[1]
        return jnp.concatenate([words.seen(given, start)[None], rest])

    rows = jax.jit(jax.vmap(run))(own) if different else jax.jit(run)(own)[None]
    found = np.array(rows, np.float64)
    if not different:
        found = np.repeat(found, len(said), axis=0)
    found[..., 2] = np.unwrap(found[..., 2], axis=1)
    return found


def _measure(job: dict[str, Any], say: Say) -> dict[str, Any]:
    """Seconds per step and world of copies of one scene, whose model is a constant."""
    (scene,) = job["scenes"]
    batch = job["batch"]
    try:
        said = say(scene, job["settings"])
    except _REFUSALS as reason:
        return {"unsaid": {"0": f"{type(reason).__name__}: {reason}"}}
    start = jax.jit(said.begin)(said.given)
    states = jax.tree.map(lambda x: jnp.repeat(jnp.asarray(x)[None], batch, axis=0), start)
    step = jax.vmap(lambda state: said.advance(said.given, state))

    def loop(states: Any, count: jax.Array) -> Any:
        return jax.lax.fori_loop(0, count[0], lambda _, state: step(state), states)

    return {"unsaid": {}} | time_loop(loop, batch, states, first=1)
