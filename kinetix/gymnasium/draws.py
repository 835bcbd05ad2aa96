"""The draws of a batch: each environment has its own, as one that stands alone has."""

from collections.abc import Sequence
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from gymnasium.utils import seeding
from jaxtyping import Array, Bool

SEEDS: Final = 2**31
"""Keys are drawn from so many."""


class Draws:
    """The key with which each environment begins its next episode.

    It is drawn as `KinetixGymEnv.reset` draws it, so environment i of a batch that was begun with
    the seed s plays the same levels, one after the other, as one alone that was begun with s + i.
    """

    def __init__(self, generators: Sequence[np.random.Generator]) -> None:
        """Begin with a generator for each environment."""
        self._generators = list(generators)
        self._next = np.array([each.integers(SEEDS) for each in self._generators], np.uint32)
        self._keys: Array | None = None

    @classmethod
    def of(cls, generator: np.random.Generator, count: int) -> "Draws":
        """Return random numbers from one shared generator, for unseeded environments."""
        seeds = generator.integers(SEEDS, size=count).tolist()
        return cls([seeding.np_random(seed)[0] for seed in seeds])

    def seed(self, seeds: Sequence[int | None], chosen: Bool[np.ndarray, " n"]) -> None:
        """Seed each environment; None leaves its random numbers as they are.

        Args:
            seeds: One for each environment.
            chosen: Which environments are meant.
        """
        for index in np.flatnonzero(chosen).tolist():
            seed = seeds[index]
            if seed is not None:
                self._generators[index] = seeding.np_random(seed)[0]
                self._draw(index)

    def keys(self) -> Array:
        """Return the keys with which environments begin next, a typed key each."""
        if self._keys is None:
            self._keys = jax.vmap(jax.random.key)(jnp.asarray(self._next))
        return self._keys

    def use(self, begun: Bool[np.ndarray, " n"]) -> None:
        """Draw new numbers for the environments that have begun with their keys."""
        for index in np.flatnonzero(begun).tolist():
            self._draw(index)

    def _draw(self, index: int) -> None:
        self._next[index] = self._generators[index].integers(SEEDS)
        self._keys = None
