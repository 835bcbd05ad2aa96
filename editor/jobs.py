"""The background worker: one thread, the only one that ever imports JAX.

The interface's thread puts requests in and takes results out once a frame. Requests and results are
plain frozen values and numpy arrays; every job shows its progress and can be cancelled.
"""

import dataclasses
import enum
import heapq
import itertools
import threading
import traceback
from collections.abc import Callable, Sequence
from typing import Any

from editor.journal import Journal
from editor.recording import Action, Snapshot
from editor.requests import (
    Advance,
    Cancelled,
    Casting,
    Perform,
    Progress,
    Pull,
    Request,
    Restore,
    StartEpisode,
)
from kinetix.errors import KinetixError
from kinetix.level.model import Level


class JobState(enum.Enum):
    """Where a job is."""

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
        """What the status bar says: "Compiling the simulator"."""
        self.state = JobState.QUEUED
        self.fraction: float | None = None
        """How far it is, 0 … 1, or None when unknown."""
        self.message = ""
        """What it does at the moment."""
        self.partial: Any = None
        """What is known so far, where the job tells."""
        self.result: Any = None
        self.error = ""
        """One sentence, when it failed."""
        self._cancel = threading.Event()

    @property
    def finished(self) -> bool:
        """Whether nothing more will happen."""
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
        """Whether somebody asked it to stop."""
        return self._cancel.is_set()


def perform_in_simulation(request: Request, progress: Progress) -> Any:
    """Do a request in the simulation; imports JAX on the first call."""
    from editor import simulation

    return simulation.perform(request, progress)


@dataclasses.dataclass(order=True)
class _Waiting:
    rank: tuple[int, int]
    job: Job = dataclasses.field(compare=False)
    done: Callable[[Job], None] | None = dataclasses.field(compare=False)


class Worker:
    """A thread and its queue. Urgent jobs go before others; a running job is never interrupted."""

    def __init__(self, perform: Perform = perform_in_simulation) -> None:
        self._perform = perform
        self._queue: list[_Waiting] = []
        self._finished: list[_Waiting] = []
        self._condition = threading.Condition()
        self._running: Job | None = None
        self._numbers = itertools.count()
        self._thread: threading.Thread | None = None
        self._stopping = False
        self.log = Journal()
        """Tracebacks of jobs that failed unexpectedly, for the log panel."""

    @property
    def jobs(self) -> tuple[Job, ...]:
        """The running job, then the waiting ones."""
        with self._condition:
            running = () if self._running is None else (self._running,)
            return (*running, *(waiting.job for waiting in sorted(self._queue)))

    @property
    def idle(self) -> bool:
        """Whether no job is running, waiting or untaken."""
        with self._condition:
            return self._running is None and not self._queue and not self._finished

    def submit(
        self,
        request: Request,
        *,
        title: str,
        urgent: bool = False,
        done: Callable[[Job], None] | None = None,
    ) -> Job:
        """Queue a request; the thread starts with the first one.

        Args:
            request: What to do.
            title: What to call it on the screen.
            urgent: Goes before jobs that are not.
            done: Called by `poll` on the caller's thread when the job has finished in any way.

        Returns:
            The job.
        """
        job = Job(request, title)
        with self._condition:
            rank = (0 if urgent else 1, next(self._numbers))
            heapq.heappush(self._queue, _Waiting(rank=rank, job=job, done=done))
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="worker", daemon=True)
                self._thread.start()
            self._condition.notify()
        return job

    def poll(self) -> list[Job]:
        """Take the finished jobs and call what waits for them; call it once a frame."""
        with self._condition:
            finished, self._finished = self._finished, []
        for waiting in finished:
            if waiting.done is not None:
                waiting.done(waiting.job)
        return [waiting.job for waiting in finished]

    def wait(self, seconds: float) -> bool:
        """Block until a result can be taken or nothing is left to do; False after the time."""
        with self._condition:
            return self._condition.wait_for(
                lambda: bool(self._finished) or (self._running is None and not self._queue), seconds
            )

    def stop(self, seconds: float = 2.0) -> None:
        """Cancel everything and end the thread; wait so long for what is under way."""
        with self._condition:
            self._stopping = True
            for waiting in self._queue:
                waiting.job.cancel()
            if self._running is not None:
                self._running.cancel()
            self._condition.notify()
        if self._thread is not None:
            self._thread.join(seconds)

    def _work(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._queue or self._stopping)
                if self._stopping:
                    return
                waiting = heapq.heappop(self._queue)
                self._running = waiting.job
            self._run(waiting.job)
            with self._condition:
                self._running = None
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
        """Whether the snapshots to come carry contact points."""
        self.job: Job | None = None
        """The job that starts the episode, for its progress."""

    @property
    def outstanding(self) -> int:
        """Steps that were asked for and have not arrived."""
        return self._outstanding

    def start(self, level: Level, physics: str, casting: Casting | None = None) -> None:
        """Go to a level's first state; its snapshot arrives first."""
        self.stop()
        request = StartEpisode(
            run=self._run,
            level=level,
            physics=physics,
            keep_contacts=self.keep_contacts,
            casting=casting,
            slot=self._slot,
        )
        self.job = self._submit(request, "Preparing the simulation")

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
