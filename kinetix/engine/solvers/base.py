"""The contract of every solver."""

import abc
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Int

from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World


class AbstractSolver(abc.ABC):
    """Advances worlds by one time step under contacts and joints.

    Subclasses are frozen dataclasses of Python numbers: hashable, hence static under jit; two
    settings, two compilations. Arrays of the arguments carry the worlds on their last axis.
    """

    @abc.abstractmethod
    def empty_cache(self, spec: SceneSpec) -> Any:
        """Return `State.cache` before the first step, for one world, as numpy zeros."""

    @abc.abstractmethod
    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        """Advance by `parameters.dt`, worlds on the last axis.

        Returns:
            The new state; `touching` says which candidate pairs touched at the *start* of the step
            (or were hit in it), pairs that never push each other included.
        """

    def effort(self, world: World, state: State) -> Int[Array, " n"]:
        """Estimate each world's work from its state, to group worlds by."""
        del world
        return jnp.sum(state.touching, axis=0, dtype=jnp.int32)
