"""Agents that play."""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

from editor.actions.files import file
from editor.actions.watching import agents
from editor.base.events import FRAME
from editor.base.settings import Settings
from editor.gallery.results import Results
from editor.hosts import gl
from editor.hosts.bench.rows import Row, until
from editor.hosts.offscreen import OffscreenHost
from editor.play.mode import Mode
from editor.session import Session
from editor.worker.jobs import Worker

_AGENT: Final = """
import sys
import jax
from kinetix.agents.agent import Agent, save_agent
from kinetix.agents.card import AgentCard
from kinetix.agents.from_card import init_parameters
card = AgentCard(name="as large as the published ones")
save_agent(Agent(card, init_parameters(card, jax.random.key(0))), sys.argv[1])
"""
"""Makes an agent of 0.8 million parameters; in a process of its own, as this one has no JAX."""


def watching_rows() -> list[Row]:
    """An agent of 0.8 million parameters plays a level of size l."""
    session = Session(settings=Settings(), worker=Worker(), results=Results(stored=False))
    host = OffscreenHost(session, size=(1280, 800))
    file.open_path(session, "l/rover_ridge")
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "agent")
        subprocess.run([sys.executable, "-c", _AGENT, path], check=True)
        agents.load_agent(session, path)
        until(host, lambda: session.viewer.slots["a"].summary is not None and session.worker.idle)
    session.queue("run.play_agent")
    until(host, lambda: session.playback.step_count > 0)
    walls, steps, factors = [], [], []
    before = time.perf_counter() - FRAME
    for _ in range(300):
        start = time.perf_counter()
        host.step((), start - before)
        gl.finish()
        before = start
        walls.append(1000 * (time.perf_counter() - start))
        snapshot = session.playback.snapshot
        if snapshot is not None:
            steps.append(snapshot.milliseconds)
        if session.playback.real_time_factor > 0:  # an episode that has just begun has none
            factors.append(session.playback.real_time_factor)
        if session.mode is Mode.ENDED:
            session.queue("run.reset")
        time.sleep(max(FRAME - (time.perf_counter() - start), 0))
    factor = statistics.median(factors) if factors else 0.0
    session.worker.stop()
    host.close()
    p99 = sorted(walls)[int(0.99 * len(walls))]
    return [
        Row(
            code="PE8",
            metric="agent of 0.8 M parameters plays l: frame, median / p99",
            value=f"{statistics.median(walls):.1f} / {p99:.1f} ms",
            target="16.7 ms",
        ),
        Row(
            code="PE8",
            metric="agent of 0.8 M parameters plays l: step, real time",
            value=f"{statistics.median(steps):.1f} ms, {factor:.2f}×",
            target="1.00×",
        ),
    ]
