"""Pictures of states: for the canvas while playing, for PNG, GIF and MP4 files."""

import dataclasses
import functools
import itertools
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, UInt8
from PIL import Image as Picture

from editor.documents.commands.bodies import posed
from editor.worker.requests import ExportFilm, ExportPicture, Image, Progress, RenderState
from editor.worker.simulation.stepping import start_state, without_memory
from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Snapshot, Trace
from editor.worker.trace_pages import film_of_trace
from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import replacing
from kinetix.level.controls import channels_in_use
from kinetix.level.model import Level
from kinetix.pytree import on_device
from kinetix.render.camera import Camera, fit_arena
from kinetix.render.captions import caption, write_caption
from kinetix.render.film import write_film
from kinetix.render.palette import PALETTES, Palette
from kinetix.render.scene import draw
from kinetix.render.style import STYLE, Style

_GAP: Final = 4
"""Between two players side by side [px]."""
PIXELS: Final = 500
"""Side of an exported picture at 1× [px]."""


def steps_per_second(request: ExportFilm) -> float:
    """Environment steps in a second of real time."""
    return ENGINE_STEPS_PER_SECOND / request.trace.snapshots[0].frame_skip


@functools.partial(jax.jit, static_argnums=(2, 3, 4, 5))
def _draw(
    state: EnvState, camera: Camera, width: int, height: int, palette: Palette, style: Style
) -> UInt8[Array, "h w 3"]:
    labels = state.labels
    return draw(
        state.world,
        state.physics,
        labels.role,
        labels.motor_binding,
        labels.thruster_binding,
        camera,
        width=width,
        height=height,
        palette=palette,
        style=style,
    )


def palette_named(name: str) -> Palette:
    """Return a palette for the screen.

    Raises:
        KinetixError: No palette has this name.
    """
    if name not in PALETTES:
        raise KinetixError(f"palette {name!r}: expected one of {', '.join(PALETTES)}")
    return PALETTES[name]


def _state(level: Level, state: Any, physics: str = DEFAULT_PHYSICS) -> EnvState:
    seen = without_memory(start_state(level, physics) if state is None else state)
    return on_device(seen)


def render_state(request: RenderState) -> Image:
    """Return the picture of a state for the canvas.

    Raises:
        KinetixError: No palette has this name, or the level does not fit.
    """
    camera = Camera(
        centre=jnp.asarray(request.centre, jnp.float32),
        pixels_per_metre=jnp.asarray(request.scale, jnp.float32),
    )
    style = dataclasses.replace(STYLE, glyphs=request.glyphs, patterns=request.patterns)
    state = _state(request.level, request.state, request.physics)
    pixels = _draw(state, camera, *request.size, palette_named(request.palette), style)
    return Image(pixels=np.asarray(pixels), centre=request.centre, scale=request.scale)


def export_picture(request: ExportPicture) -> Path:
    """Write a PNG of the arena.

    Raises:
        KinetixError: The file cannot be written.
    """
    side = PIXELS * request.factor
    camera, palette = fit_arena(side, side), palette_named(request.palette)
    state = _state(request.level, request.state)

    def on(background: tuple[int, int, int]) -> np.ndarray:
        backed = dataclasses.replace(palette, background=background)
        return np.asarray(_draw(state, camera, side, side, backed, STYLE))

    if request.transparent:
        pixels = without_background(on((0, 0, 0)), on((255, 255, 255)))
    else:
        pixels = on(palette.background)
    with replacing(request.path) as temporary:
        Picture.fromarray(pixels).save(temporary, format="PNG")
    return request.path


def without_background(
    on_black: UInt8[np.ndarray, "h w 3"], on_white: UInt8[np.ndarray, "h w 3"]
) -> UInt8[np.ndarray, "h w 4"]:
    """Return colour and coverage from the same picture on black and on white.

    A pixel with coverage α and colour c shows α·c on black and α·c + (1 − α) on white.
    """
    black, white = on_black.astype(np.float32), on_white.astype(np.float32)
    alpha = 1.0 - np.clip(white - black, 0.0, 255.0).mean(axis=-1, keepdims=True) / 255.0
    colour = black / np.maximum(alpha, 1e-6)
    stacked = np.concatenate([colour, alpha * 255.0], axis=-1)
    return np.clip(np.rint(stacked), 0, 255).astype(np.uint8)


