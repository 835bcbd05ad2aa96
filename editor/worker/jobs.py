"""The background worker: its threads are the only ones that ever import JAX.

The interface's thread puts requests in and takes results out once a frame. Requests and results are
plain frozen values and numpy arrays; every job shows its progress and can be cancelled. Requests of
different kinds go through different lanes, so that what is played never waits for anything else.
"""

import dataclasses
import enum
import heapq
import itertools
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from typing import Any, Final

from editor.base.journal import Journal
from editor.worker.bridge import perform_in_simulation
from editor.worker.priority import step_back
from editor.worker.requests import (
    Advance,
    Cancelled,
    Casting,
    CheckDynamics,
    Evaluate,
    ExportFilm,
    GetReady,
    KeepPrograms,
    Observe,
    Perform,
    Pull,
    Rehearse,
    RenderState,
    Request,
    Restore,
    StartEpisode,
    Tailor,
    WarmUp,
)
from editor.worker.snapshots import Action, Snapshot
from kinetix.errors import KinetixError
from kinetix.level.model import Level


class JobState(enum.Enum):
    """State of a job."""

    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


class Job:
    """One request on its way; reading its fields from the interface's thread is safe."""

    def __init__(self, request: Request, title: str) -> None:
        self.request = request
        self.title = title
        """Text in the status bar: "Compiling the simulator"."""
        self.since = time.monotonic()
        """Time at which it was asked for, on the clock of `time.monotonic` [s]."""
        self.state = JobState.QUEUED
        self.fraction: float | None = None
        """Progress, 0 … 1, or None when unknown."""
        self.message = ""
        """Present activity."""
        self.partial: Any = None
        """Partial result, where the job gives one."""
        self.result: Any = None
        self.error = ""
        """One sentence, when it failed."""
        self._cancel = threading.Event()

    @property
    def finished(self) -> bool:
        """True if nothing more will happen."""
        return self.state in (JobState.DONE, JobState.FAILED, JobState.CANCELLED)

    def cancel(self) -> None:
        """Ask the job to stop; it does at its next report."""
        self._cancel.set()

    def report(self, fraction: float | None, message: str) -> None:
        """Take note of how far the job is; called by the worker's thread.

        Raises:
            Cancelled: The user cancelled the job.
        """
        self.fraction, self.message = fraction, message
        if self._cancel.is_set():
            raise Cancelled

    def share(self, partial: Any) -> None:
        """Hand on what is known so far; called by the worker's thread."""
        self.partial = partial

    @property
    def cancelled(self) -> bool:
        """True if somebody asked it to stop."""
        return self._cancel.is_set()


PREPARATIONS: Final = "preparations"
"""The lane of what is compiled ahead."""
_LANES: Final[dict[type, str]] = {
    RenderState: "pictures",
    Observe: "views",
    ExportFilm: "films",
    **dict.fromkeys((Evaluate, CheckDynamics), "measurements"),
    **dict.fromkeys((GetReady, WarmUp, Tailor, Rehearse, KeepPrograms), PREPARATIONS),
}
"""Through which lane a request goes; what is not listed are chores, done one after the other."""
_NICENESS: Final = {"pictures": 5, "films": 10, "measurements": 10}
"""Lanes that leave the processor to the others."""


def lane_of(request: Request) -> str:
    """The lane of a request: requests of one lane wait for each other, those of two never do."""
    if isinstance(request, StartEpisode | Advance | Restore):
        return f"episode {request.slot}"
    return _LANES.get(type(request), "chores")


@dataclasses.dataclass(order=True)
class _Waiting:
    rank: tuple[int, int]
    job: Job = dataclasses.field(compare=False)
    done: Callable[[Job], None] | None = dataclasses.field(compare=False)


class _Lane:
    """A thread's queue."""

    def __init__(self) -> None:
        self.queue: list[_Waiting] = []
        self.running: Job | None = None
        self.thread: threading.Thread | None = None

    @property
    def idle(self) -> bool:
        return self.running is None and not self.queue


