"""Outcome of a level without a plan: with no action, and with random ones."""

from typing import Final

from editor.documents.document import same_simulation
from editor.worker.jobs import Job, JobState, Worker
from editor.worker.requests import CheckDynamics, DynamicsReport
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of, size_name
from kinetix.level.validate import Issue

_ENDS: Final = {"won": "wins", "lost": "loses", "broken": "breaks the physics"}


class Trial:
    """The last level that was tried out; its findings hold for that level alone."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self._level: Level | None = None
        self._report: DynamicsReport | None = None
        self.job: Job | None = None
        self.error = ""
        """Reason why it could not be played; empty while all is well."""

    @property
    def running(self) -> bool:
        """True if it is under way."""
        return self.job is not None and not self.job.finished

    def start(self, level: Level, physics: str) -> None:
        """Begin in the background; one that is under way is given up."""
        self.cancel()
        self._level, self._report, self.error = level, None, ""
        request = CheckDynamics(level=level, physics=physics)
        self.job = self._worker.submit(request, title="Trying the level out", done=self._done)

    def cancel(self) -> None:
        """Stop at the next opportunity."""
        if self.running and self.job is not None:
            self.job.cancel()
            self.job = None

    def _done(self, job: Job) -> None:
        if job is not self.job:
            return
        if job.state is JobState.DONE:
            self._report = job.result
        elif job.state is JobState.FAILED:
            self.error = job.error

    def findings(self, level: Level) -> tuple[Issue, ...]:
        """I301 and I302 of a level; nothing where another one was tried out."""
        report = self._report
        if report is None or self._level is None or not same_simulation(self._level, level):
            return ()
        end = _ENDS.get(report.noop_outcome, "neither wins nor loses")
        chance = f"A random agent solves {report.random_solved:.0%} of {report.attempts}."
        return (
            _info("I301", f"A no-op agent {end} in {report.noop_steps} steps."),
            _info("I302", chance),
        )


def fitting(level: Level, agents: tuple[str, ...]) -> Issue:
    """I303: which size the level fits, and which agents can play it.

    Args:
        level: The level.
        agents: Names of the agents that are known to be able to.
    """
    capacity = capacity_of(level)
    name = size_name(capacity)
    sizes = (capacity.polygons, capacity.circles, capacity.joints, capacity.thrusters)
    fits = f"size {name}" if name else f"no named size, but {','.join(map(str, sizes))}"
    who = ", ".join(agents) or "none is known"
    return _info("I303", f"The level fits {fits}; compatible agents: {who}.")


def _info(code: str, message: str) -> Issue:
    return Issue(code=code, severity="info", path="$", message=message)
