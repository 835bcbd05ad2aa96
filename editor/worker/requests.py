"""Requests of the app to the background worker: plain frozen values, and their results."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Literal, Protocol, TypeAlias

import numpy as np
from jaxtyping import Float, Int, UInt8

from editor.worker.recording import Snapshot, Trace
from kinetix.agents.results import LevelFailure, LevelResult
from kinetix.environment.outcome import Outcome
from kinetix.level.model import Level
from kinetix.training.curricula.pages import BufferPage

MUTATIONS: Final = (
    ("add_shape", "Add a shape"),
    ("add_connected_shape", "Add a jointed shape"),
    ("add_thruster", "Add a thruster"),
    ("remove_shape", "Remove a shape"),
    ("remove_joint", "Remove a joint"),
    ("remove_thruster", "Remove a thruster"),
    ("swap_role", "Swap two roles"),
    ("toggle_fixture", "Fix or free a shape"),
    ("change_gravity", "Change gravity"),
    ("change_size", "Change a size"),
    ("change_location", "Move a shape"),
    ("change_rotation", "Turn a shape"),
)
"""Names and labels of the mutations that the simulation offers."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pull:
    """The mouse pulls at a body with a spring."""

    body: int
    """Id of the body."""
    anchor: tuple[float, float]
    """Grabbed point, in the body's frame [m]."""
    target: tuple[float, float]
    """Mouse position [m]."""
    teleport: bool = False
    """Put the body there instead of pulling (while paused)."""


About: TypeAlias = Literal["value", "action"]
"""Target of a gradient (a test keeps it that of `kinetix.agents.explain`)."""

PLANNER: Final = "planner"
BUILT_IN: Final = (PLANNER, "noop", "random")
"""Agents that need no folder (a test keeps them those of `kinetix.agents`)."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgentRef:
    """Reference to an agent."""

    path: str
    """Its folder or training run, or the name of a scripted one."""
    stamp: str = ""
    """State of the folder that was loaded; another stamp is another agent."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Casting:
    """An agent and the draws that it gets: the same casting gives the same episode."""

    agent: AgentRef
    seed: int = 0
    attempt: int = 0
    """As in an evaluation: attempt k under a seed has the same draws in both."""
    deterministic: bool = False
    """Take the likeliest action instead of drawing one."""
    digest: str = ""
    """SHA-256 of the agent's parameters, for what is kept of the episode."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgentSummary:
    """Facts about an agent for the window."""

    ref: AgentRef
    name: str
    description: str
    observation: str
    action: str
    network: str
    """In words: `entity transformer, 2 layers of 128, actor 5 × 128`."""
    parameters: int
    recurrent: bool
    capacity: tuple[int, int, int, int] | None
    """Polygons with the arena, circles, joints, thrusters that it was trained with."""
    any_size: bool
    """True if it plays levels of any size."""
    physics: str
    """Physics it was trained under."""
    frame_skip: int
    steps: int | None
    """Environment steps of training, where it says."""
    training: str
    """Algorithm and the like, one line."""
    folder: str
    """Folder of its arrays: of a training run the newest checkpoint."""
    digest: str = ""
    """SHA-256 of its parameters; empty for scripted ones."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class LoadAgent:
    """Read an agent from its folder. Gives an `AgentSummary`."""

    path: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rehearse:
    """Compile what an agent needs to play a level, so that Play starts at once. Gives nothing."""

    level: Level
    physics: str
    casting: Casting
    quick: bool = False
    """Compile it quickly, unless there is a better one."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EvaluatedLevel:
    """A level of an evaluation."""

    name: str
    source: str | Level
    """A file, or the document as it stands."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Evaluate:
    """Play every agent on every level; shares each `Standing`, gives the last one."""

    agents: tuple[AgentRef, ...]
    levels: tuple[EvaluatedLevel, ...]
    attempts: int
    seed: int
    physics: str
    """Empty: each agent's own."""
    deterministic: bool


@dataclasses.dataclass(frozen=True, kw_only=True)
class Score:
    """Result of an agent on a level."""

    agent: int
    """Index into the agents that were asked for."""
    result: LevelResult


