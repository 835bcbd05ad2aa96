"""Kernels that environments share."""

import dataclasses
from typing import ClassVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from kinetix.environment.env import make_kinetix_env
from kinetix.environment.observations import FlatObservations
from kinetix.environment.params import static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.environment.state import EnvState
from tests.environment.conftest import small_level


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Counted(FlatObservations):
    """Notes each time that it is traced."""

    name: ClassVar[str] = "counted"
    traced: ClassVar[list[EnvState]] = []

    def __call__(self, state: EnvState) -> Float[Array, " f"]:
        """The flat vector."""
        self.traced.append(state)
        return super().__call__(state)


def test_environments_that_differ_in_their_starts_are_traced_once() -> None:
    """Training and evaluation draw other levels and play alike: the step is traced for one."""
    static = static_env_params_from_size("s")
    start = level_state(small_level(), static)
    keys = jax.random.split(jax.random.PRNGKey(0), 3)

    def trace() -> int:
        env = make_kinetix_env(
            "multi_discrete", _Counted, reset_fn=lambda key: start, static_env_params=static
        )
        states = jax.vmap(lambda key: start)(keys)
        actions = jnp.zeros((3, 6), jnp.int32)
        before = len(_Counted.traced)
        step = jax.jit(jax.vmap(dataclasses.replace(env, auto_reset=False).step))
        step.trace(keys, states, actions).lower()
        return len(_Counted.traced) - before

    assert trace() > 0
    assert trace() == 0
