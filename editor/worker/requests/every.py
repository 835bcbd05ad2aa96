"""All requests, and what answers them."""

from collections.abc import Callable
from typing import Any, TypeAlias

from editor.worker.requests.agents import Evaluate, LoadAgent, Rehearse
from editor.worker.requests.attempts import TracePaths
from editor.worker.requests.episodes import (
    Advance,
    OpenEpisode,
    PlaySolution,
    Restore,
    StartEpisode,
)
from editor.worker.requests.explaining import Explain, Observe
from editor.worker.requests.exports import AddEpisode, ExportFilm, ExportPicture, RenderState
from editor.worker.requests.levels import CheckDynamics, Mutate, RandomLevel
from editor.worker.requests.programs import GetReady, KeepPrograms, Tailor, WarmUp
from editor.worker.requests.progress import Progress
from editor.worker.requests.training import ReadCurriculum, ReadRun

Request: TypeAlias = (
    WarmUp
    | GetReady
    | KeepPrograms
    | Tailor
    | LoadAgent
    | Rehearse
    | Evaluate
    | OpenEpisode
    | TracePaths
    | PlaySolution
    | Observe
    | Explain
    | ReadRun
    | ReadCurriculum
    | StartEpisode
    | Advance
    | Restore
    | RenderState
    | RandomLevel
    | Mutate
    | CheckDynamics
    | ExportPicture
    | ExportFilm
    | AddEpisode
)


Perform: TypeAlias = Callable[[Request, Progress], Any]
"""Does a request on the worker's thread."""
