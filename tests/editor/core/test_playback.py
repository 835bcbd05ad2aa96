"""The state machine of play, with a fake simulator and a fake clock."""

import hashlib

import pytest

from editor.play.mode import Mode
from editor.play.playback import SPEEDS, Playback
from editor.worker.snapshots import FRAME_SKIP, RING_STATES
from kinetix.errors import KinetixError
from tests.editor.core.helpers import FakeSimulator, a_level


@pytest.fixture
def playback():
    return Playback(FakeSimulator())


def state_hash(playback):
    return hashlib.sha256(playback.snapshot.position.tobytes()).hexdigest()


def run(playback, seconds, fps, action=(0,) * 6):
    for _ in range(round(seconds * fps)):
        playback.tick(1 / fps, action)


def test_the_simulation_does_not_depend_on_the_frame_rate():
    hashes = set()
    for fps in (20, 60, 144):
        playback = Playback(FakeSimulator())
        playback.play(a_level())
        playback.tick(0.0)
        run(playback, 2.0, fps, (1, 0, 0, 0, 0, 0))
        assert playback.step_count == 2 * 60 // FRAME_SKIP
        hashes.add(state_hash(playback))
    assert len(hashes) == 1


@pytest.mark.parametrize("speed", SPEEDS)
def test_speed_counts_steps(speed):
    playback = Playback(FakeSimulator())
    playback.simulator.ends_at = 10_000
    playback.speed = speed
    playback.play(a_level())
    playback.tick(0.0)
    run(playback, 4.0, 60)
    assert playback.step_count == pytest.approx(4 * 30 * speed, abs=1)


def test_slower_and_faster_stop_at_the_ends(playback):
    for _ in range(20):
        playback.slower()
    assert playback.speed == 1 / 16
    for _ in range(20):
        playback.faster()
    assert playback.speed == 8


def test_pausing_stops_time(playback):
    playback.play(a_level())
    run(playback, 0.5, 60)
    steps = playback.step_count
    playback.pause()
    run(playback, 1.0, 60)
    assert (playback.mode, playback.step_count) == (Mode.PAUSED, steps)
    playback.pause()
    run(playback, 0.5, 60)
    assert playback.step_count > steps


def test_one_step_is_one_step_and_pauses(playback):
    playback.play(a_level())
    playback.tick(0.0)
    playback.step((2, 0, 0, 0, 0, 0))
    playback.tick(0.0)
    assert (playback.mode, playback.step_count) == (Mode.PAUSED, 1)


def test_stepping_back_and_forward_again_gives_the_same_states(playback):
    playback.play(a_level())
    playback.tick(0.0)
    run(playback, 1.0, 60)
    late = state_hash(playback)
    steps = playback.step_count
    for _ in range(10):
        playback.step_back()
    assert playback.step_count == steps - 10
    for _ in range(10):
        playback.step((0,) * 6)
        playback.tick(0.0)
    assert state_hash(playback) == late


def test_stepping_back_ends_at_the_start(playback):
    playback.play(a_level())
    playback.tick(0.0)
    playback.step((0,) * 6)
    playback.tick(0.0)
    for _ in range(5):
        playback.step_back()
    assert playback.step_count == 0


def test_of_a_long_episode_all_is_kept_but_old_states(playback):
    assert RING_STATES >= 1024
    playback.simulator.ends_at = 10_000
    playback.speed = 8.0
    playback.play(a_level())
    run(playback, 10.0, 60)
    trace = playback.trace
    assert len(playback.ring) > RING_STATES + 100
    assert trace.snapshots[0].step == 0
    assert len(trace.actions) == len(trace.snapshots) - 1
    assert playback.ring.bare == len(playback.ring) - RING_STATES
    playback.scrub(playback.ring.bare - 1)
    assert not playback.can_branch  # it can be looked at alone
    playback.scrub(playback.ring.bare + 5)
    step = playback.step_count
    playback.branch()
    for _ in range(10):
        playback.step_back()
    assert playback.step_count == step - 5
    assert playback.trace.snapshots[0].step == 0


def test_the_end_freezes(playback):
    playback.simulator.ends_at = 10
    playback.play(a_level())
    run(playback, 2.0, 60)
    assert (playback.mode, playback.step_count, playback.outcome) == (Mode.ENDED, 10, "timeout")
    assert len(playback.ring) == 11


