"""From requests to what does them."""

import sys
import threading
from collections.abc import Callable
from typing import Any, Final

import jax

from editor.worker.requests import (
    AddEpisode,
    Advance,
    CheckDynamics,
    Evaluate,
    Explain,
    ExportFilm,
    ExportPicture,
    GetReady,
    KeepPrograms,
    LoadAgent,
    Mutate,
    Observe,
    OpenEpisode,
    PlaySolution,
    Progress,
    RandomLevel,
    ReadCurriculum,
    ReadRun,
    Rehearse,
    RenderState,
    Request,
    Restore,
    StartEpisode,
    Tailor,
    TracePaths,
    WarmUp,
)
from editor.worker.simulation.cast import load, rehearse
from editor.worker.simulation.curriculum import read_curriculum
from editor.worker.simulation.dataset import add_episode
from editor.worker.simulation.episode import Episode, play_solution
from editor.worker.simulation.evaluating import open_episode, run_evaluation, trace_paths
from editor.worker.simulation.explaining import explain
from editor.worker.simulation.levels import check_dynamics, drawn, mutated
from editor.worker.simulation.observing import observe
from editor.worker.simulation.pictures import export_film, export_picture, render_state
from editor.worker.simulation.run_news import read_run
from editor.worker.simulation.stepping import get_ready, keep_programs, tailor, warm_up
from kinetix.engine.presets import PRESETS
from kinetix.engine.solvers import SOLVERS
from kinetix.errors import KinetixError
from kinetix.level.sizes import parse_capacity
from kinetix.paths import cache_dir

SWITCH_SECONDS: Final = 1e-3
"""Longest time for which this thread keeps the interpreter while it traces [s]."""


class _Bridge:
    """State between requests: the episodes that are being played, by slot."""

    def __init__(self) -> None:
        sys.setswitchinterval(SWITCH_SECONDS)
        if getattr(jax.config, "jax_compilation_cache_dir", None) is None:
            jax.config.update("jax_compilation_cache_dir", str(cache_dir() / "jax"))
        self._episodes: dict[str, Episode] = {}
        self._does: dict[type, Callable[[Any, Progress], Any]] = {
            WarmUp: self._warm_up,
            GetReady: self._get_ready,
            KeepPrograms: lambda request, _: keep_programs(),
            Tailor: tailor,
            StartEpisode: self._start,
            Advance: self._advance,
            Restore: self._restore,
            RenderState: lambda request, _: render_state(request),
            RandomLevel: lambda request, _: drawn(request),
            Mutate: lambda request, _: mutated(request),
            CheckDynamics: check_dynamics,
            ExportPicture: lambda request, _: export_picture(request),
            ExportFilm: export_film,
            AddEpisode: add_episode,
            LoadAgent: lambda request, _: load(request.path),
            Rehearse: self._rehearse,
            Evaluate: run_evaluation,
            OpenEpisode: open_episode,
            TracePaths: trace_paths,
            PlaySolution: play_solution,
            Observe: lambda request, _: observe(request),
            Explain: lambda request, _: explain(request),
            ReadRun: lambda request, _: read_run(request),
            ReadCurriculum: lambda request, _: read_curriculum(request),
        }

    def perform(self, request: Request, progress: Progress) -> Any:
        """Do one request."""
        return self._does[type(request)](request, progress)

    def _warm_up(self, request: WarmUp, progress: Progress) -> tuple[str, ...]:
        """Compile the named sizes; the result is the names of all presets and solvers."""
        for size in request.sizes:
            progress.report(None, f"Compiling size {size}")
            warm_up(parse_capacity(size), request.physics, progress)
        return (*PRESETS, *SOLVERS)

    def _get_ready(self, request: GetReady, progress: Progress) -> tuple[str, ...]:
        get_ready(request, progress)
        return (*PRESETS, *SOLVERS)

    def _start(self, request: StartEpisode, progress: Progress) -> Any:
        episode = Episode(request, progress)
        self._episodes[request.slot] = episode
        return episode.snapshot

    def _rehearse(self, request: Rehearse, progress: Progress) -> None:
        rehearse(request, progress)

    def _advance(self, request: Advance, progress: Progress) -> Any:
        del progress
        return self._of(request).advance(request)

    def _restore(self, request: Restore, progress: Progress) -> None:
        self._of(request).restore(request, progress)

    def _of(self, request: Advance | Restore) -> Episode:
        episode = self._episodes.get(request.slot)
        if episode is None or episode.run != request.run:
            raise KinetixError("The episode was given up meanwhile.")
        return episode


_BRIDGES: list[_Bridge] = []
_FIRST = threading.Lock()


def perform(request: Request, progress: Progress) -> Any:
    """Do a request on the worker's thread.

    Args:
        request: What to do.
        progress: Called with how far it is; raises `Cancelled` when nobody waits any more.

    Raises:
        KinetixError: The request cannot be done; the message says why.
    """
    with _FIRST:  # there are two workers
        if not _BRIDGES:
            _BRIDGES.append(_Bridge())
    return _BRIDGES[0].perform(request, progress)
