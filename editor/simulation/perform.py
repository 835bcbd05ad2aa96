"""From requests to what does them."""

import sys
from collections.abc import Callable
from typing import Any, Final

import jax

from editor.requests import (
    Advance,
    CheckDynamics,
    ExportFilm,
    ExportPicture,
    Mutate,
    Progress,
    RandomLevel,
    RenderState,
    Request,
    Restore,
    StartEpisode,
    WarmUp,
)
from editor.simulation.episode import Episode, warm_up
from editor.simulation.levels import check_dynamics, drawn, mutated
from editor.simulation.pictures import export_film, export_picture, render_state
from kinetix.engine.presets import PRESETS
from kinetix.engine.solvers import SOLVERS
from kinetix.errors import KinetixError
from kinetix.level.sizes import SIZES
from kinetix.paths import cache_dir

SWITCH_SECONDS: Final = 1e-3
"""How long this thread may keep the interpreter while it traces: the window needs its share."""


class _Bridge:
    """What lasts between requests: the episode that is being played."""

    def __init__(self) -> None:
        sys.setswitchinterval(SWITCH_SECONDS)
        if getattr(jax.config, "jax_compilation_cache_dir", None) is None:
            jax.config.update("jax_compilation_cache_dir", str(cache_dir() / "jax"))
        self._episode: Episode | None = None
        self._does: dict[type, Callable[[Any, Progress], Any]] = {
            WarmUp: self._warm_up,
            StartEpisode: self._start,
            Advance: self._advance,
            Restore: self._restore,
            RenderState: lambda request, _: render_state(request),
            RandomLevel: lambda request, _: drawn(request),
            Mutate: lambda request, _: mutated(request),
            CheckDynamics: check_dynamics,
            ExportPicture: lambda request, _: export_picture(request),
            ExportFilm: export_film,
        }

    def perform(self, request: Request, progress: Progress) -> Any:
        """Do one request."""
        return self._does[type(request)](request, progress)

    def _warm_up(self, request: WarmUp, progress: Progress) -> tuple[str, ...]:
        """Compile the named sizes; the result is the names of all presets and solvers."""
        for k, size in enumerate(request.sizes):
            progress.report(k / len(request.sizes), f"Compiling size {size}")
            warm_up(SIZES[size], request.physics)
        return (*PRESETS, *SOLVERS)

    def _start(self, request: StartEpisode, progress: Progress) -> Any:
        progress.report(None, "Compiling the level")
        self._episode = Episode(request)
        return self._episode.snapshot

    def _advance(self, request: Advance, progress: Progress) -> Any:
        del progress
        return self._of(request.run).advance(request)

    def _restore(self, request: Restore, progress: Progress) -> None:
        del progress
        self._of(request.run).restore(request.snapshot)

    def _of(self, run: int) -> Episode:
        if self._episode is None or self._episode.run != run:
            raise KinetixError("The episode was given up meanwhile.")
        return self._episode


_BRIDGES: list[_Bridge] = []


def perform(request: Request, progress: Progress) -> Any:
    """Do a request on the worker's thread.

    Args:
        request: What to do.
        progress: Told how far it is; raises `Cancelled` when nobody waits any more.

    Raises:
        KinetixError: It cannot be done; the sentence says why.
    """
    if not _BRIDGES:
        _BRIDGES.append(_Bridge())
    return _BRIDGES[0].perform(request, progress)
