"""Pictures of states: for the canvas while playing, for PNG, GIF and MP4 files."""

import dataclasses
import functools
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, UInt8
from PIL import Image as Picture

from editor.commands.bodies import posed
from editor.recording import ENGINE_STEPS_PER_SECOND, Snapshot
from editor.requests import ExportFilm, ExportPicture, Image, Progress, RenderState
from editor.simulation.stepping import start_state, without_memory
from kinetix.environment.state import EnvState
from kinetix.errors import KinetixError
from kinetix.level.atomic import replacing
from kinetix.level.controls import channels_in_use
from kinetix.level.model import Level
from kinetix.render.camera import Camera, fit_arena
from kinetix.render.captions import caption, write_caption
from kinetix.render.palette import PALETTES, Palette
from kinetix.render.scene import draw
from kinetix.render.style import STYLE, Style

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
    """A display palette.

    Raises:
        KinetixError: There is none of this name.
    """
    if name not in PALETTES:
        raise KinetixError(f"palette {name!r}: expected one of {', '.join(PALETTES)}")
    return PALETTES[name]


def _state(level: Level, state: Any, physics: str = "balanced") -> EnvState:
    seen = without_memory(start_state(level, physics) if state is None else state)
    return jax.tree.map(jnp.asarray, seen)


def render_state(request: RenderState) -> Image:
    """The picture of a state for the canvas.

    Raises:
        KinetixError: There is no such palette, or the level does not fit.
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
    """Colour and coverage from the same picture on black and on white.

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
    frames = _frames(request, progress)
    write = _write_mp4 if request.path.suffix.lower() == ".mp4" else _write_gif
    with replacing(request.path) as temporary:
        write(temporary, request, frames)
    return request.path


def _frames(request: ExportFilm, progress: Progress) -> Iterator[np.ndarray]:
    chosen = request.trace.snapshots[:: request.stride]
    camera, palette = fit_arena(request.pixels, request.pixels), palette_named(request.palette)
    controls = channels_in_use(request.level)
    for k, snapshot in enumerate(chosen):
        progress.report(k / len(chosen), f"Picture {k + 1} of {len(chosen)}")
        # An episode from a file has poses alone.
        level = request.level if snapshot.state is not None else posed(request.level, snapshot)
        state = _state(level, snapshot.state)
        frame = np.asarray(_draw(state, camera, request.pixels, request.pixels, palette, STYLE))
        yield _captioned(frame, snapshot, controls) if request.overlay else frame


def _captioned(frame: np.ndarray, snapshot: Snapshot, controls: tuple[int, ...]) -> np.ndarray:
    mind = snapshot.mind
    thinks = mind is not None and not mind.scripted
    words = caption(
        snapshot.step,
        snapshot.action,
        snapshot.outcome or "",
        value=mind.value if mind is not None and thinks else None,
        entropy=mind.entropy if mind is not None and thinks else None,
        controls=controls,
    )
    picture = Picture.fromarray(frame)
    write_caption(picture, words)
    return np.asarray(picture)


def _write_gif(path: Path, request: ExportFilm, frames: Iterator[np.ndarray]) -> None:
    pictures = [Picture.fromarray(frame).quantize(64) for frame in frames]
    rate = steps_per_second(request)
    # GIF counts hundredths of a second: the times are rounded, their sum stays right.
    moments = [round(k * request.stride * 100 / rate) for k in range(len(pictures) + 1)]
    durations = [10 * (end - start) for start, end in itertools.pairwise(moments)]
    pictures[0].save(
        path,
        format="GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=durations,
        loop=0,
    )


def _write_mp4(path: Path, request: ExportFilm, frames: Iterator[np.ndarray]) -> None:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise KinetixError(
            "MP4 films need the extra 'video': pip install 'kinetix-editor[video]'; "
            "GIF works without it"
        ) from None
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (request.pixels, request.pixels),
        fps=steps_per_second(request) / request.stride,  # pyright: ignore[reportArgumentType]
        macro_block_size=1,
        output_params=["-f", "mp4"],
    )
    writer.send(None)
    try:
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
    finally:
        writer.close()
