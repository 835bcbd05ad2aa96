"""The picture for people: golden images, a slow reference, cameras."""

import functools
import os
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from PIL import Image

from kinetix.render.camera import Camera, fit_arena, to_pixels, to_world
from kinetix.render.palette import KINETIX, PALETTES
from kinetix.render.scene import draw
from kinetix.render.style import STYLE, Style
from tests.render.helpers import random_env_state

GOLDEN = Path(__file__).parent / "golden"
PLAIN = Style(glyphs=False)

compiled = jax.jit(draw, static_argnames=("width", "height", "palette", "style"))


def picture(env_state, camera, width, height, **look):
    """One picture as a numpy array."""
    labels = env_state.labels
    drawn = compiled(
        env_state.world,
        env_state.physics,
        labels.role,
        labels.motor_binding,
        labels.thruster_binding,
        camera,
        width=width,
        height=height,
        **look,
    )
    return np.asarray(drawn).astype(int)


def only_bodies(env_state):
    """The same scene without joints and thrusters."""
    env_state.world.joints.active[:] = False
    env_state.world.thrusters.active[:] = False
    return env_state


LOOKS = {
    "kinetix": {},
    "okabe_ito_patterns": {"palette": PALETTES["okabe_ito"], "style": Style(patterns=True)},
    "high_contrast": {"palette": PALETTES["high_contrast"]},
    "mono_plain": {"palette": PALETTES["mono"], "style": PLAIN},
}


@pytest.mark.parametrize("name", LOOKS)
def test_golden(name):
    """Write anew with KINETIX_WRITE_GOLDEN=1, then look at what changed."""
    drawn = picture(
        random_env_state(1, (12, 4, 6, 2), 0.0), fit_arena(64, 64), 64, 64, **LOOKS[name]
    )
    file = GOLDEN / f"{name}.png"
    if os.environ.get("KINETIX_WRITE_GOLDEN"):
        Image.fromarray(drawn.astype(np.uint8)).save(file)
    expected = np.asarray(Image.open(file).convert("RGB")).astype(int)
    assert np.abs(drawn - expected).max() <= 2


def _bodies_reference(env_state, camera, side, palette, style):
    """Bodies painted pixel by pixel without anti-aliasing, and the pixels near any edge."""
    world, state = env_state.world, env_state.physics
    scale = float(camera.pixels_per_metre)
    edge = max(style.outline * scale, style.least_outline)
    py, px = np.mgrid[:side, :side] + 0.5
    image = np.full((side, side, 3), palette.background, float)
    near = np.zeros((side, side), bool)
    centre = np.asarray(camera.centre)
    # Back to the world: the reference tests pixels in metres, in each body's own frame.
    wx = (px - side / 2) / scale + centre[0]
    wy = (side / 2 - py) / scale + centre[1]
    p = world.bodies.vertices.shape[0]
    for body in [0, *range(4, p + world.bodies.radius.shape[0])]:
        if not world.bodies.active[body]:
            continue
        cos, sin = np.cos(state.rotation[body]), np.sin(state.rotation[body])
        dx, dy = wx - state.position[body, 0], wy - state.position[body, 1]
        lx, ly = cos * dx + sin * dy, -sin * dx + cos * dy
        if body < p:
            v = world.bodies.vertices[body, : world.bodies.vertex_count[body]].astype(float)
            depth = np.full(lx.shape, np.inf)
            for a, b in zip(v, np.roll(v, -1, axis=0), strict=True):
                cross = (a[0] - lx) * (b[1] - ly) - (a[1] - ly) * (b[0] - lx)
                depth = np.minimum(depth, -cross / np.hypot(*(b - a)))
        else:
            depth = world.bodies.radius[body - p] - np.hypot(lx, ly)
        depth = depth * scale
        fixed = world.bodies.inverse_mass[body] == 0
        fill = palette.fill(int(env_state.labels.role[body]), bool(fixed))
        image[depth >= 0] = fill
        image[(depth >= 0) & (depth < edge)] = palette.outline
        near[depth >= 0] = False
        near |= (np.abs(depth) < 0.6) | (np.abs(depth - edge) < 0.6)
        if body >= p:
            near |= (depth >= 0) & (np.abs(lx) * scale < edge + 1) & (ly * scale > -2)
    return image, near


@pytest.mark.parametrize("seed", range(12))
def test_bodies_equal_the_reference(seed):
    env_state = only_bodies(random_env_state(seed))
    camera = fit_arena(200, 200, margin=0.2)
    drawn = picture(env_state, camera, 200, 200, style=PLAIN)
    expected, near = _bodies_reference(env_state, camera, 200, KINETIX, PLAIN)
    assert (~near).mean() > 0.6
    wrong = ~near & (np.abs(drawn - expected).max(-1) > 1)
    assert not wrong.any(), np.argwhere(wrong)[:5]


@pytest.mark.parametrize(("width", "height"), [(37, 91), (64, 64)])
def test_any_resolution(width, height):
    drawn = picture(random_env_state(2), fit_arena(width, height), width, height)
    assert drawn.shape == (height, width, 3)
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > 4


def test_resolutions_agree():
    """A picture twice as large, averaged, is the small one up to the anti-aliasing."""
    env_state = random_env_state(4)
    small = picture(env_state, fit_arena(75, 75), 75, 75)
    large = picture(env_state, fit_arena(150, 150), 150, 150)
    averaged = large.reshape(75, 2, 75, 2, 3).mean((1, 3))
    assert np.abs(small - averaged).mean() < 4