class Worker:
    """A thread with a queue for each lane. Urgent jobs go before others; none is interrupted."""

    def __init__(self, perform: Perform = perform_in_simulation) -> None:
        self._perform = perform
        self._lanes: dict[str, _Lane] = {}
        self._finished: list[_Waiting] = []
        self._untold: list[Exception] = []
        """Errors of callbacks that `poll` has still to raise."""
        self._condition = threading.Condition()
        self._numbers = itertools.count()
        self._stopping = False
        self.log = Journal()
        """Tracebacks of jobs that failed unexpectedly, for the log panel."""

    @property
    def jobs(self) -> tuple[Job, ...]:
        """The running jobs, then the waiting ones."""
        with self._condition:
            lanes = self._lanes.values()
            running = [lane.running for lane in lanes if lane.running is not None]
            waiting = sorted(waiting for lane in lanes for waiting in lane.queue)
            return (*running, *(each.job for each in waiting))

    @property
    def idle(self) -> bool:
        """True if no job is running, waiting or untaken, and no error of a callback is untold."""
        with self._condition:
            return self._resting and not self._finished and not self._untold

    @property
    def _resting(self) -> bool:
        return all(lane.idle for lane in self._lanes.values())

    def submit(
        self,
        request: Request,
        *,
        title: str,
        urgent: bool = False,
        done: Callable[[Job], None] | None = None,
    ) -> Job:
        """Queue a request; a lane's thread starts with its first one.

        Args:
            request: What to do.
            title: What to call it on the screen.
            urgent: Goes before jobs of its lane that are not.
            done: Called by `poll` on the caller's thread when the job has finished in any way.

        Returns:
            The job.
        """
        job = Job(request, title)
        with self._condition:
            name = lane_of(request)
            lane = self._lanes.setdefault(name, _Lane())
            rank = (0 if urgent else 1, next(self._numbers))
            heapq.heappush(lane.queue, _Waiting(rank=rank, job=job, done=done))
            if lane.thread is None:
                lane.thread = threading.Thread(
                    target=self._work, args=(lane, _NICENESS.get(name, 0)), name=name, daemon=True
                )
                lane.thread.start()
            self._condition.notify_all()
        return job

    def poll(self) -> list[Job]:
        """Take the finished jobs and call what waits for them; call it once a frame.

        Raises:
            Exception: One of them failed, and all were called. Of several errors the next calls
                raise the others.
        """
        with self._condition:
            finished, self._finished = self._finished, []
        for waiting in finished:
            if waiting.done is not None:
                try:
                    waiting.done(waiting.job)
                except Exception as error:  # the others must hear of theirs
                    self._untold.append(error)
        if self._untold:
            raise self._untold.pop(0)
        return [waiting.job for waiting in finished]

    def wait(self, seconds: float) -> bool:
        """Block until a result can be taken or nothing is left to do; False after the time."""
        with self._condition:
            return self._condition.wait_for(lambda: bool(self._finished) or self._resting, seconds)

    def stop(self, seconds: float = 2.0) -> None:
        """Cancel everything and end the threads; wait so long for what is under way."""
        with self._condition:
            self._stopping = True
            for lane in self._lanes.values():
                for waiting in lane.queue:
                    waiting.job.cancel()
                if lane.running is not None:
                    lane.running.cancel()
            self._condition.notify_all()
            threads = [lane.thread for lane in self._lanes.values() if lane.thread is not None]
        until = time.monotonic() + seconds
        for thread in threads:
            thread.join(max(until - time.monotonic(), 0.0))

    def _work(self, lane: _Lane, niceness: int) -> None:
        if niceness:
            step_back(niceness)
        while True:
            with self._condition:
                self._condition.wait_for(lambda: lane.queue or self._stopping)
                if self._stopping:
                    return
                waiting = heapq.heappop(lane.queue)
                lane.running = waiting.job
            self._run(waiting.job)
            with self._condition:
                lane.running = None
                self._finished.append(waiting)
                self._condition.notify_all()

    def _run(self, job: Job) -> None:
        if job.cancelled:
            job.state = JobState.CANCELLED
            return
        job.state = JobState.RUNNING
        try:
            job.result = self._perform(job.request, job)
            job.state = JobState.DONE
        except Cancelled:
            job.state = JobState.CANCELLED
        except KinetixError as error:
            job.error, job.state = str(error), JobState.FAILED
        except Exception as error:  # the worker must outlive any job
            self.log.add(traceback.format_exc())
            first = str(error).partition("\n")[0]  # a compiler's message goes on for pages
            job.error, job.state = f"{type(error).__name__}: {first}", JobState.FAILED


