"""Only what changes is drawn again, and the window looks as if all were."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from editor.hosts import damage as parts
from editor.hosts.damage import DrawnList, area, damage, union
from editor.hosts.renderer import _pixels_of

SIZE = (400, 300)
CLIP = (0.0, 0.0, 400.0, 300.0)


def drawn(name, *places, colour=1, clip=CLIP, texture=1):
    """A list of squares of 10 px at some places."""
    rows = []
    for x, y in places:
        for dx, dy in ((0, 0), (10, 0), (10, 10), (0, 10)):
            corner = np.array([x + dx, y + dy, 0, 0], np.float32).view(np.uint32)
            rows.append([*corner, colour])
    vertices = np.array(rows, np.uint32).reshape(-1, 5)
    square = np.array([0, 1, 2, 0, 2, 3], np.uint32)
    indices = np.concatenate([square + 4 * k for k in range(len(places))] or [square[:0]])
    command = (clip, texture, len(indices), 0, 0)
    return DrawnList(name=name, vertices=vertices, indices=indices, commands=(command,))


def test_equal_frames_damage_nothing():
    frame = [drawn("a", (10, 10), (50, 50)), drawn("b", (100, 100))]
    assert damage(frame, list(frame), SIZE) == []


def test_a_moved_square_damages_where_it_was_and_is():
    before = [drawn("a", (10, 10), (50, 50), (200, 20))]
    after = [drawn("a", (10, 10), (60, 50), (200, 20))]
    assert damage(before, after, SIZE) == [(48.0, 48.0, 72.0, 62.0)]


def test_a_new_square_damages_only_its_place():
    before = [drawn("a", (10, 10), (200, 20))]
    after = [drawn("a", (10, 10), (100, 100), (200, 20))]
    assert damage(before, after, SIZE) == [(98.0, 98.0, 112.0, 112.0)]
    assert damage(after, before, SIZE) == [(98.0, 98.0, 112.0, 112.0)]


def test_colours_count():
    (rect,) = damage([drawn("a", (10, 10))], [drawn("a", (10, 10), colour=2)], SIZE)
    assert rect == (8.0, 8.0, 22.0, 22.0)


def test_gaps_in_curves_hide_no_change():
    gap = (np.nan, 50)
    before = [drawn("plot", (10, 10), gap, (100, 100))]
    after = [drawn("plot", (20, 10), (np.nan, 60), (120, 100))]
    assert damage(before, after, SIZE) == [(8.0, 8.0, 132.0, 112.0)]
    longer = [drawn("plot", (10, 10), gap, gap, (120, 100))]
    assert damage(before, longer, SIZE) == [(98.0, 98.0, 132.0, 112.0)]
    assert damage(before, [drawn("plot", (10, 10), gap, gap, (100, 100))], SIZE) == []


def test_a_window_that_comes_or_goes_damages_its_place():
    one = [drawn("a", (10, 10))]
    both = [*one, drawn("tip", (100, 200))]
    assert damage(one, both, SIZE) == damage(both, one, SIZE) == [(98.0, 198.0, 112.0, 212.0)]


def test_another_order_draws_everything():
    a, b = drawn("a", (10, 10)), drawn("b", (12, 12))
    assert damage([a, b], [b, a], SIZE) is None


def test_a_texture_with_new_content_damages_where_it_is_shown():
    frame = [drawn("a", (10, 10)), drawn("b", (100, 100), texture=7)]
    assert damage(frame, list(frame), SIZE, touched={7}) == [(98.0, 98.0, 112.0, 112.0)]


def test_what_is_clipped_away_damages_nothing():
    narrow = (0.0, 0.0, 50.0, 50.0)
    before = [drawn("a", (10, 10), (100, 100), clip=narrow)]
    after = [drawn("a", (10, 10), (150, 100), clip=narrow)]
    assert damage(before, after, SIZE) == []


def test_much_change_draws_everything_and_many_places_are_joined():
    squares = [(10 * k, 10 * j) for k in range(0, 40, 3) for j in range(0, 30, 3)]
    assert damage([drawn("a", *squares)], [drawn("a", *squares, colour=2)], SIZE) is None
    names = "abcdefgh"
    before = [drawn(n, (20 * k, 30 * k)) for k, n in enumerate(names)]
    after = [drawn(n, (20 * k, 30 * k), colour=2) for k, n in enumerate(names)]
    rects = damage(before, after, SIZE)
    assert 1 < len(rects) <= 4
    for k in range(len(names)):
        x, y = 20 * k + 5, 30 * k + 5
        assert any(r[0] <= x <= r[2] and r[1] <= y <= r[3] for r in rects)
    assert sum(map(area, rects)) < 0.75 * SIZE[0] * SIZE[1]


def test_a_thousand_places_are_joined_without_looking_at_each_pair(monkeypatch):
    unions = []
    monkeypatch.setattr(parts, "union", lambda rects: unions.append(1) or union(rects))
    places = [(8 * (k % 20), 5 * (k // 20)) for k in range(1000)]
    before = [drawn(str(k), place) for k, place in enumerate(places)]
    after = [drawn(str(k), place, colour=2) for k, place in enumerate(places)]
    rects = damage(before, after, SIZE)
    assert all(
        any(r[0] <= x and r[1] <= y and x + 10 <= r[2] and y + 10 <= r[3] for r in rects)
        for x, y in places
    )
    assert len(unions) < 10_000


@pytest.mark.gl
@pytest.mark.usefixtures("software_gl")
@pytest.mark.parametrize("where", ["window", "picture"])
def test_partly_drawn_frames_equal_whole_ones(home, where):
    script = Path(__file__).parent / "redraw.py"
    command = [sys.executable, str(script), where]
    root = Path(__file__).resolve().parents[3]
    environment = home | {"PYTHONPATH": str(root)}
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["0", "30"]


@given(
    st.tuples(*[st.floats(-50, 450, width=32) for _ in range(4)]),
    st.integers(100, 400),
)
def test_a_clip_rectangle_leaves_the_same_pixels_in_parts_as_whole(edges, height):
    def scissor(clip):
        """The arguments of glScissor, as Dear ImGui's renderer computes them [px]."""
        left, top, right, bottom = clip
        return int(left), int(height - bottom), int(right - left), int(bottom - top)

    x, y = sorted(edges[:2]), sorted(edges[2:])
    clip = (x[0], y[0], x[1], y[1])
    assert scissor(_pixels_of(clip, height)) == scissor(clip)
