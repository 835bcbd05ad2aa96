"""A method compiled quickly by itself is part of larger programs like any other."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix import EnvParams
from kinetix.environment import eager
from kinetix.environment.eager import quick_alone


@dataclasses.dataclass(frozen=True)
class Doubler:
    """Doubles numbers."""

    factor: float = 2.0

    @quick_alone
    def times(self, x):
        """The number times the factor."""
        return x * self.factor


TWO = Doubler()
CALLS = {
    "jit": lambda: jax.jit(TWO.times)(3.0),
    "jit of a constant": jax.jit(lambda: TWO.times(jnp.float32(3.0))),
    "vmap": lambda: jax.vmap(TWO.times)(jnp.full(2, 3.0))[1],
    "scan": lambda: jax.lax.scan(lambda x, _: (TWO.times(x), None), 3.0, None, length=1)[0],
    "grad": lambda: 3 * jax.grad(TWO.times)(1.0),
    "alone": lambda: TWO.times(3.0),
    "named": lambda: TWO.times(x=3.0),
}


@dataclasses.dataclass(frozen=True, eq=False)
class WithParams:
    """Notes what its method is traced with."""

    env_params: EnvParams = dataclasses.field(default_factory=EnvParams)
    traced: list = dataclasses.field(default_factory=list)

    @quick_alone
    def step(self, x, env_params=None):
        self.traced.append(env_params is None)
        return x


@pytest.mark.parametrize(
    ("params", "one"),
    [
        (EnvParams(), True),
        (EnvParams(dt=0.01), False),
        (EnvParams(dt=jnp.float32(1 / 60)), False),
    ],
)
def test_parameters_that_are_left_out_and_given_are_one_program(params, one):
    env = WithParams()
    for given in ((None,), (params,), (params,), ()):
        env.step(1.0, *given)
    assert env.traced == ([True] if one else [True, False])


@pytest.mark.parametrize("way", CALLS)
def test_the_result_is_the_same_in_every_way(way):
    np.testing.assert_array_equal(CALLS[way](), 6.0)


@pytest.mark.parametrize(("way", "quick"), [("alone", True), ("jit", False), ("vmap", False)])
def test_only_calls_from_outside_compile_quickly(way, quick, monkeypatch):
    """XLA refuses an option that does not exist, so whoever passes it is found out."""
    monkeypatch.setattr(eager, "_QUICK", {"no_such_option": True})
    method = quick_alone(lambda self, x: x * self.factor)
    monkeypatch.setattr(Doubler, "times", method)
    if quick:
        with pytest.raises(Exception, match="no_such_option"):
            CALLS[way]()
    else:
        np.testing.assert_array_equal(CALLS[way](), 6.0)


def test_environments_stay_compiled_where_jit_is_switched_off(small_env, small_state):
    """Whoever debugs a training loop step by step need not wait for a solver step by step."""
    with jax.disable_jit():
        _, state, *_ = small_env.step(jax.random.key(0), small_state, jnp.zeros(6, jnp.int32))
    assert state.timestep == 1
