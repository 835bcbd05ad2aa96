"""The worker: order, progress, cancelling, failures; and the simulator that talks to it."""

import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from editor.play.mode import Mode
from editor.play.playback import Playback
from editor.worker.jobs import JobState, Worker, WorkerSimulator
from editor.worker.requests import Advance, Cancelled, RandomLevel, Restore, StartEpisode
from editor.worker.snapshots import Snapshot
from kinetix.errors import KinetixError
from tests.editor.core.helpers import a_level


def settle(worker, seconds=10.0):
    """Take results until nothing is left."""
    end = time.monotonic() + seconds
    while not worker.idle:
        assert time.monotonic() < end, "the worker does not come to rest"
        worker.wait(0.1)
        worker.poll()


def asked(seed):
    return RandomLevel(seed=seed, size="s")


def test_results_come_back_on_the_callers_thread():
    worker, threads = Worker(lambda request, progress: threading.current_thread().name), []
    job = worker.submit(
        asked(1), title="x", done=lambda job: threads.append(threading.current_thread().name)
    )
    settle(worker)
    assert (job.state, job.result) == (JobState.DONE, "chores")
    assert threads == [threading.current_thread().name]
    worker.stop()


def test_urgent_jobs_go_first():
    gate, order = threading.Event(), []

    def perform(request, progress):
        gate.wait(5)
        order.append(request.seed)

    worker = Worker(perform)
    worker.submit(asked(0), title="x")
    while not any(job.state is JobState.RUNNING for job in worker.jobs):
        time.sleep(0.001)
    worker.submit(asked(1), title="x")
    worker.submit(asked(2), title="x", urgent=True)
    worker.submit(asked(3), title="x", urgent=True)
    gate.set()
    settle(worker)
    assert order == [0, 2, 3, 1]
    worker.stop()


def test_a_job_tells_its_progress_and_can_be_cancelled():
    started = threading.Event()

    def perform(request, progress):
        for k in range(10_000):
            progress.report(k / 10_000, f"part {k}")
            started.set()
            time.sleep(0.001)

    worker = Worker(perform)
    job = worker.submit(asked(1), title="Long")
    started.wait(5)
    assert job.message.startswith("part")
    job.cancel()
    start = time.monotonic()
    settle(worker)
    assert job.state is JobState.CANCELLED
    assert time.monotonic() - start < 5.0  # all of it would take ten seconds
    worker.stop()


def test_a_job_cancelled_while_it_waits_never_runs():
    gate, ran = threading.Event(), []

    def perform(request, progress):
        gate.wait(5)
        ran.append(request.seed)

    worker = Worker(perform)
    worker.submit(asked(0), title="x")
    job = worker.submit(asked(1), title="x")
    job.cancel()
    gate.set()
    settle(worker)
    assert ran == [0]
    assert job.state is JobState.CANCELLED
    worker.stop()


def test_failures_keep_the_worker_alive():
    def perform(request, progress):
        if request.seed == 0:
            raise KinetixError("It does not fit.")
        if request.seed == 1:
            raise ValueError("surprise")
        if request.seed == 2:
            raise Cancelled
        return "fine"

    worker = Worker(perform)
    jobs = [worker.submit(asked(k), title="x") for k in range(4)]
    settle(worker)
    assert [job.error for job in jobs] == ["It does not fit.", "ValueError: surprise", "", ""]
    assert jobs[3].result == "fine"
    (logged,) = worker.log.lines
    assert "surprise" in logged
    worker.stop()


def test_a_callback_that_fails_keeps_no_other_from_its_answer():
    def bad(job):
        raise KinetixError(f"no use for {job.request.seed}")

    worker, heard = Worker(lambda request, progress: request.seed), []
    for seed, done in enumerate((bad, bad, lambda job: heard.append(job.result))):
        worker.submit(asked(seed), title="x", done=done)
    while worker.jobs:
        time.sleep(0.001)
    with pytest.raises(KinetixError, match="no use for 0"):
        worker.poll()
    assert heard == [2] and not worker.idle
    with pytest.raises(KinetixError, match="no use for 1"):
        worker.poll()
    assert worker.poll() == [] and worker.idle
    worker.stop()


def moment(step):
    return Snapshot(
        step=step,
        position=np.zeros((4, 2), np.float32),
        angle=np.zeros(4, np.float32),
        velocity=np.zeros((4, 2), np.float32),
        angular_velocity=np.zeros(4, np.float32),
        motor=np.zeros(1, np.float32),
        thruster=np.zeros(1, np.float32),
    )


class Counting:
    """Counts steps instead of simulating."""

    def __init__(self):
        self.step = 0
        self.broken = False

    def __call__(self, request, progress):
        if self.broken:
            raise KinetixError("The physics broke down.")
        match request:
            case StartEpisode():
                self.step = 0
                return moment(0)
            case Advance():
                start = self.step
                self.step += len(request.actions)
                return tuple(moment(k) for k in range(start + 1, self.step + 1))
            case Restore():
                self.step = request.snapshot.step
                return None


@pytest.fixture
def played():
    counting = Counting()
    worker = Worker(counting)
    playback = Playback(WorkerSimulator(worker))
    yield playback, worker, counting
    worker.stop()


def frame(playback, worker, seconds=1 / 60):
    worker.poll()
    playback.tick(seconds)
    worker.wait(0.05)


def test_playing_over_the_worker(played):
    playback, worker, _ = played
    playback.play(a_level())
    assert playback.waiting
    for _ in range(130):
        frame(playback, worker)
    assert not playback.waiting
    assert 50 <= playback.step_count <= 65
    steps = [snapshot.step for snapshot in playback.ring.snapshots]
    assert steps == list(range(len(steps)))


def test_answers_to_an_earlier_episode_are_dropped(played):
    playback, worker, _ = played
    playback.play(a_level())
    for _ in range(30):
        frame(playback, worker)
    playback.reset()
    for _ in range(3):
        frame(playback, worker)
    steps = [snapshot.step for snapshot in playback.ring.snapshots]
    assert steps == list(range(len(steps)))
    assert playback.step_count < 10


def test_stepping_back_over_the_worker(played):
    playback, worker, counting = played
    playback.play(a_level())
    for _ in range(40):
        frame(playback, worker)
    playback.pause()
    settle(worker)
    playback.tick(0.0)
    steps = playback.step_count
    playback.step_back()
    settle(worker)
    assert playback.step_count == counting.step == steps - 1
    playback.step()
    settle(worker)
    playback.tick(0.0)
    assert playback.step_count == steps


def test_a_failing_simulation_pauses(played):
    playback, worker, counting = played
    playback.play(a_level())
    for _ in range(10):
        frame(playback, worker)
    counting.broken = True
    with pytest.raises(KinetixError, match="broke down"):
        for _ in range(20):
            frame(playback, worker)
    assert playback.mode is Mode.PAUSED


def test_the_simulation_starts_on_all_cores(monkeypatch):
    """A process of its own: here JAX has started."""
    monkeypatch.setenv("KINETIX_CORES", "3")
    monkeypatch.delenv("JAX_NUM_CPU_DEVICES", raising=False)
    code = (
        "from editor.worker.bridge import perform_in_simulation\n"
        "from editor.worker.jobs import Job\n"
        "from editor.worker.requests import RandomLevel\n"
        "request = RandomLevel(seed=0, size='s')\n"
        "try:\n"
        "    perform_in_simulation(request, Job(request, ''))\n"
        "finally:\n"
        "    import jax\n"
        "    print(jax.device_count())\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stdout.split() == ["3"], run.stderr
