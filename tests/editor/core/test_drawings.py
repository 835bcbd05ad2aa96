"""Vectors and thumbnails draw a level as the renderer does."""

from unittest import mock

import numpy as np
import pytest

from editor.base.camera import Camera
from editor.drawing.vectors import Painter
from editor.gallery.thumbnail import draw_thumbnail
from kinetix.level.geometry import FLOOR_TOP, recentred
from kinetix.level.model import ROLES, Arena, ArenaBody, Body, Level, Polygon
from kinetix.render.palette import KINETIX, ink
from kinetix.render.style import FLOOR_GLYPH_DEPTH

BOX = Polygon(vertices=((1.3, 0.7), (0.7, 0.7), (0.7, 0.3), (1.3, 0.3)))
"""Its frame's origin lies outside of it."""


def strokes(draw):
    """Numbers of all that was drawn on a draw list."""
    told = [value for call in draw.mock_calls for value in call.args]
    return np.concatenate([np.ravel(value) for value in told]).astype(float)


def floored(role):
    return Level(name="x", arena=Arena(floor=ArenaBody(role=role)))


@pytest.mark.parametrize("role", ["green", "blue", "red"])
def test_the_floors_role_has_its_glyph_under_the_surface(role):
    draw, camera = mock.Mock(), Camera(size=(500.0, 500.0))
    Painter(draw=draw, camera=camera).floor(floored(role))
    at = np.array(camera.to_screen((2.5, FLOOR_TOP - FLOOR_GLYPH_DEPTH)))
    glyph = draw.add_line if role == "red" else draw.add_circle_filled
    for call in glyph.call_args_list:
        assert np.abs(np.array(call.args[0]) - at).max() < 10
    assert glyph.call_args_list
    picture = draw_thumbnail(floored(role), 500)
    fill = KINETIX.fill(ROLES.index(role), fixed=True)
    x, y = at.astype(int)
    assert tuple(picture[y, x]) == ink(fill)
    assert tuple(picture[y, x + 30]) == fill


@pytest.mark.parametrize("role", ["green", "blue", "red"])
def test_a_glyph_is_in_the_middle_of_a_body_wherever_its_frame_begins(role):
    body = Body(id=1, shape=BOX, position=(1.5, 2.0), angle=0.6, role=role, fixed=True)
    drawn = []
    for each in (body, recentred(body, "exact")):
        draw = mock.Mock()
        Painter(draw=draw, camera=Camera()).body(each, (*each.position, each.angle))
        drawn.append((strokes(draw), draw_thumbnail(Level(name="x", bodies=(each,)))))
    assert drawn[0][0] == pytest.approx(drawn[1][0], abs=1e-3)
    assert (drawn[0][1] == drawn[1][1]).all()