@dataclasses.dataclass(frozen=True, kw_only=True)
class Standing:
    """Progress of an evaluation."""

    done: int
    """Episodes."""
    total: int
    scores: tuple[Score, ...]
    errors: tuple[tuple[int, str], ...] = ()
    """Agents that could not play at all, and why."""
    failures: tuple[tuple[int, LevelFailure], ...] = ()
    """Agents and levels that they could not play."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class OpenEpisode:
    """Play one attempt of an evaluation again, the same to the bit. Gives an `Opened`."""

    level: EvaluatedLevel
    casting: Casting
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class TracePaths:
    """Note where the green shape is in all attempts on a level. Gives `AttemptPaths`."""

    level: EvaluatedLevel
    casting: Casting
    """With any attempt."""
    attempts: int
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Ending:
    """Attempts that end alike; the fields of `kinetix.agents.paths.Ending`."""

    outcome: Outcome
    attempts: tuple[int, ...]
    place: tuple[float, float]
    length: int
    parting: int | None


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class AttemptPaths:
    """The ways of all attempts on a level; axis `n` attempts, `k` places in time."""

    level_hash: str
    step: Int[np.ndarray, " k"]
    """Environment steps since the start."""
    position: Float[np.ndarray, "n k 2"]
    """Of the first green shape [m]."""
    outcomes: tuple[Outcome, ...]
    parting: int | None
    """Step at which attempts that are won leave the others; None where they do not."""
    endings: tuple[Ending, ...] = ()
    """The attempts grouped by how they end, the largest group first."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Opened:
    """An episode to look at."""

    level: Level
    trace: Trace


@dataclasses.dataclass(frozen=True, kw_only=True)
class PlaySolution:
    """Play the recorded solution of a level. Gives an `Opened`."""

    level: Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class Observe:
    """Ask for an agent's observation of a moment. Gives an `AgentView`."""

    level: Level
    state: Any
    """A snapshot's `state`, or None for the first state of the level."""
    agent: AgentRef | None
    """Agent whose form of observation is used; None: the entity form."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ViewTable:
    """One array of an observation with named columns."""

    name: str
    columns: tuple[tuple[str, str, str], ...]
    """Name, unit, meaning."""
    rows: tuple[str, ...]
    """Subject of each row."""
    values: Float[np.ndarray, "r c"]
    active: tuple[bool, ...]


@dataclasses.dataclass(frozen=True, kw_only=True)
class AgentView:
    """The picture and the numbers that an agent could see."""

    pixels: UInt8[np.ndarray, "h w 3"]
    """Rows from the top."""
    observation: str
    tables: tuple[ViewTable, ...]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Explain:
    """Explain an agent's action at a moment. Gives an `Explained`."""

    level: Level
    state: Any
    """A snapshot's `state`, or None for the first state of the level."""
    memory: Any
    """The agent's at that moment; None: it has just begun."""
    agent: AgentRef
    physics: str
    about: About = "value"
    """Target of the gradient: the value, or the likeliest action's log-probability."""
    body: int | None = None
    """Id of a body whose places the value is told for; None: of none."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Explained:
    """Reasons for an agent's action; rows in the order of the level's entities."""

    attention: Float[np.ndarray, " b"] | None
    """Each body's share; None for networks without attention."""
    bodies: Float[np.ndarray, " b"]
    """Importance of each body: see `kinetix.agents.explain.Saliency`."""
    joints: Float[np.ndarray, " j"]
    thrusters: Float[np.ndarray, " t"]
    value: float
    """Value of the present state."""
    body: int | None = None
    places: Float[np.ndarray, "h w"] | None = None
    """Value with the body's origin in the middle of each cell; rows from below."""
    low: tuple[float, float] = (0.0, 0.0)
    """Lower left corner of the places [m]."""
    cell: float = 0.0
    """Side of a cell [m]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReadRun:
    """Look at a training run's folder. Gives a `RunNews`."""

    path: str
    after: int = 0
    """Rows of metrics that are known already."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class RunNews:
    """News of a training run."""

    rows: tuple[dict[str, float], ...]
    """Metrics, one row an update."""
    total: int
    """Rows in all; fewer than were known before: the run was set back."""
    newest: int | None
    """Environment steps of the newest complete checkpoint."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReadCurriculum:
    """Look at the history of a run's level buffer. Gives a `CurriculumNews`."""

    path: str
    update: int | None = None
    """The page to read; None: the newest, where it is another than `known`."""
    known: int | None = None
    """The page that is there already."""


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class CurriculumNews:
    """News of a level buffer's history."""

    updates: tuple[int, ...]
    """Updates of which there are pages."""
    page: BufferPage | None
    """The one that was asked for; None where there is none, or nothing newer."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class WarmUp:
    """Import JAX and compile the step for some sizes, so that Play starts at once.

    Sizes are names, or four numbers such as `12,4,6,2`.
    """

    sizes: tuple[str, ...] = ("s", "m", "l")
    physics: str = "balanced"


@dataclasses.dataclass(frozen=True, kw_only=True)
class GetReady:
    """Have a step that a level can be played in, soon. Gives the names of all presets and solvers.

    It is compiled quickly, unless there is a better one in memory or on disk.
    """

    level: Level
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class KeepPrograms:
    """Write what was compiled to the cache on disk, which stops all threads for a moment.

    What nobody has used for long is thrown away there. Gives nothing.
    """


@dataclasses.dataclass(frozen=True, kw_only=True)
class Tailor:
    """Compile a step for what one level can ever do, which costs less than the one of its size.

    Episodes of the level that a person plays begin with it from then on, and so do those of every
    level that can do the same. Gives nothing.
    """

    level: Level
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class StartEpisode:
    """Compile a level, if its size is new, and go to its first state. Gives a `Snapshot`."""

    run: int
    """Number of the episode; answers to older numbers are dropped."""
    level: Level
    physics: str
    keep_contacts: bool = False
    """True if snapshots carry contact points (debug drawing)."""
    casting: Casting | None = None
    """The player; None: hands alone, through `Advance`."""
    slot: str = "a"
    """Episodes of different slots run beside each other."""
    quick: bool = False
    """True if a step that was compiled quickly will do where no better one is ready."""
    since: Snapshot | None = None
    """Snapshot at which the level of the episode was changed; None: it begins."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Advance:
    """Play environment steps, one for each action. Gives a tuple of `Snapshot`."""

    run: int
    actions: tuple[tuple[int, ...] | None, ...]
    """None leaves the choice to the agent that was cast."""
    pull: Pull | None = None
    keep_contacts: bool = False
    slot: str = "a"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Restore:
    """Go on from an earlier snapshot of the same episode. Gives nothing."""

    run: int
    snapshot: Snapshot
    slot: str = "a"


