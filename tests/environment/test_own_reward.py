"""The documents' reward and end of one's own, around an environment."""

import re
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import kinetix
from kinetix.environment.reset import level_state
from kinetix.level.model import Body, Circle, Level

_DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "extending.md"


def documented_wrapper() -> Any:
    """The class as the document has it."""
    (source,) = re.findall(
        r"^(@dataclasses\.dataclass\(frozen=True\)\nclass Climb:.*?)^reset_fn",
        _DOCUMENT.read_text(),
        re.MULTILINE | re.DOTALL,
    )
    names: dict[str, Any] = {}
    exec(
        "import dataclasses\nfrom typing import Any\nimport jax.numpy as jnp\n"
        f"from kinetix.engine.batch import where_marked\n{source}",
        names,
    )
    return names["Climb"]


def test_the_last_step_is_rewarded_for_where_it_led_and_the_next_episode_begins(small_static):
    rising = Body(
        id=1, shape=Circle(radius=0.3), position=(1.0, 2.0), velocity=(0.0, 6.0), role="green"
    )
    still = Body(id=2, shape=Circle(radius=0.3), position=(4.0, 1.0), role="blue", fixed=True)
    start = level_state(Level(name="up", bodies=(rising, still)), small_static)
    env = kinetix.make_kinetix_env(
        "discrete", "blind", lambda key: start, kinetix.EnvParams(), small_static
    )
    many = kinetix.vectorize(kinetix.LogWrapper(documented_wrapper()(env)))
    keys = jax.random.split(jax.random.key(0), 2)
    _, states = many.reset(keys)
    at_start = states.env_state.bodies.position
    nothing = jnp.full(2, 8)
    gained = np.zeros(2)
    for _ in range(20):
        before = states.env_state.bodies.position
        _, states, reward, done, info = many.step(keys, states, nothing)
        gained += reward
        if done.any():
            break
        after = states.env_state.bodies.position
        np.testing.assert_allclose(reward, (after - before)[:, 5, 1], atol=1e-6)
    assert done.all() and not info["terminated"].any() and not info["truncated"].any()
    assert (gained > 1.0).all() and (gained < 1.2).all()
    np.testing.assert_allclose(info["returned_episode_returns"], gained, rtol=1e-5)
    np.testing.assert_array_equal(states.env_state.bodies.position, at_start)
    assert (states.env_state.timestep == 0).all()
