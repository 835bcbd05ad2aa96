"""Episodes in files: exported, opened again, looked at step by step."""

import dataclasses

import numpy as np
import pytest

from editor import actions
from editor.actions import run
from editor.actions.files import export
from editor.base.events import DropEvent
from editor.documents.commands.level import ReplaceLevel
from editor.play.mode import Mode
from editor.play.trace_files import read_trace, write_trace
from editor.worker.snapshots import Mind
from kinetix.errors import KinetixError
from tests.editor.core.helpers import a_level, a_session


@pytest.fixture
def played(session):
    """A session that has played ten steps, the last of which won."""
    session.document.commit(start_level())
    session.playback.simulator.ends_at = 10
    run(session, "run.play_human")
    session.hands.held = {"left"}
    for _ in range(60):
        actions.update(session, 1 / 60)
    assert session.mode is Mode.ENDED
    return session


def start_level():
    return ReplaceLevel(level=a_level(), label="Start")


def test_what_was_written_is_what_is_read(played, tmp_path):
    path = tmp_path / "episode.npz"
    trace, level = played.playback.trace, played.playback.level
    write_trace(trace, level, path)
    found = read_trace(path)
    assert found.level == level
    assert found.trace.actions == trace.actions
    assert (found.trace.physics, found.trace.from_file) == (trace.physics, True)
    for mine, theirs in zip(trace.snapshots, found.trace.snapshots, strict=True):
        assert (mine.step, mine.outcome, mine.action) == (
            theirs.step,
            theirs.outcome,
            theirs.action,
        )
        for name in ("position", "angle", "velocity", "angular_velocity", "motor", "thruster"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(theirs, name))
        assert theirs.reward == pytest.approx(mine.reward)


def test_a_dropped_episode_is_a_replay_that_cannot_be_played_on(played, tmp_path):
    path = tmp_path / "episode.npz"
    write_trace(played.playback.trace, played.playback.level, path)
    session = a_session()
    actions.handle(session, DropEvent(path=str(path)))
    assert session.mode is Mode.REPLAY
    assert session.document.level == played.document.level.replace(next_id=7)
    assert not session.document.dirty
    session.playback.scrub(4)
    assert session.playback.step_count == 4
    assert not actions.available(session, actions.BY_ID["run.start_here"])
    run(session, "run.stop")
    assert session.editing


def test_an_ending_in_capitals_is_the_same_ending(played, tmp_path):
    path = tmp_path / "EPISODE.NPZ"
    write_trace(played.playback.trace, played.playback.level, path)
    assert [each for each in tmp_path.iterdir() if each.is_file()] == [path]
    session = a_session()
    actions.handle(session, DropEvent(path=str(path)))
    assert session.mode is Mode.REPLAY


def test_an_agents_thoughts_are_kept(played, tmp_path):
    path = tmp_path / "episode.npz"
    trace = played.playback.trace
    mind = Mind(intention=(0.5,) * 6, own_action=(1.0,) * 6, value=0.25, entropy=1.5)
    last = dataclasses.replace(trace.snapshots[-1], mind=mind, action=(1.0,) * 6)
    trace = dataclasses.replace(trace, snapshots=(*trace.snapshots[:-1], last), player="Keeper")
    write_trace(trace, played.playback.level, path)
    found = read_trace(path).trace
    assert found.player == "Keeper"
    assert found.snapshots[-1].mind == mind
    assert found.snapshots[0].mind is None


def test_thoughts_without_actions_are_kept_too(played, tmp_path):
    """As a file says whose actions are damaged."""
    trace = played.playback.trace
    mind = Mind(intention=(0.5,) * 6, own_action=(), value=0.25, entropy=1.5)
    snapshots = [dataclasses.replace(each, mind=mind, action=()) for each in trace.snapshots]
    write_trace(
        dataclasses.replace(trace, snapshots=tuple(snapshots)),
        played.playback.level,
        tmp_path / "episode.npz",
    )
    found = read_trace(tmp_path / "episode.npz").trace
    assert all(each.action == () for each in found.snapshots)
    assert found.snapshots[0].mind.intention == (0.5,) * 6


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b'{"format": "kinetix-level"}'])
def test_what_is_no_episode_is_said_in_a_sentence(session, tmp_path, content):
    path = tmp_path / "bad.npz"
    path.write_bytes(content)
    with pytest.raises(KinetixError, match=r"bad\.npz: expected an episode"):
        read_trace(path)
    assert not export.open_trace(session, path)
    assert session.editing


def _with(played, path, **changes):
    """An episode in whose file some arrays are others; None leaves one out."""
    write_trace(played.playback.trace, played.playback.level, path)
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files} | changes
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


@pytest.mark.parametrize(
    "changes",
    [
        {"angle": None},
        {"angle": np.zeros((11, 1))},
        {"velocity": np.zeros((11, 2, 3))},
        {"position": np.full((11, 2, 2), np.nan)},
        {"step": np.array(3)},
        {"step": np.array(["a"] * 11)},
        {"frame_skip": np.array("x")},
        {"value": np.zeros((11, 2))},
        {"frame_skip": np.array(2**62)},
        {"unified": np.zeros((11, 0))},
        {"attempt": np.array(-1)},
        {"action": np.zeros((3, 6), np.int32)},
        {"seed": np.array(np.inf)},
        {"level": np.array("{}")},
        {"level": np.array(3)},
        {"player": np.array(3)},
        {"outcome": np.array(["won", "lost"])},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_an_episode_whose_arrays_do_not_fit_is_one_sentence(played, tmp_path, changes):
    path = _with(played, tmp_path / "episode.npz", **changes)
    with pytest.raises(KinetixError, match=r"episode\.npz: "):
        read_trace(path)


def test_an_export_that_fails_leaves_the_file_before_it(played, tmp_path, monkeypatch):
    path = tmp_path / "episode.npz"
    path.write_bytes(b"before")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(KinetixError, match="No space left"):
        write_trace(played.playback.trace, played.playback.level, path)
    assert path.read_bytes() == b"before"


def test_states_of_another_level_are_refused(played, tmp_path):
    path = tmp_path / "episode.npz"
    level = played.playback.level
    write_trace(played.playback.trace, level.replace(bodies=level.bodies[:2], joints=()), path)
    with pytest.raises(KinetixError, match="do not belong"):
        read_trace(path)
    np.savez(path, step=np.arange(3))
    with pytest.raises(KinetixError, match="'level' is missing"):
        read_trace(path)
