"""Runs another engine's program with its own Python and reads what it wrote."""

import dataclasses
import json
import os
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from kinetix.errors import KinetixError
from kinetix.paths import cache_dir

_CHECKOUT: Final = Path(__file__).resolve().parents[3]
ENVIRONMENTS: Final = _CHECKOUT / ".bench-envs"
"""Each peer's virtual environment, by the name of its `Peer.environment`."""
PROGRAMS: Final = _CHECKOUT / "scripts" / "peers"
"""The programs that the peers' Pythons run."""


class PeerLateError(KinetixError):
    """A peer gave no answer in time."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Peer:
    """An engine with its settings."""

    name: str
    """As it is printed."""
    family: str
    """The engine without its settings."""
    environment: str
    """Folder below `ENVIRONMENTS`."""
    program: str
    """File below `PROGRAMS`."""
    settings: Mapping[str, Any]
    """Settings that its program receives."""
    compiled: bool = False
    """True if it steps whole batches in one compiled program, or one world at a call."""
    own_inertia: bool = False
    """Moments of inertia by kinetix-env's rule instead of the true ones."""

    @property
    def python(self) -> Path:
        """Its interpreter."""
        return ENVIRONMENTS / self.environment / "bin" / "python"

    @property
    def installed(self) -> bool:
        """True if `make bench-peers` has installed it."""
        return os.path.exists(self.python)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Answer:
    """Answer of another engine's program to a job."""

    told: Mapping[str, Any]
    """The contents of answer.json."""
    motions: Mapping[str, np.ndarray]
    """Arrays (step, body, 6) by the scene's key; empty where none were asked for."""


def ask(
    peer: Peer,
    job: Mapping[str, Any],
    *,
    variables: Mapping[str, str] | None = None,
    seconds: float | None = None,
) -> Answer:
    """Let a peer do a job.

    Args:
        peer: Which.
        job: See scripts/peers/protocol.py; the engine's settings are added.
        variables: Of the process's environment, beyond this process's own.
        seconds: How long it may take; without end where none are given.

    Raises:
        PeerLateError: The job took longer than `seconds`.
        KinetixError: The engine is not installed, or its program failed.
    """
    if not peer.installed:
        raise KinetixError(f"{peer.name} is not installed: run `make bench-peers`")
    with tempfile.TemporaryDirectory(prefix="kinetix-peer-") as name:
        folder = Path(name)
        file = folder / "job.json"
        file.write_text(json.dumps({**job, "settings": peer.settings}))
        # Its program must find its own packages, of which one is called as ours is, and runs
        # as its users have it: our options of the compiler are not theirs. Timings of steps hand
        # them over for all that (`host_devices`), so that engines differ in nothing else.
        ours = ("PYTHONPATH", "XLA_FLAGS")
        own = {key: value for key, value in os.environ.items() if key not in ours}
        own |= {"JAX_PLATFORMS": "cpu", "KINETIX_PEER_CACHE": str(cache_dir() / "peers")}
        try:
            done = subprocess.run(
                [peer.python, PROGRAMS / peer.program, file, folder],
                cwd=folder,
                env=own | dict(variables or {}),
                capture_output=True,
                text=True,
                check=False,
                timeout=seconds,
            )
        except subprocess.TimeoutExpired as late:
            raise PeerLateError(f"{peer.name}: no answer within {seconds:g} s") from late
        if done.returncode:
            lines = done.stderr.strip().splitlines() or ["no message"]
            # JAX puts advice after the message.
            last = next((line for line in reversed(lines) if "Error:" in line), lines[-1])
            raise KinetixError(f"{peer.name}: its program ended with {done.returncode}: {last}")
        told = json.loads((folder / "answer.json").read_text())
        motions = folder / "motions.npz"
        return Answer(told=told, motions=_arrays(motions) if os.path.exists(motions) else {})


def _arrays(file: Path) -> dict[str, np.ndarray]:
    with np.load(file) as stored:
        return {key: stored[key] for key in stored.files}
