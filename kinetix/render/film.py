"""Films of pictures: GIF and MP4 files, written while the pictures come."""

import contextlib
import errno
import itertools
import os
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageChops
from PIL.GifImagePlugin import getdata, getheader

from kinetix.errors import KinetixError

Frames = Iterable[UInt8[np.ndarray, "h w 3"]]
"""Pictures of one size, in their order."""

FILM_SUFFIXES: Final = (".gif", ".mp4")
_COLOURS: Final = 64
"""Colours of a GIF's picture: levels have few, and the file half the bytes of 256."""
_MOST_COLOURS: Final = 256
"""Colours that a picture of a GIF can have."""
_SHORTEST: Final = 2
"""Least time of a GIF's picture [0.01 s]: browsers show anything shorter for 0.1 s."""

_LONGEST: Final = 2**16 - 1
"""Most time of a GIF's picture [0.01 s]: its file has 16 bits for it."""


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
        KinetixError: No picture is given, an MP4 is asked for without the extra `video`, or ffmpeg
            cannot make it.
        OSError: The file cannot be written.
    """
    frames = iter(frames)
    first = next(frames, None)
    if first is None:
        raise KinetixError("frames: a film needs at least one picture")
    frames = itertools.chain([first], frames)
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
    with path.open("wb") as file:
        for block in _gif_blocks(_timed(pictures, per_second), comment):
            file.write(block)


def _timed(pictures: Iterable[Image.Image], per_second: float) -> Iterator[tuple[Image.Image, int]]:
    """Yield the pictures that a GIF shows, the last one always, and how long each lasts [0.01 s].

    Each moment is rounded, so that the sum of the times stays right.
    """
    pictures = iter(pictures)
    picture, end = next(pictures), round(100 / per_second)
    begun = [(picture, 0)]
    for count, picture in enumerate(pictures, 2):
        moment, end = end, round(100 * count / per_second)
        if moment - begun[-1][1] >= _SHORTEST:
            begun.append((picture, moment))
        if len(begun) > 2:
            (shown, begin), *begun = begun
            yield shown, begun[0][1] - begin
    if len(begun) > 1 and end - begun[-1][1] < _SHORTEST:
        begun.pop()
    begun[-1] = (picture, begun[-1][1])
    for (shown, begin), (_, until) in itertools.pairwise([*begun, (picture, end)]):
        yield shown, until - begin


def _gif_blocks(timed: Iterator[tuple[Image.Image, int]], comment: str) -> Iterator[bytes]:
    """Yield the parts of a GIF file.

    Pillow's own writer of films holds all of their pictures at once: gigabytes, if they are large.
    """
    before, time = next(timed)
    header, _ = getheader(before, info={"loop": 0, "comment": comment.encode()})
    yield from header
    part: dict[str, Any] = {"im": before}
    for picture, further in timed:
        change = _change(before, picture)
        if change is None:
            time += further
            continue
        yield from _lasting(part, before, time)
        part, before, time = change, picture, further
    yield from _lasting(part, before, time)
    yield b";"


def _lasting(part: dict[str, Any], picture: Image.Image, time: int) -> Iterator[bytes]:
    """Yield GIF frames that show one picture for the given time [0.01 s].

    If one frame cannot last so long, another one rewrites a single pixel.

    Args:
        part: What `getdata` writes of it.
        picture: The whole of it.
        time: How long it lasts.
    """
    pixel = {"im": picture.crop((0, 0, 1, 1)), "offset": (0, 0), "include_color_table": True}
    while time > _LONGEST:
        # Enough is left for the last entry to be shown as long as it should.
        yield from getdata(**part, duration=10 * (_LONGEST - _SHORTEST))
        part, time = pixel, time - (_LONGEST - _SHORTEST)
    yield from getdata(**part, duration=10 * time)


def _change(before: Image.Image, picture: Image.Image) -> dict[str, Any] | None:
    """Return what `getdata` writes of a picture: what differs from the one before, if anything."""
    difference = ImageChops.difference(before.convert("RGB"), picture.convert("RGB"))
    box = difference.getbbox()
    if box is None:
        return None
    part, palette = picture.crop(box), picture.getpalette() or []
    change: dict[str, Any] = {"im": part, "offset": box[:2], "include_color_table": True}
    clear = len(palette) // 3
    if clear < _MOST_COLOURS:  # pixels that stay compress best where all of them are clear
        red, green, blue = difference.crop(box).split()
        most = ImageChops.lighter(ImageChops.lighter(red, green), blue)
        part.putpalette([*palette, 0, 0, 0])
        part.paste(clear, mask=most.point([255] + [0] * 255))
        change["transparency"] = clear
    return change


def _write_mp4(path: Path, frames: Frames, per_second: float, comment: str) -> None:
    program, frames = ffmpeg(), iter(frames)
    path.touch()  # if nothing can be written, this reports it in one sentence
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
            # If ffmpeg gives up it closes the pipe; its message is reported below.
            with contextlib.suppress(BrokenPipeError), writer.stdin as pipe:
                for frame in itertools.chain([first], frames):
                    pipe.write(np.ascontiguousarray(frame).tobytes())
        complaints.seek(0)
        said = complaints.read().decode(errors="replace").strip()
    if writer.returncode and os.strerror(errno.ENOSPC) in said:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    if writer.returncode:
        raise KinetixError(f"ffmpeg cannot write the film: {said}")
