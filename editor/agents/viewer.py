"""Settings of the agent viewer: two agents, their seeds, the comparison, the evaluation."""

import dataclasses
from typing import Final, Literal, TypeAlias

from editor.agents.attempt_paths import Ways
from editor.agents.curriculum import CurriculumWatch
from editor.agents.evaluation import Evaluation, bare_summary
from editor.agents.evaluation_form import EvaluationForm
from editor.agents.reasons import Reasons
from editor.agents.run_watch import RunWatch
from editor.gallery.filing import MovedFile
from editor.play.second_player import Follower
from editor.play.simulator import Simulator
from editor.worker.jobs import Job, Worker
from editor.worker.requests import AgentSummary, AgentView, Casting
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of, needed_capacity
from kinetix.wording import plural

SlotName: TypeAlias = Literal["a", "b"]
SLOTS: Final[tuple[SlotName, ...]] = ("a", "b")
Compare: TypeAlias = Literal["off", "ghost", "side"]
COMPARE_LABELS: Final[dict[Compare, str]] = {
    "off": "Off",
    "ghost": "Ghost",
    "side": "Side by side",
}


@dataclasses.dataclass(kw_only=True)
class AgentSlot:
    """A place for an agent."""

    path: str = ""
    """Path or name that was asked for; empty: none."""
    summary: AgentSummary | None = None
    error: str = ""
    """Reason why it could not be loaded; one sentence."""
    loading: bool = False
    job: Job | None = None
    """Job that loads it, or has loaded it."""
    passed_over: AgentSummary | None = None
    """The agent in whose place the planner plays: it comes back where it can play."""


@dataclasses.dataclass(kw_only=True)
class Guest:
    """An attempt that was opened from an evaluation: who plays it, and with which draws."""

    summary: AgentSummary | None
    """Its agent; None: it is agent A."""
    seed: int
    attempt: int
    deterministic: bool


class Viewer:
    """The agent viewer's state; panels and actions change it freely."""

    def __init__(self, worker: Worker, evaluator: Worker, rival: Simulator) -> None:
        self.slots: dict[SlotName, AgentSlot] = {name: AgentSlot() for name in SLOTS}
        self._ways: Ways | None = None
        self.ways_pending = False
        self.contenders: tuple[AgentSummary, ...] = ()
        """Agents that are evaluated besides those of the slots."""
        self.deleted: list[MovedFile] = []
        """Agents that were trained here and are in the trash now, the last one last."""
        self.guest: Guest | None = None
        """The attempt of an evaluation that is on show; None: none is."""
        self.seed = 0
        self.attempt = 0
        self.deterministic = False
        self.by_hand = False
        """True if a person has taken over until they hand back."""
        self.compare: Compare = "off"
        self.other_physics = ""
        """Preset or solver under which the same is played beside; empty: nothing is."""
        self.rival = Follower(rival)
        self.evaluation = Evaluation(evaluator)
        self.form = EvaluationForm()
        self.run = RunWatch(worker)
        self.curriculum = CurriculumWatch(worker)
        self.reasons = Reasons(worker)
        self.asked_body: int | None = None
        """Id of the body that was pulled at last, whose path is explained."""
        self.other_runs: tuple[RunWatch, ...] = ()
        """Runs whose curves are shown beside those of `run`; their agents are not taken."""
        self.follow_run = True
        """True if the newest checkpoint of the watched run is played as soon as it is there."""
        self.eye_open = False
        """True if the panel with the agent's view is on the screen."""
        self.timeline_open = False
        """True if the timeline is on the screen: then contacts are noted for its marks."""
        self.eye: AgentView | None = None
        self.eye_of: object = None
        """The moment that `eye` shows."""
        self.eye_agent: AgentSummary | None = None
        self.eye_pending = False
        self.eye_error = ""
        self.eye_stamp = 0
        self.compared_episode = -1
        """The episode that the rival belongs to."""

    def casting(self, slot: SlotName) -> Casting | None:
        """Return the agent of a slot with its random numbers; None for an empty slot."""
        summary = self.slots[slot].summary
        return None if summary is None else self.cast(summary)

    def cast(self, summary: AgentSummary) -> Casting:
        """Return an agent with the draws that hold now."""
        draws = self.draws
        return Casting(
            agent=summary.ref,
            seed=draws.seed,
            attempt=draws.attempt,
            deterministic=draws.deterministic,
            digest=summary.digest,
        )

    @property
    def draws(self) -> "Viewer | Guest":
        """Source of seed, attempt and choice of actions: the guest, or the viewer itself."""
        return self.guest or self

    @property
    def ways(self) -> Ways | None:
        """Ways of attempts of the evaluation, drawn over their level; None: none are."""
        ways = self._ways
        return ways if ways is not None and ways.plan is self.evaluation.plan else None

    @ways.setter
    def ways(self, ways: Ways | None) -> None:
        self._ways = ways

    def ways_of(self, level: int, agent: int) -> Ways | None:
        """Return the ways on show if they are an agent's on a level, by the plan's indexes."""
        ways = self.ways
        return ways if ways is not None and (ways.level, ways.agent) == (level, agent) else None

    @property
    def arrangement(self) -> Compare:
        """Arrangement of the second episode: another physics always stands beside."""
        return "side" if self.other_physics else self.compare

    @property
    def agents(self) -> tuple[AgentSummary, ...]:
        """The agents that are loaded, each once."""
        found = [slot.summary for slot in self.slots.values() if slot.summary is not None]
        return tuple(dict.fromkeys(found))

    @property
    def measured(self) -> tuple[AgentSummary, ...]:
        """The agents that an evaluation measures: those loaded, the contenders, the scripted."""
        scripted = self.form.scripted
        loaded = tuple(agent for agent in self.agents if agent.ref.path not in scripted)
        others = tuple(agent for agent in self.contenders if agent not in loaded)
        return (*loaded, *others, *map(bare_summary, scripted))


def mismatch(summary: AgentSummary, level: Level) -> str:
    """Return why an agent cannot play a level, or a warning; empty when all is well."""
    needs = needed_capacity(level) if summary.any_size else capacity_of(level)
    sizes = dataclasses.astuple(needs)
    trained = summary.capacity
    if trained is None:
        return ""
    larger = [
        f"{plural(have, *names)} (it knows {most})"
        for have, most, names in zip(sizes, trained, _KINDS, strict=True)
        if have > most
    ]
    if not larger:
        return ""
    has = "has" if dataclasses.astuple(needed_capacity(level)) == sizes else "is of a size with"
    needed = f"this level {has} {' and '.join(larger)}"
    if summary.any_size:
        return f"It can play, but {needed}."
    return f"It cannot play this level: it sees one size only, and {needed}."


_KINDS: Final = (
    ("polygon with the arena", "polygons with the arena"),
    ("circle", "circles"),
    ("joint", "joints"),
    ("thruster", "thrusters"),
)
