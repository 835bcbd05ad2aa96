"""Audible events of an episode."""

import dataclasses

import numpy as np
import pytest

from editor.actions import run
from editor.play.cues import LOUDEST, Cue, Ears, hardest_blow
from tests.editor.core.helpers import FakeSimulator, a_level


def moments(velocities, **last):
    simulator = FakeSimulator()
    level = a_level()
    simulator.start(level, "balanced")
    first = simulator.state
    made = []
    for step, velocity in enumerate(velocities):
        rows = np.zeros((4, 2), np.float32)
        rows[2] = velocity
        made.append(dataclasses.replace(first, step=step, velocity=rows))
    made[-1] = dataclasses.replace(made[-1], **last)
    return level, made


def test_falling_is_no_hit_and_landing_is_one():
    level, (start, falling, landed) = moments([(0, 0), (0, -0.327), (0, 0)])
    level = level.replace(bodies=(level.bodies[2], *level.bodies[:2], level.bodies[3]))
    only = [dataclasses.replace(m, velocity=m.velocity[[2, 2, 2, 3]]) for m in (start, falling)]
    assert hardest_blow(level, *only) == pytest.approx(0.0, abs=1e-3)
    assert hardest_blow(level, falling, landed) > 0.3


def test_a_fixed_body_is_never_heard():
    level, (a, b) = moments([(0, 0), (0, 0)])
    rows = b.velocity.copy()
    rows[3] = 50.0  # body 4 is fixed
    assert hardest_blow(level, a, dataclasses.replace(b, velocity=rows)) < 1.0


def test_hits_and_the_end_are_heard_once(session, hand):
    run(session, "run.play_human")
    hand.wait()
    ears, playback = Ears(), session.playback
    level, (first, hit) = moments([(0, 0), (20, 0)], outcome="won")
    playback.current.snapshot, playback.current.level = first, level
    assert ears.hear(playback, 0.0) == []
    playback.current.snapshot = hit
    cues = ears.hear(playback, 0.1)
    assert cues == [Cue(name="hit", loudness=1.0), Cue(name="won")]
    assert LOUDEST < 20
    assert ears.hear(playback, 0.2) == []


def test_only_for_people_and_not_when_muted(session, hand):
    run(session, "run.play_human")
    session.playback.simulator.ends_at, session.playback.simulator.ends = 4, "won"
    for _ in range(20):
        hand.wait()
    assert session.playback.outcome == "won"
    assert session.sound.cues == []  # nobody sits there
    session.attended = True
    heard = []
    run(session, "run.reset")
    for _ in range(20):
        hand.wait()
        heard += session.sound.cues
    assert [cue.name for cue in heard].count("won") == 1
    assert run(session, "app.sound")
    assert not session.settings.sound
    run(session, "run.reset")
    for _ in range(20):
        hand.wait()
        assert session.sound.cues == []