def test_every_edge_is_the_average_of_a_finer_picture():
    """A pixel has the colour of its area, sampled 64-fold."""
    env_state = random_env_state(4)
    small = picture(env_state, fit_arena(200, 200), 200, 200).astype(float)
    large = picture(env_state, fit_arena(1600, 1600), 1600, 1600)
    error = np.abs(small - large.reshape(200, 8, 200, 8, 3).mean((1, 3)))
    assert error.mean() < 0.5
    assert (error.max(axis=-1) > 64).mean() < 3e-3


def test_panning_by_whole_pixels_moves_the_picture_and_compiles_nothing():
    env_state = random_env_state(5)
    still = Camera(centre=jnp.array([2.5, 2.5]), pixels_per_metre=jnp.array(50.0))
    base = picture(env_state, still, 150, 150)
    size = compiled._cache_size()
    moved = Camera(
        centre=jnp.array([2.5 + 20 / 50, 2.5 + 10 / 50]), pixels_per_metre=still.pixels_per_metre
    )
    shifted = picture(env_state, moved, 150, 150)
    assert np.abs(shifted[10:, :-20] - base[:-10, 20:]).max() <= 2
    picture(env_state, Camera(centre=still.centre, pixels_per_metre=jnp.array(99.0)), 150, 150)
    assert compiled._cache_size() == size


def test_camera_there_and_back():
    camera = Camera(centre=jnp.array([1.0, 2.0]), pixels_per_metre=jnp.array(80.0))
    points = jnp.array([[0.0, 0.0], [3.0, 4.5]])
    pixels = to_pixels(points, camera, 640, 480)
    np.testing.assert_allclose(pixels[0], [320 - 80, 240 + 160])
    np.testing.assert_allclose(to_world(pixels, camera, 640, 480), points, atol=1e-5)


def test_a_fitted_arena_fills_the_smaller_side():
    camera = fit_arena(300, 200, margin=0.5)
    corners = to_pixels(jnp.array([[-0.5, -0.5], [5.5, 5.5]]), camera, 300, 200)
    np.testing.assert_allclose(corners, [[50, 200], [250, 0]], atol=1e-3)


def _one_body(role, *, circle=False, vertices=None, glyph=True, position=(2.5, 2.5)):
    env_state = only_bodies(random_env_state(0))
    env_state.world.bodies.active[:] = False
    body = 7 if circle else 4
    env_state.world.bodies.active[body] = True
    env_state.world.bodies.inverse_mass[body] = 1
    env_state.world.bodies.radius[:] = 1.0
    if vertices is not None:
        env_state.world.bodies.vertex_count[body] = len(vertices)
        env_state.world.bodies.vertices[body, : len(vertices)] = vertices
    env_state.physics.position[body] = position
    env_state.physics.rotation[body] = 0.4
    env_state.labels.role[body] = role
    style = Style(glyphs=glyph, outline=0, least_outline=0)
    return picture(env_state, fit_arena(150, 150), 150, 150, style=style)


def test_a_triangle_is_drawn_as_a_triangle():
    corners = np.array([[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])
    drawn = _one_body(1, vertices=corners, glyph=False)
    share = (255 - drawn[..., 0]).sum() / 255
    assert share == pytest.approx(2.0 * 30**2, rel=0.005)


def test_a_disc_covers_its_area():
    drawn = _one_body(1, circle=True, glyph=False)
    assert (255 - drawn[..., 2]).sum() / 255 == pytest.approx(np.pi * 30**2, rel=0.005)


def test_roles_have_different_glyphs():
    """Glyphs differ by shape: masks of the ink, whatever the colours."""
    masks = []
    for role in range(4):
        box = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])
        with_glyph = _one_body(role, vertices=box)
        without = _one_body(role, vertices=box, glyph=False)
        masks.append(np.abs(with_glyph - without).max(-1) > 40)
    assert not masks[0].any()
    for i in range(1, 4):
        for j in range(i):
            assert (masks[i] ^ masks[j]).sum() > 10, (i, j)


@pytest.mark.parametrize("role", [1, 2, 3])
def test_a_glyph_is_in_the_middle_of_a_body_wherever_its_frame_begins(role):
    triangle = np.array([[0.0, 1.0], [0.5, -0.5], [-0.5, -0.5]])
    shift = np.array([1.5, 0.5])
    cos, sin = np.cos(0.4), np.sin(0.4)
    place = 2.5 - np.array([[cos, -sin], [sin, cos]]) @ shift
    shifted = _one_body(role, vertices=triangle + shift, position=place)
    assert np.abs(shifted - _one_body(role, vertices=triangle)).max() <= 2


def test_nothing_active_is_background():
    env_state = only_bodies(random_env_state(0))
    env_state.world.bodies.active[:] = False
    for look in (LOOKS["kinetix"], LOOKS["high_contrast"]):
        drawn = picture(env_state, fit_arena(64, 64), 64, 64, **look)
        assert (drawn == np.array(look.get("palette", KINETIX).background)).all()


def test_marks_keep_a_visible_size_when_zoomed_out():
    env_state = random_env_state(0)
    env_state.world.bodies.active[:] = False
    env_state.world.thrusters.active[:] = False
    env_state.world.joints.active[:] = [True, False, False, False]
    env_state.world.joints.fixed[0] = False
    env_state.world.joints.motor_on[0] = True
    env_state.labels.motor_binding[0] = 1
    far = functools.partial(Camera, centre=jnp.array([2.5, 2.5]))
    drawn = picture(env_state, far(pixels_per_metre=jnp.array(6.0)), 75, 75, style=STYLE)
    touched = (drawn != 255).any(-1)
    assert touched.sum() >= 12
    assert (drawn[touched] == np.array(KINETIX.motor_bindings[1])).all(-1).any()
