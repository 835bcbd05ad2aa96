"""Pages in a real browser: they play, step, scrub and draw."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from kinetix.level.model import Arena, ArenaBody, Body, Circle, Level
from kinetix.pages.film import Film
from kinetix.pages.page import page_of
from kinetix.render.palette import KINETIX, ROLE_NAMES
from tests.pages.test_page import a_film

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_BROWSER = next((path for path in map(shutil.which, _NAMES) if path), "")
_FRAMES = "window.requestAnimationFrame = (f) => setTimeout(() => f(performance.now()), 16);"
"""Without a screen there are no frames: a timer stands in for them, in virtual time."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not _BROWSER, reason="no Chromium is installed"),
]


def browse(path, *options):
    done = subprocess.run(
        [
            _BROWSER,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--window-size=900,700",
            f"--user-data-dir={path.parent / 'profile'}",
            *options,
        ],
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    return done.stdout


def dom_after(page, tmp_path, script="", fragment="#still"):
    """The document once a script of the test has run and five seconds have passed."""
    path = tmp_path / "page.html"
    page = page.replace("<body>", f"<body><script>{_FRAMES}</script>", 1)
    path.write_text(page.replace("</body>", f"<script>{script}</script></body>"))
    address = f"file://{path}{fragment}"
    return browse(path, "--virtual-time-budget=5000", "--dump-dom", address)


def time_in(dom):
    return float(re.search(r'data-time="([\d.]+)"', dom)[1])


@pytest.fixture(scope="module")
def page():
    film = a_film(61)
    return page_of([film, a_film(61, title="other", outcome="lost")])


def test_it_plays_by_itself_to_the_end_and_tells_who_won(page, tmp_path):
    dom = dom_after(page, tmp_path, fragment="")
    assert time_in(dom) == pytest.approx(2.0)
    assert re.search(r'class="won">Won<', dom)
    assert re.search(r'class="lost">Lost<', dom)


def test_buttons_keys_and_the_slider_go_to_a_moment(page, tmp_path):
    press = "document.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}));"
    dom = dom_after(page, tmp_path, "document.getElementById('step').click();" + press)
    assert time_in(dom) == pytest.approx(2 / 30, abs=1e-3)
    scrub = (
        "const s = document.getElementById('scrub'); s.value = 500;"
        "s.dispatchEvent(new Event('input')); document.getElementById('back').click();"
    )
    assert time_in(dom_after(page, tmp_path, scrub)) == pytest.approx(29 / 30, abs=1e-3)


def test_the_spoke_of_a_circle_points_up_as_in_every_drawing(tmp_path):
    level = Level(name="x", bodies=(Body(id=1, shape=Circle(radius=0.5), position=(2.0, 3.0)),))
    position, angle = np.array([[[2.0, 3.0]]]), np.zeros((1, 1))
    film = Film(level=level, title="x", seconds=np.zeros(1), position=position, angle=angle)
    note = "CanvasRenderingContext2D.prototype.lineTo = (...to) => (document.body.dataset.to = to)"
    page = page_of([film])
    page = page.replace("</head>", f"<script>{note}</script></head>")
    assert re.search(r'data-to="([^"]+)"', dom_after(page, tmp_path))[1] == "2,3.5"


def test_what_starts_outside_the_arena_is_on_show(tmp_path):
    ghost = ArenaBody(collision="ghost")
    level = Level(
        name="x",
        arena=Arena(left_wall=ghost, right_wall=ghost),
        bodies=(Body(id=1, shape=Circle(radius=0.5), position=(9.0, 3.0)),),
    )
    position, angle = np.array([[[9.0, 3.0]]]), np.zeros((1, 1))
    film = Film(level=level, title="x", seconds=np.zeros(1), position=position, angle=angle)
    page = page_of([film])
    note = (
        "CanvasRenderingContext2D.prototype.setTransform = (...to) =>"
        " to[3] < 0 && (document.body.dataset.transform = to)"
    )
    page = page.replace("</head>", f"<script>{note}</script></head>")
    dom = dom_after(page, tmp_path)
    scale, _, _, _, left, _ = map(float, re.search(r'data-transform="([^"]+)"', dom)[1].split(","))
    dots = int(re.search(r'<canvas[^>]* width="(\d+)"', dom)[1])
    assert -left / scale == pytest.approx(0.0, abs=1e-6)
    assert dots / scale == pytest.approx(9.5)


def test_it_draws_the_level(page, tmp_path):
    path, picture = tmp_path / "page.html", tmp_path / "page.png"
    path.write_text(page)
    browse(path, "--virtual-time-budget=500", f"--screenshot={picture}", f"file://{path}#still")
    with Image.open(picture) as image:
        pixels = np.asarray(image.convert("RGB")).reshape(-1, 3)
    for body in a_film(2).level.bodies:
        if body.role in ("green", "blue"):
            colour = KINETIX.fill(ROLE_NAMES.index(body.role), body.fixed)
            near = np.abs(pixels.astype(int) - colour).max(axis=1) < 8
            assert near.sum() > 100, body.role
