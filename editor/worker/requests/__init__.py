"""Requests of the app to the background worker: plain frozen values, and their results."""

from editor.worker.requests.agents import (
    BUILT_IN,
    PLANNER,
    AgentRef,
    AgentSummary,
    Casting,
    Evaluate,
    EvaluatedLevel,
    LoadAgent,
    Rehearse,
    Score,
    Standing,
)
from editor.worker.requests.attempts import AttemptPaths, Ending, TracePaths
from editor.worker.requests.episodes import (
    Advance,
    Opened,
    OpenEpisode,
    PlaySolution,
    Pull,
    Restore,
    StartEpisode,
)
from editor.worker.requests.every import Perform, Request
from editor.worker.requests.explaining import (
    About,
    AgentView,
    Explain,
    Explained,
    Observe,
    ViewTable,
)
from editor.worker.requests.exports import AddEpisode, ExportFilm, ExportPicture, Image, RenderState
from editor.worker.requests.levels import (
    MUTATIONS,
    CheckDynamics,
    DynamicsReport,
    Mutate,
    RandomLevel,
)
from editor.worker.requests.programs import GetReady, KeepPrograms, Tailor, WarmUp
from editor.worker.requests.progress import Cancelled, Progress
from editor.worker.requests.training import CurriculumNews, Place, ReadCurriculum, ReadRun, RunNews

__all__ = [
    "BUILT_IN",
    "MUTATIONS",
    "PLANNER",
    "About",
    "AddEpisode",
    "Advance",
    "AgentRef",
    "AgentSummary",
    "AgentView",
    "AttemptPaths",
    "Cancelled",
    "Casting",
    "CheckDynamics",
    "CurriculumNews",
    "DynamicsReport",
    "Ending",
    "Evaluate",
    "EvaluatedLevel",
    "Explain",
    "Explained",
    "ExportFilm",
    "ExportPicture",
    "GetReady",
    "Image",
    "KeepPrograms",
    "LoadAgent",
    "Mutate",
    "Observe",
    "OpenEpisode",
    "Opened",
    "Perform",
    "Place",
    "PlaySolution",
    "Progress",
    "Pull",
    "RandomLevel",
    "ReadCurriculum",
    "ReadRun",
    "Rehearse",
    "RenderState",
    "Request",
    "Restore",
    "RunNews",
    "Score",
    "Standing",
    "StartEpisode",
    "Tailor",
    "TracePaths",
    "ViewTable",
    "WarmUp",
]
