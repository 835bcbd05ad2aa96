"""Films of pictures: GIF and MP4 files, written while the pictures come."""

import contextlib
import itertools
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Final

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from kinetix.errors import KinetixError

Frames = Iterable[UInt8[np.ndarray, "h w 3"]]
"""Pictures of one size, in their order."""

FILM_SUFFIXES: Final = (".gif", ".mp4")
_COLOURS: Final = 64
"""Colours of a GIF's picture: levels have few, and the file half the bytes of 256."""
_SHORTEST: Final = 2
"""Least time of a GIF's picture [0.01 s]: browsers show anything shorter for 0.1 s."""


def write_film(
    path: Path, frames: Frames, *, kind: str, per_second: float, comment: str = ""
) -> None:
    """Write a film.

    Args:
        path: The file, whatever it is called.
        frames: At least one picture.
        kind: `.gif` or `.mp4`.
        per_second: Pictures per second.
        comment: Kept in the file: what was played, by whom, under what.

    Raises:
        KinetixError: An MP4 is asked for without the extra `video`, or ffmpeg cannot make it.
        OSError: The file cannot be written.
    """
    (_write_mp4 if kind == ".mp4" else _write_gif)(path, frames, per_second, comment)


def ffmpeg() -> str:
    """Return the path of the program that writes MP4 files.

    Raises:
        KinetixError: The extra `video` is not installed.
    """
    try:
        import imageio_ffmpeg
    except ImportError:
        raise KinetixError(
            "MP4 films need the extra 'video': pip install 'kinetix-editor[video]'; "
            "GIF works without it"
        ) from None
    return imageio_ffmpeg.get_ffmpeg_exe()


def _write_gif(path: Path, frames: Frames, per_second: float, comment: str) -> None:
    write_gif(path, map(gif_picture, frames), per_second=per_second, comment=comment)


def gif_picture(frame: UInt8[np.ndarray, "h w 3"], colours: int = _COLOURS) -> Image.Image:
    """Return a picture in a palette of its own, as GIF files hold it: a third of the bytes."""
    return Image.fromarray(frame).quantize(colours)


def write_gif(
    path: Path, pictures: Iterable[Image.Image], *, per_second: float, comment: str = ""
) -> None:
    """Write pictures from `gif_picture` as a film that repeats for ever.

    Of more than 50 pictures per second some are left out; the film lasts as long.

    Args:
        path: The file, whatever it is called.
        pictures: At least one.
        per_second: Pictures per second.
        comment: Kept in the file.

    Raises:
        OSError: The file cannot be written.
    """
    all_pictures = list(pictures)
    shown, durations = _gif_times(len(all_pictures), per_second)
    first, *rest = (all_pictures[k] for k in shown)
    first.save(
        path,
        format="GIF",
        save_all=True,
        append_images=rest,
        duration=durations,
        loop=0,
        optimize=True,
        comment=comment.encode(),
    )


def _gif_times(count: int, per_second: float) -> tuple[list[int], list[int]]:
    """Return which pictures a GIF shows, the last one always, and how long each lasts [ms]."""
    # GIF counts hundredths of a second: each time is rounded, and their sum stays right.
    moments = [round(100 * k / per_second) for k in range(count + 1)]
    begins = [0]
    for k in range(1, count):
        if min(moments[k] - moments[begins[-1]], moments[-1] - moments[k]) >= _SHORTEST:
            begins.append(k)
    times = [
        10 * (end - start)
        for start, end in itertools.pairwise(moments[k] for k in (*begins, count))
    ]
    return [*begins[:-1], count - 1], times


def _write_mp4(path: Path, frames: Frames, per_second: float, comment: str) -> None:
    program, frames = ffmpeg(), iter(frames)
    path.touch()  # where nothing can be written, this says so in one sentence
    first = next(frames)
    height, width, _ = first.shape
    source = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {per_second} -i -".split()
    # The usual colour layout needs even sides.
    target = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-f", "mp4"]
    target += ["-metadata", f"comment={comment}"]
    with tempfile.TemporaryFile() as complaints:
        # Not through imageio's own writer: it runs Python code in the child between fork and exec,
        # which the threads of JAX do not survive safely.
        with subprocess.Popen(
            [program, "-y", "-loglevel", "error", *source, *target, str(path)],
            stdin=subprocess.PIPE,
            stderr=complaints,
        ) as writer:
            assert writer.stdin is not None
            # Where ffmpeg gives up it closes the pipe; what it says is told below.
            with contextlib.suppress(BrokenPipeError), writer.stdin as pipe:
                for frame in itertools.chain([first], frames):
                    pipe.write(np.ascontiguousarray(frame).tobytes())
        complaints.seek(0)
        said = complaints.read().decode(errors="replace").strip()
    if writer.returncode:
        raise KinetixError(f"ffmpeg cannot write the film: {said}")