def test_after_the_end_one_can_step_back(playback):
    playback.simulator.ends_at = 10
    playback.play(a_level())
    run(playback, 2.0, 60)
    playback.step_back()
    assert (playback.mode, playback.step_count, playback.outcome) == (Mode.PAUSED, 9, None)


def test_reset_starts_anew(playback):
    playback.play(a_level())
    run(playback, 1.0, 60)
    playback.reset()
    playback.tick(0.0)
    assert (playback.mode, playback.step_count) == (Mode.PLAYING, 0)
    playback.pause()
    playback.reset()
    playback.tick(0.0)
    assert playback.mode is Mode.PAUSED


def test_an_automatic_restart_waits_a_second(playback):
    playback.simulator.ends_at = 5
    playback.restart_automatically = True
    playback.play(a_level())
    run(playback, 0.5, 60)
    assert playback.mode is Mode.ENDED
    run(playback, 0.75, 60)
    assert playback.mode is Mode.PLAYING


def test_stop_leaves_nothing(playback):
    playback.play(a_level())
    run(playback, 1.0, 60)
    playback.stop()
    assert playback.mode is Mode.EDIT
    assert playback.snapshot is None
    assert len(playback.ring) == 0


def test_a_failure_pauses_and_says_so(playback):
    playback.play(a_level())
    playback.tick(0.0)
    playback.simulator.error = "The level is broken."
    with pytest.raises(KinetixError, match="broken"):
        playback.tick(0.1)
    assert playback.mode is Mode.PAUSED


def test_what_cannot_start_leaves_play(playback):
    playback.simulator.error = "The level is broken."
    playback.play(a_level())
    with pytest.raises(KinetixError, match="broken"):
        playback.tick(0.1)
    assert playback.mode is Mode.EDIT
    assert not playback.waiting
    assert playback.failure == "The level is broken."
    playback.play(a_level())
    playback.tick(0.1)
    assert playback.mode is Mode.PLAYING and not playback.failure


def test_a_slow_simulation_is_asked_for_no_more_than_it_can_do(playback):
    playback.play(a_level())
    playback.tick(0.0)
    playback.simulator.delayed = True
    run(playback, 5.0, 60)
    assert 0 < playback.simulator.outstanding <= 8


def test_a_trace_has_one_action_less_than_states(playback):
    playback.play(a_level())
    playback.tick(0.0)
    run(playback, 1.0, 60, (1, 0, 0, 0, 0, 0))
    playback.step_back()
    trace = playback.trace
    assert len(trace.snapshots) == len(trace.actions) + 1 == 30
    assert trace.arrays()["position"].shape == (30, 4, 2)


def test_a_replay_can_be_scrubbed_and_not_changed(playback):
    playback.play(a_level())
    playback.tick(0.0)
    run(playback, 1.0, 60)
    trace = playback.trace
    playback.replay(trace, a_level())
    playback.scrub(12)
    assert (playback.mode, playback.snapshot) == (Mode.REPLAY, trace.snapshots[12])
    playback.step()
    assert playback.step_count == 13
    playback.step_back()
    playback.scrub(10_000)
    assert playback.snapshot is trace.snapshots[-1]


@pytest.mark.parametrize("again", ["played on", "anew"])
def test_an_episode_keeps_the_physics_that_it_is_played_under(playback, again):
    playback.play(a_level())
    run(playback, 0.5, 60)
    playback.physics = "accurate"
    assert playback.trace.physics == playback.played_under == "balanced"
    playback.scrub(3)
    if again == "anew":
        playback.reset()
    else:
        playback.branch()
        playback.pause()
    run(playback, 0.5, 60)
    expected = "accurate" if again == "anew" else "balanced"
    assert playback.trace.physics == playback.simulator.physics == expected


def test_a_recording_is_played_on_under_its_own_physics(playback):
    playback.play(a_level())
    run(playback, 0.5, 60)
    trace = playback.trace
    playback.stop()
    playback.physics = "accurate"
    playback.replay(trace, a_level())
    assert playback.played_under == "balanced"
    playback.branch()
    run(playback, 0.5, 60)
    assert playback.trace.physics == playback.simulator.physics == "balanced"


def test_the_real_time_factor_is_measured(playback):
    playback.speed = 0.5
    playback.play(a_level())
    run(playback, 3.0, 60)
    assert playback.real_time_factor == pytest.approx(0.5, abs=0.05)
