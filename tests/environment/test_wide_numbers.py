"""JAX's 64-bit mode: levels stay as they are read, and what is played in loops keeps its types."""

import jax
import pytest

from kinetix.agents.evaluate import NamedLevel, Settings, evaluate
from kinetix.agents.named import load_player
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.environment.reset import load_from_json_file, make_reset_fn_sample_kinetix_level
from kinetix.environment.search.search import solve_level
from kinetix.level.codec import load_level
from kinetix.level.sizes import SIZES


def test_random_levels_have_the_types_of_levels_from_files():
    reset = make_reset_fn_sample_kinetix_level(EnvParams(), static_env_params_of(SIZES["s"]))
    with jax.enable_x64(True):
        drawn = jax.eval_shape(reset, jax.random.PRNGKey(0))
    assert {x.dtype.itemsize for x in jax.tree.leaves(drawn)} <= {1, 4}


def test_a_level_is_evaluated_and_solved():
    # Most constants are wider now than the states that they are computed with.
    with jax.enable_x64(True):
        levels = [NamedLevel(name="first", source="s/first_flight")]
        *_, end = evaluate(load_player("noop"), levels, Settings(attempts=1))
        solution = solve_level(load_level("s/first_flight"), physics="balanced", seconds=60)
    assert [one.solve_rate for one in end.results] == [0.0]
    assert solution is not None


@pytest.mark.parametrize(
    "observation", ["symbolic_flat", "symbolic_flat_padded", "symbolic_entity", "pixels", "blind"]
)
def test_observations_and_rewards_have_the_types_of_their_spaces(observation):
    with jax.enable_x64(True):
        state, static, params = load_from_json_file("s/goalkeeper")
        env = make_kinetix_env("continuous", observation, None, params, static)
        key = jax.random.key(0)
        seen, state = jax.eval_shape(env.reset, key, params, state)
        action = jax.eval_shape(env.action_space(params).sample, key)
        after, _, reward, _, _ = jax.eval_shape(env.step, key, state, action, params, state)
    for each in (*jax.tree.leaves(seen), *jax.tree.leaves(after), reward):
        assert each.dtype.itemsize <= 4, each