@dataclasses.dataclass(frozen=True, kw_only=True)
class RenderState:
    """Draw a state as agents and films see it. Gives an `Image`.

    The picture covers `size` pixels around `centre` at `scale` pixels a metre. `state` is a
    snapshot's `state`, or None for the first state of `level`.
    """

    level: Level
    state: Any
    size: tuple[int, int]
    centre: tuple[float, float]
    scale: float
    physics: str = "balanced"
    palette: str = "kinetix"
    glyphs: bool = True
    patterns: bool = False


@dataclasses.dataclass(frozen=True, kw_only=True)
class RandomLevel:
    """Draw a random level. Gives a `Level`."""

    seed: int
    size: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mutate:
    """Change a level at random; None takes a random mutation. Gives a `Level`."""

    level: Level
    mutation: str | None
    seed: int


@dataclasses.dataclass(frozen=True, kw_only=True)
class CheckDynamics:
    """Play the no-op and random actions in a level (I301, I302). Gives a `DynamicsReport`."""

    level: Level
    physics: str = "balanced"
    attempts: int = 64


@dataclasses.dataclass(frozen=True, kw_only=True)
class ExportPicture:
    """Write a PNG of the arena. Gives the path."""

    level: Level
    state: Any
    """A snapshot's `state`, or None for the first state."""
    path: Path
    factor: int = 1
    """1 … 8 times 500 pixels."""
    transparent: bool = False
    palette: str = "kinetix"


@dataclasses.dataclass(frozen=True, kw_only=True)
class ExportFilm:
    """Write a GIF or MP4 (by the path's suffix) of a played episode. Gives the path."""

    level: Level
    trace: Trace
    path: Path
    pixels: int = 500
    stride: int = 1
    """Every how many environment steps a picture is taken."""
    palette: str = "kinetix"
    overlay: bool = False
    """Write step, controls, value and outcome on the pictures."""
    rival: Trace | None = None
    """The second player of a comparison, filmed beside the first one."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class AddEpisode:
    """Add an episode to a data set. Gives a sentence: what the data set holds then."""

    level: Level
    trace: Trace
    folder: Path
    """The data set; made where there is none."""


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


@dataclasses.dataclass(frozen=True, kw_only=True)
class Image:
    """A picture, rows from the top."""

    pixels: UInt8[np.ndarray, "h w 3"]
    centre: tuple[float, float]
    """Level point in the middle [m]."""
    scale: float
    """Pixels a metre."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class DynamicsReport:
    """Outcome of a level without a plan."""

    noop_outcome: Outcome
    """See `kinetix.environment.outcome.Outcome`."""
    noop_steps: int
    random_solved: float
    """Share of the attempts."""
    attempts: int


class Cancelled(Exception):
    """The job was cancelled."""


class Progress(Protocol):
    """Channel in which a running job reports, and learns that it was cancelled."""

    def report(self, fraction: float | None, message: str) -> None:
        """Say how far it is (0 … 1, or None when unknown) and what it does.

        Raises:
            Cancelled: The user cancelled the job.
        """
        ...

    def share(self, partial: Any) -> None:
        """Hand on what is known so far; the window may read it at any time."""
        ...


Perform: TypeAlias = Callable[[Request, Progress], Any]
"""Does a request on the worker's thread."""
