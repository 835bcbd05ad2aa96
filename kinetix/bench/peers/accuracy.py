"""The accuracy suite for a peer: its motions, our judges."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, Final

from kinetix.bench.accuracy import row_of
from kinetix.bench.judges import JUDGES, Metric
from kinetix.bench.peers.exchange import motion_of, scene_of
from kinetix.bench.peers.launch import Answer, Peer, ask
from kinetix.scenes import SuiteScene, scenes_named

UNSAID: Final = "cannot be said"
"""Metric of a scene that an engine has no words for."""
COMPARED: Final = ("I7", "R1", "R2")
"""Scenes whose trials are judged together: all or none."""


def measure_peer(peer: Peer, scenes: str = "core") -> Iterator[dict[str, Any]]:
    """One row a scene, as our own engine's (`kinetix.bench.accuracy.row_of`).

    Scenes that the engine has no words for, and those of our own generator's levels, have no value
    and no verdict.

    Args:
        peer: Which engine.
        scenes: `core`, `all`, or ids with commas between them.

    Raises:
        KinetixError: A scene is unknown, the engine is not installed or its program failed.
    """
    inertia = "kinetix" if peer.own_inertia else "exact"
    # One class at a time: the progress is visible, and a failure loses little.
    for _, chosen in itertools.groupby(scenes_named(scenes), key=lambda scene: scene.group):
        group = list(chosen)
        sets = {
            scene.id: [scene_of(trial, inertia=inertia) for trial in scene.make_trials()]
            for scene in group
            if scene.id in JUDGES
        }
        answer = ask(peer, {"task": "record", "sets": sets})
        for scene in group:
            yield row_of(scene, peer.name, judged(scene, answer))


def judged(scene: SuiteScene, answer: Answer) -> Sequence[Metric]:
    """Return the metrics of a scene from the engine's answer.

    A scene of which the engine has no words for some trials is judged by the others, unless its
    judge compares trials with each other.
    """
    if scene.id not in JUDGES:
        return [Metric(name="not run on other engines", unit="1", value=None)]
    trials = scene.make_trials()
    said = [k for k in range(len(trials)) if f"{scene.id}/{k}" in answer.motions]
    if not said or (scene.id in COMPARED and len(said) < len(trials)):
        return [Metric(name=UNSAID, unit="1", value=None)]
    motions = [motion_of(trials[k], answer.motions[f"{scene.id}/{k}"]) for k in said]
    found = JUDGES[scene.id](motions)
    if len(said) < len(trials):
        share = 1 - len(said) / len(trials)
        found.append(Metric(name="share of runs that cannot be said", unit="1", value=share))
    return found
