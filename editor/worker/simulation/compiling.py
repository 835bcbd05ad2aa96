"""Programs compiled in threads of their own: who waits sees how far it is, and may leave at once.

XLA cannot be interrupted. So nobody who can be called off compiles: a thread does, and the others
wait for it. When nobody waits any more it gives up before its next stage; what has come as far as
XLA is finished and kept, as it may be wanted again.
"""

import collections
import contextlib
import dataclasses
import math
import os
import threading
import time
from collections.abc import Callable, Hashable
from typing import Any, Final

from editor.worker.priority import step_back
from editor.worker.requests import Cancelled, Progress
from editor.worker.simulation.quiet import not_stored
from editor.worker.yielding import without_pauses
from kinetix.compiler import quick_options

KEPT: Final = 24
"""Programs that are kept in memory, the last ones used: each holds some megabytes."""
BACKGROUND_NICENESS: Final = 10
"""Niceness of background work: it leaves the processor to the window and to playing."""
_LOOK_SECONDS: Final = 0.05
"""Interval at which a waiting thread checks for cancellation [s]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Tier:
    """Optimisation level of the compiler."""

    name: str
    options: tuple[tuple[str, int | bool | str], ...]
    """Of XLA, by the names of its debug options."""
    compiling: float
    """Seconds that XLA takes for a second of tracing and lowering (measured at sizes s and l)."""


QUICK: Final = Tier(name="quick", options=tuple(quick_options().items()), compiling=1.0)
"""A quarter of the time to compile; a step takes 2.5 times as long, still far from a sixtieth."""
FULL: Final = Tier(name="full", options=(), compiling=5.0)

_OWN_CACHE: Final = "JAX_COMPILATION_CACHE_DIR" in os.environ
"""If the user names a folder for JAX's cache, everything goes there."""
_TRACING: Final = 0.18
"""Share of tracing in tracing and lowering."""


class Pace:
    """Duration of tracing and lowering the last time, from which the next is estimated."""

    seconds = 1.5


_AS_EXPECTED: Final = 0.75
"""Up to this share, progress follows the usual duration."""


def slowing(share: float) -> float:
    """Return how far something is that may take longer than usual: it never stands still.

    Args:
        share: Time that has passed, as a share of the usual duration.
    """
    if share <= _AS_EXPECTED:
        return share
    return 1 - (1 - _AS_EXPECTED) * math.exp(1 - share / _AS_EXPECTED)


class Compilation:
    """A program on its way."""

    def __init__(
        self,
        recipe: "Recipe",
        lock: threading.Lock,
        *,
        background: bool,
        done: Callable[["Compilation"], None],
    ) -> None:
        """Begin.

        Args:
            recipe: What to compile.
            lock: Held while a waiter is added or removed.
            background: Whether it may take its time.
            done: Called at the end, by the thread that compiles.
        """
        self.recipe = recipe
        self.waiting = 1
        """Number of waiting threads; the lock guards it."""
        self._lock = lock
        self.given_up = False
        self.result: Any = None
        self.error: BaseException | None = None
        self.finished = threading.Event()
        self._background = background
        self._done = done
        self._stage, self._since = 0, time.monotonic()
        self._thread = threading.Thread(target=self._run, name="compiling", daemon=True)
        self._thread.start()

    @property
    def fraction(self) -> float:
        """Progress; inside a stage estimated from the usual duration."""
        shares = self._shares()
        expected = shares[self._stage] * Pace.seconds * (1 + self.recipe.tier.compiling)
        inside = slowing((time.monotonic() - self._since) / max(expected, 1e-3))
        return sum(shares[: self._stage]) + shares[self._stage] * inside

    @property
    def message(self) -> str:
        """Present activity."""
        return ("Reading the physics", "Writing the program", "Compiling")[self._stage]

    def _shares(self) -> tuple[float, float, float]:
        whole = 1 + self.recipe.tier.compiling
        return _TRACING / whole, (1 - _TRACING) / whole, self.recipe.tier.compiling / whole

    def _run(self) -> None:
        try:
            cached = contextlib.nullcontext() if self.recipe.stored or _OWN_CACHE else not_stored()
            with _Turn(self, background=self._background), without_pauses(), cached:
                start = time.monotonic()
                self._enter(0)
                traced = self.recipe.trace()
                self._enter(1)
                lowered = traced.lower()
                self._enter(2)
                Pace.seconds = time.monotonic() - start
                self.result = lowered.compile(compiler_options=dict(self.recipe.tier.options))
        except BaseException as error:
            self.error = error
        self._done(self)
        self.finished.set()

    def _enter(self, stage: int) -> None:
        self._stage, self._since = stage, time.monotonic()
        self.check()

    def check(self) -> None:
        """Give up where nobody waits any more.

        Raises:
            Cancelled: Nobody does.
        """
        with self._lock:
            self.given_up = not self.waiting
        if self.given_up:
            raise Cancelled


