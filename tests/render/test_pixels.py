"""The pixel observation against a slow reference, pixel for pixel."""

import dataclasses

import jax
import numpy as np
import pytest

from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.render import make_render_pixels, make_render_pixels_rl
from tests.render.helpers import (
    PARAMS,
    random_env_state,
    reference_picture,
    stack,
    static_params,
)


@pytest.fixture(scope="module")
def render():
    return jax.jit(make_render_pixels(PARAMS, static_params()))


def _agrees(picture, env_state, static):
    expected, doubt, art = reference_picture(env_state, static)
    compared = ~(doubt | art)
    assert picture.shape == expected.shape
    assert compared.mean() > 0.8
    wrong = compared & (np.abs(picture - expected).max(-1) > 0)
    assert not wrong.any(), np.argwhere(wrong)[:5]


@pytest.mark.parametrize("seed", range(60))
def test_equals_the_reference(render, seed):
    env_state = random_env_state(seed, reach=1.5 if seed % 3 == 0 else 0.0)
    _agrees(np.asarray(render(env_state)), env_state, static_params())


@pytest.mark.parametrize("downscale", [1, 2])
def test_equals_the_reference_with_edges(downscale):
    static = static_params(downscale=downscale, screen=(300, 240))
    draw = jax.jit(make_render_pixels(PARAMS, static))
    for seed in range(6):
        env_state = random_env_state(seed)
        _agrees(np.asarray(draw(env_state)), env_state, static)


def test_a_batch_equals_its_members(render):
    states = [random_env_state(seed) for seed in range(5)]
    batch = np.asarray(
        jax.jit(jax.vmap(make_render_pixels(PARAMS, static_params())))(stack(states))
    )
    for picture, env_state in zip(batch, states, strict=True):
        np.testing.assert_array_equal(picture, render(env_state))


def test_the_observation_is_the_picture_in_unit_range(render):
    env_state = random_env_state(3)
    image = np.asarray(jax.jit(make_render_pixels_rl(PARAMS, static_params()))(env_state))
    assert image.dtype == np.float32
    assert image.min() >= 0
    assert image.max() == 1
    np.testing.assert_allclose(image * 255, render(env_state), atol=1e-4)


def test_axes_floor_and_colours(render):
    """x first, y up; the floor's surface is at 0.4 m; fixed red is exactly half of red."""
    env_state = random_env_state(0)
    env_state.world.bodies.active[1:] = False
    env_state.world.joints.active[:] = False
    env_state.world.thrusters.active[:] = False
    for role, colour in enumerate([(80, 80, 80), (0, 102, 0), (0, 51, 102), (127.5, 51, 51)]):
        env_state.labels.role[0] = role
        picture = np.asarray(render(env_state))
        assert (picture[:, :10] == np.array(colour)).all()
        assert (picture[:, 11:] == 255).all()


def test_everything_inactive_is_white(render):
    env_state = random_env_state(0)
    env_state.world.bodies.active[:] = False
    env_state.world.joints.active[:] = False
    env_state.world.thrusters.active[:] = False
    assert (np.asarray(render(env_state)) == 255).all()


def test_not_a_number_does_no_harm(render):
    env_state = random_env_state(2)
    env_state.physics.position[5:] = np.nan
    assert np.isfinite(np.asarray(render(env_state))).all()


def test_a_triangle_is_drawn_as_a_triangle(render):
    """The area is the triangle's, whatever the padding row of its vertices holds."""
    env_state = random_env_state(0)
    for group in (env_state.world.bodies, env_state.world.joints, env_state.world.thrusters):
        group.active[:] = False
    env_state.world.bodies.active[4] = True
    env_state.world.bodies.inverse_mass[4] = 1
    env_state.world.bodies.vertex_count[4] = 3
    corners = np.array([[0.7, -0.7], [-0.7, -0.7], [-0.7, 0.7]], np.float32)
    env_state.world.bodies.vertices[4, :3] = corners
    env_state.physics.position[4] = 2.5
    env_state.physics.rotation[4] = 0.3
    env_state.labels.role[4] = 1
    areas = []
    for padding in ((0.0, 0.0), (0.7, 0.7), (-9.0, 3.0)):
        env_state.world.bodies.vertices[4, 3] = padding
        areas.append((np.asarray(render(env_state)) != 255).any(-1).sum())
    assert len(set(areas)) == 1
    assert areas[0] == pytest.approx(0.98 * 25**2, rel=0.03)


def test_marks_show_bindings_and_direction(render):
    """A thruster's flame lies behind its nozzle and has its binding's colour."""
    env_state = random_env_state(0)
    for group in (env_state.world.bodies, env_state.world.joints, env_state.world.thrusters):
        group.active[:] = False
    env_state.world.thrusters.active[0] = True
    env_state.world.thrusters.body[0] = 4
    env_state.world.thrusters.position[0] = 0
    env_state.physics.position[4] = 2.5
    env_state.physics.rotation[4] = 0
    for binding, colour in enumerate([(255, 255, 0), (255, 0, 255)]):
        env_state.labels.thruster_binding[0] = binding
        for angle, axis in ((0.0, 0), (np.pi / 2, 1)):
            env_state.world.thrusters.angle[0] = angle
            picture = np.asarray(render(env_state))
            flame = np.argwhere((picture == np.array(colour)).all(-1))
            nozzle = np.argwhere((picture == 80).all(-1))
            assert len(flame) >= 2
            assert len(nozzle) >= 2
            assert flame[:, axis].max() < nozzle[:, axis].min()
            assert np.abs(np.concatenate([flame, nozzle]) - 62).max() <= 3


def test_who_asks_again_gets_the_renderer_that_is_compiled():
    static = StaticEnvParams()
    assert make_render_pixels(EnvParams(), static) is make_render_pixels(EnvParams(), static)
    smaller = dataclasses.replace(static, downscale=5)
    assert make_render_pixels(EnvParams(), static) is not make_render_pixels(EnvParams(), smaller)
