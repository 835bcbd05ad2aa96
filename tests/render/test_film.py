"""Films: how long their pictures last, and that nothing forks beside JAX's threads."""

import os

import numpy as np
import pytest
from PIL import Image

from kinetix.errors import KinetixError
from kinetix.render.film import write_film


def _frames(count, side=24):
    for k in range(count):
        frame = np.zeros((side, side + 1, 3), np.uint8)
        frame[:, k] = 255
        yield frame


def test_the_pictures_of_a_gif_last_as_long_as_they_should(tmp_path):
    told = "level: Größe; " * 40  # more than one block of a GIF holds
    write_film(tmp_path / "a.gif", _frames(15), kind=".gif", per_second=30, comment=told)
    with Image.open(tmp_path / "a.gif") as film:
        assert film.info["comment"] == told.encode()
        durations = []
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
    assert len(durations) == 15
    assert sum(durations) == 500


def test_an_mp4_is_written_without_forking(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    forks = []
    os.register_at_fork(before=lambda: forks.append(1))
    write_film(tmp_path / "a.mp4", _frames(10), kind=".mp4", per_second=30, comment="by somebody")
    assert forks == []
    data = (tmp_path / "a.mp4").read_bytes()
    assert data[4:8] == b"ftyp"
    assert b"by somebody" in data


def test_what_ffmpeg_says_is_told(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    with pytest.raises(KinetixError, match=r"ffmpeg cannot write the film: .*framerate"):
        write_film(tmp_path / "a.mp4", _frames(3), kind=".mp4", per_second=-1)


@pytest.mark.parametrize("kind", [".gif", ".mp4"])
def test_a_folder_that_is_not_there_is_told_alike(tmp_path, kind):
    pytest.importorskip("imageio_ffmpeg")
    with pytest.raises(FileNotFoundError):
        write_film(tmp_path / "gone" / f"a{kind}", _frames(3), kind=kind, per_second=30)