_BACKGROUND: Final = threading.Semaphore(1)


class _Turn:
    """In the background one program is compiled at a time, and at a low priority."""

    def __init__(self, compilation: Compilation, *, background: bool) -> None:
        self._compilation, self._background = compilation, background

    def __enter__(self) -> None:
        if not self._background:
            return
        while not _BACKGROUND.acquire(timeout=_LOOK_SECONDS):
            self._compilation.check()
        step_back(BACKGROUND_NICENESS)

    def __exit__(self, *_: object) -> None:
        if self._background:
            _BACKGROUND.release()


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recipe:
    """Key of a program and the function that makes it."""

    key: Hashable
    """Equal keys mean the same program."""
    tier: Tier
    trace: Callable[[], Any] = dataclasses.field(compare=False)
    """Gives what `jax.jit(…).trace(…)` does."""
    stored: bool = False
    """True if JAX's own cache on disk is to keep it."""


class Programs:
    """The compiled programs, the last used ones, and those on their way; threads share it."""

    def __init__(self) -> None:
        self._ready: collections.OrderedDict[Hashable, Any] = collections.OrderedDict()
        self._coming: dict[Hashable, Compilation] = {}
        self._lock = threading.Lock()
        self.fresh: list[tuple[Hashable, Any]] = []
        """Programs that were compiled and have not been written to disk."""

    def get(self, key: Hashable) -> Any | None:
        """Return a program that is ready, or None."""
        with self._lock:
            program = self._ready.get(key)
            if program is not None:
                self._ready.move_to_end(key)
            return program

    def put(self, key: Hashable, program: Any) -> None:
        """Keep a program; the one that was used least recently goes when there are too many."""
        with self._lock:
            self._put(key, program)

    def _put(self, key: Hashable, program: Any) -> None:
        self._ready[key] = program
        while len(self._ready) > KEPT:
            self._ready.popitem(last=False)

    def obtain(self, recipe: Recipe, progress: Progress, *, background: bool = False) -> Any:
        """Return a program: from memory, or when it has been compiled.

        Args:
            recipe: Which.
            progress: Called with how far it is.
            background: Nobody waits for it but a job that can wait.

        Raises:
            Cancelled: It is not wanted any more.
        """
        with self._lock:
            ready = self._ready.get(recipe.key)
            if ready is not None:
                self._ready.move_to_end(recipe.key)
                return ready
            coming = self._coming.get(recipe.key)
            if coming is None or coming.given_up:
                coming = Compilation(recipe, self._lock, background=background, done=self._made)
                self._coming[recipe.key] = coming
            else:
                coming.waiting += 1
        try:
            while not coming.finished.wait(_LOOK_SECONDS):
                progress.report(coming.fraction, coming.message)
        finally:
            with self._lock:
                coming.waiting -= 1
        if coming.error is not None:
            if isinstance(coming.error, Cancelled):  # it gave up just before somebody came
                return self.obtain(recipe, progress, background=background)
            raise coming.error
        return coming.result

    def _made(self, compilation: Compilation) -> None:
        key = compilation.recipe.key
        with self._lock:
            if self._coming.get(key) is compilation:
                del self._coming[key]
            if compilation.error is None:
                self._put(key, compilation.result)
                self.fresh = [*self.fresh, (key, compilation.result)][-KEPT:]

    def taken_fresh(self) -> list[tuple[Hashable, Any]]:
        """Return the programs compiled since the last call."""
        with self._lock:
            fresh, self.fresh = self.fresh, []
        return fresh
