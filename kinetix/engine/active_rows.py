"""Loops over what a tile of worlds uses, so that the rest costs nothing.

A scene of size l has room for 20 contact points and 6 joints; most of its worlds use four of the
one and two of the other. Worlds are on the last axis.
"""

import functools
import itertools
from collections.abc import Callable, Sequence
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.lookup import row
from kinetix.pytree import pytree, static

T = TypeVar("T")


@pytree
class InUse:
    """Number of links (pairs of bodies) of each group that any world uses: always the first ones.

    Links have one or several rows: first rows of all links of the first group, then their second
    rows …, then the next group.
    """

    counts: tuple[Int[Array, ""], ...]
    groups: tuple[tuple[int, int], ...] = static()
    """Of links that have as many rows each, as (links, rows of each)."""

    @staticmethod
    def of(*groups: tuple[Bool[Array, "k n"], int]) -> "InUse":
        """Up to the last link of each group that any world uses.

        Args:
            groups: Which links are used, and how many rows each link of the group has.
        """
        return InUse(
            counts=tuple(_last_used(used) for used, _ in groups),
            groups=tuple((used.shape[0], rows) for used, rows in groups),
        )

    @property
    def links(self) -> int:
        """Number of links, used or not."""
        return sum(links for links, _ in self.groups)

    @property
    def rows(self) -> int:
        """Number of rows, used or not."""
        return sum(links * rows for links, rows in self.groups)

    def one_row_each(self) -> "InUse":
        """Return the same links with a row each."""
        return InUse(counts=self.counts, groups=tuple((links, 1) for links, _ in self.groups))

    def each(self, visit: Callable[[Int[Array, ""], T], T], start: T) -> T:
        """Visit the rows in use, in their order."""
        blocks = [
            (count, first + number * links)
            for count, (links, rows), first in zip(
                self.counts, self.groups, self._first_rows(), strict=True
            )
            for number in range(rows)
        ]
        return _visited(blocks, self.rows, visit, start)

    def each_link(self, visit: Callable[[Int[Array, ""], T], T], start: T) -> T:
        """Visit the links in use, in their order."""
        first = np.cumsum([0, *(links for links, _ in self.groups)])
        blocks = list(zip(self.counts, first[:-1].tolist(), strict=True))
        return _visited(blocks, self.links, visit, start)

    def each_of_link(
        self, visit: Callable[[Int[Array, ""], list[Int[Array, ""]], T], T], start: T
    ) -> T:
        """Visit the links in use, each with the numbers of all its rows."""
        first = np.cumsum([0, *(links for links, _ in self.groups)]).tolist()
        for group, count, first_link, first_row in zip(
            self.groups, self.counts, first[:-1], self._first_rows(), strict=True
        ):
            one = functools.partial(_of_link, visit, group, first_link, first_row)
            if group[0]:
                start = jax.lax.fori_loop(0, count, one, start)
        return start

    def _first_rows(self) -> list[int]:
        return np.cumsum([0, *(links * rows for links, rows in self.groups)])[:-1].tolist()

    def inner(self, left: Float[Array, "m n"], right: Float[Array, "m n"]) -> Float[Array, " n"]:
        """Return the sum of the products of vectors that are 0 in rows that are not in use."""

        def add(k: Int[Array, ""], total: Float[Array, " n"]) -> Float[Array, " n"]:
            return total + row(left, k)[0] * row(right, k)[0]

        return self.each(add, jnp.zeros(left.shape[1:], left.dtype))

    def product(
        self, matrix: Float[Array, "m m n"], vector: Float[Array, "m n"]
    ) -> Float[Array, "m n"]:
        """Return a symmetric matrix times a vector that is 0 in rows that are not in use."""

        def add(k: Int[Array, ""], total: Float[Array, "m n"]) -> Float[Array, "m n"]:
            return total + row(matrix, k)[0] * row(vector, k)

        return self.each(add, jnp.zeros_like(vector))


def _of_link(
    visit: Callable[[Int[Array, ""], list[Int[Array, ""]], T], T],
    group: tuple[int, int],
    first_link: int,
    first_row: int,
    k: Int[Array, ""],
    carry: T,
) -> T:
    links, rows = group
    return visit(k + first_link, [k + first_row + number * links for number in range(rows)], carry)


def _visited(
    blocks: Sequence[tuple[Int[Array, ""], int]],
    most: int,
    visit: Callable[[Int[Array, ""], T], T],
    start: T,
) -> T:
    """One loop through the first entries of some blocks, each given by their number and place."""
    # Without bodies not even the shape of a visit is known.
    if most == 0:
        return start
    ends = list(itertools.accumulate(count for count, _ in blocks))

    def one(visited: Int[Array, ""], carry: T) -> T:
        index = visited + blocks[0][1]
        for (_, first), before in zip(blocks[1:], ends[:-1], strict=True):
            index = jnp.where(visited >= before, visited - before + first, index)
        return visit(index, carry)

    return jax.lax.fori_loop(0, ends[-1], one, start)


def _last_used(mask: Bool[Array, "c n"]) -> Int[Array, ""]:
    """Count the rows up to the last one that any world uses."""
    rows = np.arange(1, mask.shape[0] + 1, dtype=np.int32)
    return jnp.max(jnp.where(jnp.any(mask, axis=1), rows, 0), initial=0)
