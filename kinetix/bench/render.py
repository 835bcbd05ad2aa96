"""Frames per second of both renderers: the pixel observation and the picture for people."""

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array

from kinetix.bench.timing import seconds_of, steps_per_second
from kinetix.engine.types import State
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_of
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState, stack_states
from kinetix.errors import KinetixError
from kinetix.level.sizes import parse_capacity
from kinetix.paths import levels_dir
from kinetix.render.camera import fit_arena
from kinetix.render.pixels import make_render_pixels_rl
from kinetix.render.scene import draw

SECONDS: Final = 0.3
"""A run is made about as long as this."""
DRIFT: Final = 0.002
"""Shift of everything from frame to frame [m], so that every frame is a new one."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class RenderSettings:
    """Settings of the measurement."""

    size: str = "l"
    """Size of the levels; the bundled ones of that size are cycled over the batch."""
    batches: tuple[int, ...] = (1, 64, 256)
    """Batches of the pixel observation (125×125)."""
    pictures: tuple[int, ...] = (500, 1000)
    """Sides of the picture for people [px], one at a time."""


def run(settings: RenderSettings) -> Iterator[dict[str, Any]]:
    """Measure, and yield a row as soon as it is known.

    Each row has `renderer` (`observation` or `picture`), `width`, `height`, `batch`, `size`,
    `frames_per_s`, `frames_per_s_calls`, `compile_s`. The first rate is that of a rollout: a loop
    inside one program, each frame overwriting the last. The second is that of separate calls, which
    also pay for fresh memory: 47 MB a call at batch 256.

    Raises:
        KinetixError: No level has that size.
    """
    static = static_env_params_of(parse_capacity(settings.size))
    states = _states(settings.size, static)
    observe = make_render_pixels_rl(EnvParams(), static)
    for batch in settings.batches:
        picked = jax.tree.map(
            lambda leaf, batch=batch: jnp.resize(leaf, (batch, *leaf.shape[1:])), states
        )
        yield _row("observation", jax.vmap(observe), picked, (125, 125), batch, settings.size)
    first = jax.tree.map(lambda leaf: leaf[0], states)
    for side in settings.pictures:
        picture = functools.partial(_picture, side=side)
        yield _row("picture", picture, first, (side, side), 1, settings.size)


def _states(size: str, static: StaticEnvParams) -> EnvState:
    files = sorted((levels_dir() / size).glob("*.json"))
    if not files:
        raise KinetixError(f"{levels_dir() / size}: expected bundled levels of size {size!r}")
    return stack_states([level_state(file, static) for file in files])


def _picture(state: EnvState, side: int) -> Array:
    labels = state.labels
    return draw(
        state.world,
        state.physics,
        labels.role,
        labels.motor_binding,
        labels.thruster_binding,
        fit_arena(side, side),
        width=side,
        height=side,
    )


def _moved(state: EnvState, frame: Array) -> EnvState:
    physics: State = state.physics
    shift = DRIFT * frame.astype(jnp.float32)
    return dataclasses.replace(
        state, physics=dataclasses.replace(physics, position=physics.position + shift)
    )


def _row(
    renderer: str,
    render: Callable[[EnvState], Array],
    state: EnvState,
    shape: tuple[int, int],
    batch: int,
    size: str,
) -> dict[str, Any]:
    blank = jax.eval_shape(render, state)

    @jax.jit
    def loop(state: EnvState, frames: Array) -> Array:
        return jax.lax.fori_loop(
            0,
            frames,
            lambda frame, _: render(_moved(state, frame)),
            jnp.zeros(blank.shape, blank.dtype),
        )

    def rollout(frames: int) -> Array:
        return loop(state, jnp.asarray(frames))

    once = jax.jit(render)
    calls = functools.partial(_calls, once, state)
    compile_s = seconds_of(rollout, 1)
    calls(1)
    rate = functools.partial(steps_per_second, about=SECONDS, first=2)
    return {
        "renderer": renderer,
        "width": shape[0],
        "height": shape[1],
        "batch": batch,
        "size": size,
        "frames_per_s": batch * rate(rollout),
        "frames_per_s_calls": batch * rate(calls),
        "compile_s": compile_s,
    }


def _calls(once: Callable[[EnvState], Array], state: EnvState, frames: int) -> None:
    for _ in range(frames):
        jax.block_until_ready(once(state))


__all__ = ["RenderSettings", "run"]
