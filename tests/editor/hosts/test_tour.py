"""`make run` where there is no display."""

import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from kinetix.level.codec import load_level

ROOT = Path(__file__).resolve().parents[3]


def without_display(home):
    return {k: v for k, v in home.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}


@pytest.mark.slow
@pytest.mark.gl
@pytest.mark.usefixtures("software_gl")
def test_the_tour_leaves_pictures_and_a_film(home):
    done = subprocess.run(
        [sys.executable, ROOT / "scripts" / "run.py"],
        env=without_display(home),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    made = [Path(line) for line in done.stdout.splitlines() if line.startswith("/")]
    assert "make run ARGS=--serve" in done.stdout
    pictures = [path for path in made if path.suffix == ".png"]
    films = [path for path in made if path.suffix == ".gif"]
    assert len(pictures) >= 2
    assert len(films) >= 1
    for path in pictures:
        with Image.open(path) as picture:
            assert len(picture.convert("RGB").getcolors(1 << 24)) > 50
    for path in films:
        with Image.open(path) as film:
            assert getattr(film, "n_frames", 1) > 15
    # Everything that the tour drew was undone before it saved.
    assert load_level(ROOT / "out" / "tour_level.json").bodies == load_level("l/rover_ridge").bodies


def test_what_needs_no_display_is_done_without_one(home):
    done = subprocess.run(
        [sys.executable, ROOT / "scripts" / "run.py", "--offscreen"],
        env=without_display(home),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "--offscreen shows nothing by itself" in done.stderr
