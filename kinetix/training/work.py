"""The parts of an update: each is announced while it compiles, and timed."""

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import jax

from kinetix.training.telling import Say, say_nothing


@dataclasses.dataclass(frozen=True, kw_only=True)
class Part:
    """One piece of work that is over."""

    name: str
    seconds: float
    compiled: bool
    """True for the first of its name, whose time is mostly that of compiling."""


class Work:
    """Runs compiled functions by name."""

    def __init__(self) -> None:
        """Nothing has been done yet."""
        self.status: Say = say_nothing
        """Takes words for what is under way."""
        self._known: set[str] = set()
        self._parts: list[Part] = []

    def __call__(self, name: str, function: Callable[..., Any], *arguments: Any) -> Any:
        """Run a compiled function to its end and note how long that took.

        Args:
            name: What the terminal calls it.
            function: Compiled by JAX; its first call compiles.
            *arguments: For the function.
        """
        first = name not in self._known
        if first:
            self.status(f"compiling: {name}")
        began = time.monotonic()
        result = jax.block_until_ready(function(*arguments))
        self._known.add(name)
        self._parts.append(Part(name=name, seconds=time.monotonic() - began, compiled=first))
        return result

    def taken(self) -> list[Part]:
        """Return the parts since the last call."""
        parts, self._parts = self._parts, []
        return parts
