"""jaxued's interface, over the real base class where jaxued is installed."""

import sys
from types import ModuleType

import jax
import pytest

from kinetix.environment.jaxued import as_underspecified_env
from kinetix.errors import KinetixError


class Base:
    """The part of jaxued's class that is not abstract."""

    def step(self, rng, state, action, params=None):
        return self.step_env(rng, state, action, params or self.default_params)

    def reset_to_level(self, rng, level, params=None):
        return self.reset_env_to_level(rng, level, params or self.default_params)


def test_episodes_start_as_told_and_stay_ended(small_env, small_state, monkeypatch):
    try:
        import jaxued.environments  # noqa: F401
    except ImportError:
        module = ModuleType("jaxued.environments")
        module.__dict__["UnderspecifiedEnv"] = Base
        monkeypatch.setitem(sys.modules, "jaxued", ModuleType("jaxued"))
        monkeypatch.setitem(sys.modules, "jaxued.environments", module)
    env = as_underspecified_env(small_env)
    key = jax.random.key(0)
    last = small_state.replace(timestep=small_state.timestep + 255)
    _, state = env.reset_to_level(key, last)
    action = env.action_space(env.default_params).sample(key)
    _, state, _, done, _ = env.step(key, state, action)
    assert done
    assert int(state.timestep) == 256


def test_without_jaxued_one_sentence_says_so(small_env, monkeypatch):
    monkeypatch.setitem(sys.modules, "jaxued.environments", None)
    with pytest.raises(KinetixError, match="pip install jaxued"):
        as_underspecified_env(small_env)