def export_film(request: ExportFilm, progress: Progress) -> Path:
    """Write a GIF or an MP4 of an episode in real time; n steps give n/stride + 1 pictures.

    Raises:
        KinetixError: The file cannot be written, or MP4 is asked for without the extra `video`.
    """
    rate = steps_per_second(request) / request.stride
    kind = request.path.suffix.lower()
    target = _reserved(request.path) if request.numbered else nullcontext(request.path)
    with target as path, replacing(path) as temporary:
        write_film(
            temporary,
            _frames(request, progress),
            kind=kind,
            per_second=rate,
            comment=_about(request),
        )
    return path


@contextmanager
def _reserved(path: Path) -> Iterator[Path]:
    """Give the first file from `NAME-001.gif` on that nobody has; another window finds it taken.

    Raises:
        LevelError: Nothing can be written there.
    """
    stem, _, first = path.stem.rpartition("-")
    numbers = itertools.count(int(first))
    names = (path.with_name(f"{stem}-{number:03}{path.suffix}") for number in numbers)
    free = next(filter(_made, names))
    try:
        yield free
    except BaseException:
        free.unlink(missing_ok=True)
        raise


def _made(path: Path) -> bool:
    """Make an empty file; whether there was none."""
    try:
        path.touch(exist_ok=False)
    except FileExistsError:
        return False
    except OSError as error:
        raise LevelError(f"{path}: cannot be saved: {error.strerror or error}") from error
    return True


def _about(request: ExportFilm) -> str:
    """Describe the episode: level, player, physics."""
    films = [film_of_trace(t, request.level) for t in (request.trace, request.rival) if t]
    return "; ".join(f"{what}: {told}" for film in films for what, told in film.facts)


def _frames(request: ExportFilm, progress: Progress) -> Iterator[np.ndarray]:
    """The pictures: of one player, or of two side by side with their names."""
    pairs = _moments(request)
    for k, (mine, theirs) in enumerate(pairs):
        progress.report(k / len(pairs), f"Picture {k + 1} of {len(pairs)}")
        frame = _frame(request, request.trace, mine)
        if request.rival is None or theirs is None:
            yield frame
            continue
        line = np.zeros((len(frame), _GAP, 3), np.uint8)
        yield np.concatenate([frame, line, _frame(request, request.rival, theirs)], axis=1)


def _moments(request: ExportFilm) -> list[tuple[Snapshot, Snapshot | None]]:
    """The moments of each picture; where the first player has ended, the second one goes on."""
    chosen, last = request.trace.snapshots[:: request.stride], request.trace.snapshots[-1]
    if request.rival is None:
        return [(moment, None) for moment in chosen]
    others = request.rival.snapshots
    skip = others[0].frame_skip
    times = [moment.step * moment.frame_skip for moment in chosen]
    if last.outcome is not None:
        apart = request.stride * last.frame_skip
        times += range(times[-1] + apart, others[-1].step * skip + apart, apart)
    shown = [*chosen, *[last] * (len(times) - len(chosen))]
    return [
        (mine, others[min(time // skip, len(others) - 1)])
        for mine, time in zip(shown, times, strict=True)
    ]


def _frame(request: ExportFilm, trace: Trace, snapshot: Snapshot) -> np.ndarray:
    camera, palette = fit_arena(request.pixels, request.pixels), palette_named(request.palette)
    # An episode from a file has poses alone.
    level = request.level if snapshot.state is not None else posed(request.level, snapshot)
    state = _state(level, snapshot.state)
    frame = np.asarray(_draw(state, camera, request.pixels, request.pixels, palette, STYLE))
    words = _words(request.level, snapshot) if request.overlay else ""
    if request.rival is not None:
        who = trace.player or "You"
        if request.rival.physics != request.trace.physics:
            who = f"{who}, {trace.physics}"
        words = f"{who}  {words or snapshot.outcome or ''}"
    return _captioned(frame, words) if words else frame


def _words(level: Level, snapshot: Snapshot) -> str:
    mind = snapshot.mind if snapshot.mind is not None and not snapshot.mind.scripted else None
    return caption(
        snapshot.step,
        snapshot.action,
        snapshot.outcome or "",
        value=None if mind is None else mind.value,
        entropy=None if mind is None else mind.entropy,
        controls=channels_in_use(level),
    )


def _captioned(frame: np.ndarray, words: str) -> np.ndarray:
    picture = Picture.fromarray(frame)
    write_caption(picture, words)
    return np.asarray(picture)
