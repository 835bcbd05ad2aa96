"""Films: how long their pictures last, and that nothing forks beside JAX's threads."""

import os
import weakref

import numpy as np
import pytest
from PIL import Image

import kinetix
from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import replacing
from kinetix.render.film import gif_picture, write_film, write_gif


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


@pytest.mark.parametrize("rate", [25, 30, 50, 60, 75, 100, 120, 240])
@pytest.mark.parametrize("count", [2, 3, 13, 60])
def test_no_picture_of_a_gif_is_so_short_that_browsers_show_it_for_longer(tmp_path, rate, count):
    frames = list(_frames(count, side=64))
    write_film(tmp_path / "a.gif", frames, kind=".gif", per_second=rate)
    durations = []
    with Image.open(tmp_path / "a.gif") as film:
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info.get("duration", 0))
        assert np.array_equal(film.convert("RGB"), frames[-1])
    assert sum(durations) == 10 * round(100 * count / rate)
    assert len(durations) == 1 or min(durations) >= 20
    if rate <= 50:
        assert len(durations) == count


@pytest.mark.parametrize("colours", [64, 256])
def test_a_gif_is_written_while_its_pictures_come(tmp_path, colours):
    draw, alive, most, expected = np.random.default_rng(1), [], 0, []

    def pictures():
        nonlocal most
        frame = draw.integers(0, 256, (40, 40, 3), np.uint8)
        for k in range(20):
            frame[k : k + 9, k] = draw.integers(0, 256, 3)
            picture = gif_picture(frame, colours)
            expected.append(np.asarray(picture.convert("RGB")))
            alive.append(weakref.ref(picture))
            yield picture
            del picture
            most = max(most, sum(each() is not None for each in alive))

    write_gif(tmp_path / "a.gif", pictures(), per_second=30)
    assert most <= 4
    with Image.open(tmp_path / "a.gif") as film:
        for k in range(20):
            film.seek(k)
            assert np.array_equal(film.convert("RGB"), expected[k]), k


def test_pictures_of_a_gif_that_are_alike_are_one(tmp_path):
    frames = [np.full((30, 30, 3), shade, np.uint8) for shade in (9, 9, 99, 99, 99, 9)]
    write_film(tmp_path / "a.gif", frames, kind=".gif", per_second=25)
    durations = []
    with Image.open(tmp_path / "a.gif") as film:
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
    assert durations == [80, 120, 40]


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


def test_a_full_disk_is_one_sentence_that_names_the_film(tmp_path, monkeypatch):
    program = tmp_path / "ffmpeg"
    program.write_text(
        "#!/bin/sh\ncat > /dev/null\necho '[out#0/mp4 @ 0x1] Error: No space left on device' >&2\n"
        "echo 'Task finished with error code: -28' >&2\nexit 228\n"
    )
    program.chmod(0o755)
    monkeypatch.setattr("kinetix.render.film.ffmpeg", lambda: str(program))
    with pytest.raises(LevelError) as told, replacing(tmp_path / "b.mp4") as path:
        write_film(path, _frames(3), kind=".mp4", per_second=30)
    assert str(told.value) == f"{tmp_path / 'b.mp4'}: cannot be saved: No space left on device"


def test_a_picture_of_a_gif_that_lasts_for_long_is_several(tmp_path):
    """A picture's time has 16 bits of hundredths of a second: 655 s."""
    still, other = np.zeros((2, 6, 8, 3), np.uint8)
    other[:, :4] = 200
    frames = [still] * 701 + [other] * 1400
    write_film(tmp_path / "a.gif", frames, kind=".gif", per_second=1)
    with Image.open(tmp_path / "a.gif") as film:
        shown, time = [], 0.0
        for k in range(film.n_frames):
            film.seek(k)
            begun = still if time < 701_000 else other
            np.testing.assert_array_equal(np.asarray(film.convert("RGB")), begun)
            time += film.info["duration"]
            shown.append(film.info["duration"])
    assert time == 2_101_000
    assert len(shown) == 5 and min(shown) >= 20


@pytest.mark.parametrize("kind", [".gif", ".mp4"])
def test_a_film_without_pictures_is_refused(tmp_path, kind):
    with pytest.raises(KinetixError, match="a film needs at least one picture"):
        write_film(tmp_path / f"a{kind}", [], kind=kind, per_second=30)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", [".gif", ".mp4"])
def test_a_folder_that_is_not_there_is_told_alike(tmp_path, kind):
    pytest.importorskip("imageio_ffmpeg")
    with pytest.raises(FileNotFoundError):
        write_film(tmp_path / "gone" / f"a{kind}", _frames(3), kind=kind, per_second=30)


def test_a_film_of_ones_own_pictures(tmp_path):
    frames = list(_frames(5))
    kinetix.save_film(str(tmp_path / "a.GIF"), np.stack(frames), 25)
    with Image.open(tmp_path / "a.GIF") as film:
        assert film.n_frames == 5
        assert np.array_equal(film.convert("RGB"), frames[0])


def test_an_mp4_is_asked_for_by_its_name(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    kinetix.save_film(tmp_path / "a.mp4", _frames(5))
    assert b"ftyp" in (tmp_path / "a.mp4").read_bytes()[:16]


FRAME = np.zeros((8, 9, 3), np.uint8)
NO_FILMS = {
    "neither": ("a.avi", [FRAME], 30, r"a\.avi: expected a name that ends in \.gif or \.mp4"),
    "no ending": ("a", [FRAME], 30, r"a: expected a name that ends in \.gif or \.mp4"),
    "swapped": (None, "a.gif", 30, r"the order is save_film\(path, frames\)"),
    "no rate": ("a.gif", [FRAME], 0, "per_second 0: expected a number above 0"),
    "a text": ("a.gif", [FRAME], "30", "per_second '30': expected a number above 0"),
    "reals": ("a.gif", [FRAME / 2], 30, r"frames\[0\]: expected .*uint8.*\(8, 9, 3\) in float64"),
    "two sizes": ("a.gif", [FRAME, FRAME[1:]], 30, r"frames\[1\]: expected the shape \(8, 9, 3\)"),
    "one": ("a.gif", FRAME, 30, r"frames\[0\]: expected \(height, width, 3\) .*got \(9, 3\)"),
    "no pictures": ("a.gif", 3, 30, "frames: expected pictures, got int"),
    "none": ("a.gif", [], 30, "^frames: a film needs at least one picture"),
    "no folder": ("gone/a.gif", [FRAME], 30, "cannot be saved"),
}


@pytest.mark.parametrize("case", NO_FILMS)
def test_what_is_no_film_gets_one_sentence(tmp_path, case):
    name, frames, rate, sentence = NO_FILMS[case]
    path = FRAME if name is None else tmp_path / name
    with pytest.raises(KinetixError, match=sentence):
        kinetix.save_film(path, frames, rate)
    assert list(tmp_path.iterdir()) == []
