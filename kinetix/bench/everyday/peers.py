"""Everyday scenes in other engines, each beside itself with finer steps."""

import dataclasses
from collections.abc import Sequence

from kinetix.bench.everyday.judge import Recorded
from kinetix.bench.everyday.ours import FINE
from kinetix.bench.motion import Motion
from kinetix.bench.peers.exchange import motion_of, scene_of
from kinetix.bench.peers.launch import Peer, ask
from kinetix.scenes.everyday.model import EverydayScene
from kinetix.scenes.model import Trial


def record_peer(scenes: Sequence[EverydayScene], peer: Peer) -> list[Recorded]:
    """Run the scenes that another engine has words for.

    Raises:
        KinetixError: The engine is not installed or its program failed.
    """
    trials = {str(k): scene.trial for k, scene in enumerate(scenes)}
    twins = {
        f"twin {k}": dataclasses.replace(scene.trial, level=scene.twin)
        for k, scene in enumerate(scenes)
        if scene.twin is not None
    }
    motions = _run(trials | twins, peer)
    compared = {str(k): scene.trial for k, scene in enumerate(scenes) if scene.compared}
    fine = [
        _run(compared, dataclasses.replace(peer, settings={**peer.settings, "substeps": parts}))
        for parts in FINE
    ]
    return [
        Recorded(
            scene=scene,
            motion=motions[str(k)],
            twin=motions.get(f"twin {k}"),
            fine=(fine[0][str(k)], fine[1][str(k)]) if str(k) in fine[0] else None,
        )
        for k, scene in enumerate(scenes)
        if str(k) in motions
    ]


def _run(trials: dict[str, Trial], peer: Peer) -> dict[str, Motion]:
    if not trials:
        return {}
    sets = {name: [scene_of(trial)] for name, trial in trials.items()}
    answer = ask(peer, {"task": "record", "sets": sets})
    return {
        name: motion_of(trial, answer.motions[f"{name}/0"])
        for name, trial in trials.items()
        if f"{name}/0" in answer.motions
    }
