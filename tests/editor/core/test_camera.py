import math

import pytest

from editor.base.camera import ZOOM_MAX, ZOOM_MIN, Camera


def test_screen_and_world_are_inverse():
    camera = Camera(centre=(1.0, 2.0), zoom=1.7, origin=(40.0, 60.0), size=(640.0, 480.0))
    for point in ((0.0, 0.0), (2.5, 2.5), (-3.0, 7.25)):
        assert camera.to_world(camera.to_screen(point)) == pytest.approx(point, abs=1e-9)


def test_y_points_up():
    camera = Camera()
    assert camera.to_screen((2.5, 3.5))[1] < camera.to_screen((2.5, 2.5))[1]


def test_the_point_under_the_pointer_stays_while_zooming():
    camera, at = Camera(size=(900.0, 700.0)), (123.0, 456.0)
    under = camera.to_world(at)
    for factor in (1.1, 1.1, 0.5, 3.0, 100.0, 1e-6, 1.1):
        camera = camera.zoomed(factor, at)
        assert math.dist(camera.to_world(at), under) < 1e-4


def test_zoom_has_limits():
    camera = Camera()
    assert camera.zoomed(1e9, (0.0, 0.0)).zoom == ZOOM_MAX
    assert camera.zoomed(1e-9, (0.0, 0.0)).zoom == ZOOM_MIN


def test_panning_moves_the_picture_with_the_pointer():
    camera = Camera()
    moved = camera.panned((30.0, -20.0))
    x, y = camera.to_screen((1.0, 1.0))
    assert moved.to_screen((1.0, 1.0)) == pytest.approx((x + 30.0, y - 20.0))


def test_fitting_shows_a_box_whole():
    camera = Camera(size=(500.0, 300.0)).fitted((0.0, 0.0), (5.0, 5.0), margin=10.0)
    x0, y1 = camera.to_screen((0.0, 0.0))
    x1, y0 = camera.to_screen((5.0, 5.0))
    assert min(x0, y0) >= 10.0 - 1e-9
    assert x1 <= 490.0 + 1e-9 and y1 <= 290.0 + 1e-9


def test_an_arena_on_whole_pixels_is_seen_as_before():
    camera = Camera(origin=(250.3, 91.0), size=(877.0, 653.0)).fitted((0.0, 0.0), (5.0, 5.0))
    sharp = camera.on_pixels(5.0)
    for corner in ((0.0, 0.0), (5.0, 5.0)):
        at = sharp.to_screen(corner)
        assert at == pytest.approx(tuple(map(round, at)), abs=1e-6)
        assert at == pytest.approx(camera.to_screen(corner), abs=1.5)
