"""Off a processor a batch is one program: nothing is tiled or stored, and it computes the same."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine.backend import whole_batches
from kinetix.engine.batch import TILE
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.level.model import Body, Circle, Joint, Level, Polygon

BAR = Polygon(vertices=((0.4, 0.1), (-0.4, 0.1), (-0.4, -0.1), (0.4, -0.1)))
LEVEL = Level(
    name="pair",
    next_id=4,
    bodies=(
        Body(id=1, shape=BAR, position=(2.5, 0.09), role="green"),
        Body(id=2, shape=Circle(radius=0.2), position=(2.6, 0.39)),
    ),
    joints=(Joint(id=3, kind="revolute", a=1, b=2, anchor_a=(0.1, 0.1), anchor_b=(0.0, -0.2)),),
)
STATIC = static_env_params_from_size("5,1,1,0", physics="fast")
ENV = make_kinetix_env("multi_discrete", "symbolic_flat", None, EnvParams(), STATIC)


def step(keys, states, actions):
    return jax.vmap(ENV.step, in_axes=(0, 0, 0, None, 0))(keys, states, actions, None, states)


def batch(worlds):
    state = level_state(LEVEL, STATIC)
    states = jax.tree.map(lambda x: jnp.broadcast_to(x, (worlds, *jnp.shape(x))), state)
    keys = jax.random.split(jax.random.key(0), worlds)
    return keys, states, jax.vmap(ENV.action_space().sample)(keys)


@pytest.mark.slow
def test_an_accelerator_gets_one_program_without_tiles_and_stores():
    traced = jax.jit(step).trace(*batch(2 * TILE))
    here, there = (traced.lower(lowering_platforms=(name,)).as_text() for name in ("cpu", "cuda"))
    # A store is a conditional; looking things up in short tables is a loop. Left are the three
    # that skip what no world needs: crossed walls, crowded pairs, impacts within a substep; and two
    # that ask for the platform, of which XLA leaves nothing.
    assert here.count("stablehlo.case") > there.count("stablehlo.case") == 5
    assert there.count("stablehlo.while") < 0.7 * here.count("stablehlo.while")
    assert f"tensor<2x{TILE}x" in here
    assert f"tensor<2x{TILE}x" not in there


@pytest.mark.slow
def test_the_program_of_an_accelerator_computes_the_same():
    arguments = batch(TILE + 6)
    tiled = jax.jit(step)(*arguments)
    with whole_batches():
        whole = jax.jit(lambda *x: step(*x))(*arguments)  # noqa: PLW0108 (traced anew)
    for a, b in zip(jax.tree.leaves(tiled), jax.tree.leaves(whole), strict=True):
        np.testing.assert_allclose(b, a, atol=2e-5)