class WorkerSimulator:
    """The simulator that playback talks to: asks the worker, hands on what arrives."""

    def __init__(self, worker: Worker, slot: str = "a") -> None:
        self._worker = worker
        self._slot = slot
        self._run = 0
        self._pending: set[Job] = set()
        self._dropped: set[Job] = set()
        self._outstanding = 0
        self._arrived: list[Snapshot] = []
        self._error = ""
        self.keep_contacts = False
        """True if the snapshots to come carry contact points."""
        self.quick = False
        """True if an episode may begin in a step that was compiled quickly, where no better one is
        ready. What is recorded as a script plays the same again only without."""
        self.job: Job | None = None
        """The job that starts the episode, for its progress."""

    @property
    def outstanding(self) -> int:
        """Steps that were asked for and have not arrived."""
        return self._outstanding

    def start(
        self,
        level: Level,
        physics: str,
        casting: Casting | None = None,
        since: Snapshot | None = None,
    ) -> None:
        """Go to a level's first state, or on from where it was changed; its snapshot arrives."""
        self.stop()
        request = StartEpisode(
            run=self._run,
            level=level,
            physics=physics,
            keep_contacts=self.keep_contacts,
            casting=casting,
            slot=self._slot,
            quick=self.quick,
            since=since,
        )
        self.job = self._submit(request, "Preparing Play")

    def advance(self, actions: tuple[Action | None, ...], pull: Pull | None = None) -> None:
        """Play one environment step for each action."""
        self._outstanding += len(actions)
        request = Advance(
            run=self._run,
            actions=actions,
            pull=pull,
            keep_contacts=self.keep_contacts,
            slot=self._slot,
        )
        self._submit(request, "Simulating")

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from an earlier snapshot of this episode."""
        self._submit(Restore(run=self._run, snapshot=snapshot, slot=self._slot), "Stepping back")

    def _submit(self, request: Request, title: str) -> Job:
        job = self._worker.submit(request, title=title, urgent=True, done=self._done)
        self._pending.add(job)
        return job

    def stop(self) -> None:
        """Drop everything that was asked for."""
        self.drop()
        self._run += 1
        self._error = ""

    def drop(self) -> None:
        """Drop the steps that were asked for; the episode stays."""
        for job in self._pending:
            job.cancel()
        self._dropped |= self._pending
        self._pending.clear()
        self._outstanding = 0
        self._arrived = []

    def take(self) -> Sequence[Snapshot]:
        """Snapshots that arrived since the last call.

        Raises:
            KinetixError: The simulation failed.
        """
        if self._error:
            error, self._error = self._error, ""
            raise KinetixError(error)
        arrived, self._arrived = self._arrived, []
        return arrived

    def _done(self, job: Job) -> None:
        request = job.request
        self._pending.discard(job)
        if job in self._dropped:
            self._dropped.discard(job)
            return
        if not isinstance(request, StartEpisode | Advance | Restore) or request.run != self._run:
            return
        if isinstance(request, Advance):
            self._outstanding -= len(request.actions)
        if job.state is JobState.FAILED:
            starting = isinstance(request, StartEpisode)
            self._error = f"Play cannot start: {job.error}" if starting else job.error
        elif job.state is JobState.DONE and isinstance(request, StartEpisode):
            self._arrived.append(job.result)
        elif job.state is JobState.DONE and isinstance(request, Advance):
            self._arrived.extend(job.result)
