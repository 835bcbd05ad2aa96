import re

import pytest
from PIL import Image, ImageSequence

from kinetix.cli import main
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import load_level, save_level
from kinetix.render.captions import caption


def test_a_still_shows_the_start_without_playing(tmp_path, capsys):
    out = tmp_path / "pictures" / "level.png"
    assert main(["render", "s/first_flight", str(out), "--pixels", "100"]) == 0
    assert capsys.readouterr().out == f"{out}\n"
    with Image.open(out) as picture:
        assert picture.size == (100, 100)
        assert picture.convert("RGB").getpixel((50, 10)) == (255, 255, 255)
        # The green box stands on the floor at the left.
        red, green, blue = picture.convert("RGB").getpixel((17, 86))
        assert green > red + 50
        assert green > blue + 50


@pytest.mark.slow
def test_a_film_has_a_frame_a_step_and_a_tail(tmp_path):
    out = tmp_path / "level.gif"
    arguments = ["--agent", "random", "--steps", "5", "--pixels", "50", "--overlay"]
    assert main(["render", "s/goalkeeper", str(out), *arguments, "--physics", "jax2d"]) == 0
    with Image.open(out) as film:
        durations = []
        for frame in range(film.n_frames):
            film.seek(frame)
            durations.append(film.info["duration"])
    # Equal frames are merged by the writer, so time is what counts: 6 moments and a tail of 15.
    assert sum(durations) == pytest.approx(21 * 1000 / 30, abs=25)


@pytest.mark.slow
def test_a_solution_is_played_and_filmed_with_its_own_frame_skip(tmp_path):
    level = load_level("s/goalkeeper")
    actions = tuple((2 * repeats, controls) for repeats, controls in level.solution.actions)
    solution = level.solution.replace(frame_skip=1, actions=actions)
    slow = level.replace(solution=solution, max_timesteps=2 * level.max_timesteps)
    save_level(slow, tmp_path / "slow.json")
    seconds = []
    for name in ("s/goalkeeper", str(tmp_path / "slow.json")):
        out = tmp_path / "film.gif"
        assert main(["render", name, str(out), "--agent", "solution", "--pixels", "50"]) == 0
        with Image.open(out) as film:
            seconds.append(sum(frame.info["duration"] for frame in ImageSequence.Iterator(film)))
    assert seconds[0] == pytest.approx(seconds[1], abs=60)


@pytest.mark.slow
def test_a_video_of_odd_size_can_be_written(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    out = tmp_path / "level.mp4"
    arguments = ["--steps", "2", "--pixels", "51", "--physics", "jax2d"]
    assert main(["render", "s/goalkeeper", str(out), *arguments]) == 0
    assert out.stat().st_size > 500
    assert out.read_bytes()[4:8] == b"ftyp"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (
            ["s/first_flight", "level.jpg"],
            "level.jpg: expected a file that ends in .png, .gif, .mp4 or .html",
        ),
        (["s/first_flight", "level.png", "--pixels", "5"], "--pixels 5: expected a number from 16"),
        (["s/first_flight", "level.png", "--steps", "-1"], "--steps -1: expected a number from 0"),
        (
            ["s/first_flight", "level.html", "--attempt", "-1"],
            "--attempt -1: expected a number from 0 to 2147483647",
        ),
        (
            ["s/first_flight", "level.html", "--attempt", "5000000000"],
            "--attempt 5000000000: expected a number from 0 to 2147483647",
        ),
        (
            ["s/first_flight", "level.png", "--agent", "solution", "--attempt", "3"],
            "--attempt 3: a recorded solution is a single episode",
        ),
        (["s/first_flight", "level.png", "--physics", "magic"], "unknown physics 'magic'"),
        (["s/no_such_level", "level.png"], "no_such_level"),
    ],
)
def test_what_cannot_be_drawn_is_said_in_one_sentence(arguments, sentence, capsys):
    assert main(["render", *arguments]) == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    assert re.search(re.escape(sentence), captured.err)
    assert captured.err.count("\n") == 1


def test_a_caption_names_only_controls_that_the_level_has():
    action = (1.0, -1.0, 0.0, 0.0, 1.0, 1.0)
    assert caption(3, action) == "step 3  left  down  1  2"
    assert caption(3, action, controls=(0, 5)) == "step 3  left  2"


def test_what_a_picture_does_not_show_is_said(tmp_path, capsys):
    b = LevelBuilder("Outside", arena=False)
    b.circle(-2, 1, 0.3)
    b.circle(2, 1, 0.3)
    save_level(b.build(), tmp_path / "outside.json")
    assert main(["render", str(tmp_path / "outside.json"), str(tmp_path / "o.png")]) == 0
    assert "1 of 2 shapes start outside the picture" in capsys.readouterr().err


def test_a_mistyped_name_leaves_no_folder(tmp_path, capsys):
    assert main(["render", "s/no_such_level", str(tmp_path / "new" / "x.png")]) == 1
    assert "there is no such file" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a.png", "a.gif", "a.html"])
def test_what_cannot_be_written_is_said_before_anything_is_played(
    tmp_path, capsys, monkeypatch, name
):
    def showing(*of):
        raise AssertionError("it is played")

    monkeypatch.setattr("kinetix.cli.render._showing", showing)
    (tmp_path / name).mkdir()
    assert main(["render", "s/first_flight", str(tmp_path / name)]) == 1
    assert "it is a folder" in capsys.readouterr().err
