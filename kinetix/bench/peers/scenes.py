"""Speed of a peer in the suite's scenes, as `kinetix.bench.scene_speed` times ours."""

from collections.abc import Iterator
from typing import Any, Final

from kinetix.bench.peers.exchange import scene_of
from kinetix.bench.peers.launch import Peer, PeerLateError, ask
from kinetix.bench.processes import host_devices
from kinetix.bench.scene_speed import Rate, measure_scenes
from kinetix.scenes import Trial

PATIENCE: Final = 300.0
"""Longest time that an engine may take to compile and be timed in a scene [s]: under some versions
of JAX, MJX hangs."""
SCENE_STEPS: Final = 256
"""Steps from the start over which engines driven from Python are timed."""


def measure_peer_scenes(
    peer: Peer, batches: tuple[int, ...], cores: int
) -> Iterator[dict[str, Any]]:
    """Rows as `measure_scenes` gives them; engines driven from Python have one world only.

    Args:
        peer: The engine.
        batches: Numbers of worlds.
        cores: Processor cores that many worlds are spread over.

    Raises:
        KinetixError: The engine is not installed or its program failed.
    """
    if not peer.compiled:
        return measure_scenes([1], lambda trial, _: _driven(peer, trial))
    return measure_scenes(batches, lambda trial, batch: _compiled(peer, trial, batch, cores))


def _compiled(peer: Peer, trial: Trial, batch: int, cores: int) -> Rate | None:
    inertia = "kinetix" if peer.own_inertia else "exact"
    job = {"task": "time", "batch": batch, "scenes": [scene_of(trial, inertia=inertia)]}
    variables = host_devices(cores if batch > 1 else 1)
    try:
        told = ask(peer, job, variables=variables, seconds=PATIENCE).told
    except PeerLateError:
        return None
    if told.get("unsaid"):
        return None
    return Rate(
        steps_per_s=1 / told["seconds_per_step"],
        compile_s=None,
        devices=told["devices"],
    )


def _driven(peer: Peer, trial: Trial) -> Rate | None:
    job = {"task": "time", "steps": SCENE_STEPS, "scenes": [scene_of(trial)]}
    seconds = ask(peer, job).told["seconds_per_step"]
    if "0" not in seconds:
        return None
    return Rate(steps_per_s=1 / seconds["0"], compile_s=None, devices=1)
