"""The parts of an update: each is announced while it compiles, and timed."""

import dataclasses
import time
from collections.abc import Callable
from typing import Any, Final

import jax

from kinetix.training.progress_text import Say, say_nothing


@dataclasses.dataclass(frozen=True, kw_only=True)
class Part:
    """One piece of work that is over."""

    name: str
    seconds: float
    compiled: bool
    """True for the first of its name, and where something was compiled: mostly that takes its
    time."""


class _Compilations:
    """Counts what this process compiles or takes from the cache of compiled programs."""

    def __init__(self) -> None:
        """Listen to JAX from now on."""
        self.count = 0
        jax.monitoring.register_event_duration_secs_listener(self._heard)

    def _heard(self, event: str, duration_secs: float, **kwargs: str | int) -> None:
        self.count += event == "/jax/core/compile/backend_compile_duration"


_COMPILATIONS: Final = _Compilations()


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
        before, began = _COMPILATIONS.count, time.monotonic()
        result = jax.block_until_ready(function(*arguments))
        seconds = time.monotonic() - began
        compiled = first or _COMPILATIONS.count > before
        self._known.add(name)
        self._parts.append(Part(name=name, seconds=seconds, compiled=compiled))
        return result

    def taken(self) -> list[Part]:
        """Return the parts since the last call."""
        parts, self._parts = self._parts, []
        return parts
