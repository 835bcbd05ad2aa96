"""Recorded play that is played again, and kinetix-env's layout of it."""

import dataclasses
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from kinetix.agents.evaluate import NamedLevel, Settings, evaluate
from kinetix.agents.recording import recorded_attempts
from kinetix.agents.scripted import ScriptedPlayer
from kinetix.cli.dataset import ExportDataset, GatherEpisodes, RecordEpisodes, VerifyDataset, run
from kinetix.datasets.episode import RecordedEpisode, solution_episode
from kinetix.datasets.folder import add_episodes, read_dataset
from kinetix.datasets.offline import (
    ORIGINS,
    PER_SHARD,
    STEPS,
    is_offline,
    read_offline,
    write_offline,
)
from kinetix.datasets.replays import ReplayedEpisode, checked, replay, up_to_the_win
from kinetix.datasets.sources import check_source, episodes_of, origins_of
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level, save_level
from kinetix.level.sizes import SIZES

LEVEL = "s/goalkeeper"


def test_a_solution_replays_and_a_broken_one_does_not() -> None:
    """`replays` says whether the controls alone end the episode alike."""
    found = solution_episode(load_level(LEVEL))
    assert found is not None
    assert checked(found).replays
    idle = dataclasses.replace(found, control=np.zeros_like(found.control))
    assert not checked(idle).replays
    unknown = dataclasses.replace(found, physics="nonsuch")
    assert not checked(unknown).replays and not up_to_the_win(unknown).replays
    again = replay(found)
    assert again.length == found.length and again.outcome == "won"
    assert again.states.physics.position.shape[0] == found.length


def test_recorded_attempts_are_those_of_an_evaluation() -> None:
    """Outcome and length of every attempt are those that `kinetix eval` counts."""
    player, settings = ScriptedPlayer("random"), Settings(attempts=5, seed=3)
    level = NamedLevel(name=LEVEL, source=LEVEL)
    *_, last = evaluate(player, [level], settings)
    found = [one for one in recorded_attempts(player, level, settings) if one is not None]
    measured = last.results[0].episodes
    assert [(e.outcome, e.length) for e in found] == [(e.outcome, e.length) for e in measured]
    for episode, result in zip(found, measured, strict=True):
        assert np.isclose(episode.reward.sum(), result.total_reward, atol=1e-4)


def test_kinetix_env_layout_goes_both_ways(tmp_path: Path) -> None:
    """States and actions of 256 steps, begun again after the end; read back as the same episode."""
    found = solution_episode(load_level(LEVEL))
    assert found is not None
    found = dataclasses.replace(found, level=found.level.replace(max_timesteps=1000))
    times = STEPS // found.length + 1
    more = {name: np.repeat(getattr(found, name), times, axis=0) for name in ("control", "reward")}
    refused = [dataclasses.replace(found, replays=False), dataclasses.replace(found, **more)]
    told = write_offline(tmp_path / "out", [found, *refused])
    assert (told.trajectories, told.shards, len(told.left_out)) == (1, 1, 2)
    assert "more than the 256 of a trajectory" in told.left_out[1]
    (shard,) = (tmp_path / "out").glob("*.npz")
    with np.load(shard) as arrays:
        assert arrays["action"].shape == (1, STEPS, 6)
        assert arrays["env_state/polygon/position"].shape == (1, STEPS, SIZES["l"].polygons, 2)
        assert arrays["env_state/timestep"][0, found.length] == 0  # begun again
        assert np.flatnonzero(arrays["done"][0])[0] == found.length - 1
    assert is_offline(tmp_path / "out")
    (back,) = read_offline(tmp_path / "out")
    assert np.array_equal(back.control, found.control)
    for name in ("outcome", "physics", "frame_skip", "source", "player"):
        assert getattr(back, name) == getattr(found, name)
    assert back.level.name == found.level.name and back.level.max_timesteps == 1000
    ours = {body.shape for body in found.level.bodies}
    assert len(back.level.bodies) == len(found.level.bodies) and len(ours) > 0
    places = lambda level: sorted(body.position for body in level.bodies)  # noqa: E731
    assert np.allclose(places(back.level), places(found.level), atol=1e-5)
    assert [joint.motor for joint in back.level.joints] == [
        joint.motor for joint in found.level.joints
    ]


def test_the_command_gathers_and_verifies(tmp_path: Path) -> None:
    """Solutions of levels go in; a second time they are there already; all replay."""
    out = tmp_path / "set"
    assert run(GatherEpisodes(out=out, sources=(LEVEL,))) == 0
    assert run(GatherEpisodes(out=out, sources=(LEVEL, str(out)))) == 0
    assert len(list(read_dataset(out))) == 1
    assert run(VerifyDataset(folder=out)) == 0


def test_a_refused_command_leaves_no_folder_behind(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An output folder that the command made is removed when nothing was written to it."""
    out, unsolved = tmp_path / "out", tmp_path / "unsolved.json"
    with pytest.raises(KinetixError, match="expected a data set"):
        run(ExportDataset(folder=tmp_path / "nix", out=out))
    with pytest.raises(KinetixError, match="nope"):
        run(RecordEpisodes(out=out, agent="nope", levels=(LEVEL,)))
    save_level(load_level(LEVEL).replace(solution=None), unsolved)
    assert run(GatherEpisodes(out=out, sources=(str(unsolved),))) == 1
    told = f"left out: {unsolved}: 1 level without a recorded solution"
    assert told in capsys.readouterr().err
    assert not out.exists()


def test_a_solution_that_wins_early_is_cut_there(tmp_path: Path) -> None:
    """Controls after the win are dropped, so that replaying gives the episode as it is stored."""
    level = load_level(LEVEL)
    found, solution = solution_episode(level), level.solution
    assert found is not None and solution is not None
    longer = solution.replace(actions=(*solution.actions, (3, solution.actions[-1][1])))
    save_level(level.replace(solution=longer), tmp_path / "longer.json")
    out = tmp_path / "set"
    assert run(GatherEpisodes(out=out, sources=(str(tmp_path / "longer.json"),))) == 0
    (episode,) = read_dataset(out)
    assert episode.replays and episode.length == found.length
    assert episode.reward.tolist() == [0.0] * (found.length - 1) + [1.0]


def test_what_controls_do_not_tell_is_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An episode that no export can take is named where the set is checked, and why by export."""
    found = solution_episode(load_level(LEVEL))
    assert found is not None
    out = tmp_path / "set"
    pulled = dataclasses.replace(found, control=np.zeros_like(found.control))
    add_episodes(out, [found, checked(pulled)])
    assert run(VerifyDataset(folder=out)) == 0
    printed = capsys.readouterr()
    assert "untold    1" in printed.out
    assert "1 episode cannot be played again from the controls alone" in printed.err
    assert run(ExportDataset(folder=out, out=tmp_path / "offline")) == 0
    printed = capsys.readouterr()
    assert "1 trajectory in 1 shard" in printed.out
    assert f"otherwise than won after {found.length} steps" in printed.err


def test_sources_are_checked_before_anything_is_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A name that is wrong is told before the work of the names before it."""
    played: list[str] = []
    monkeypatch.setattr("kinetix.datasets.replays.up_to_the_win", played.append)
    missing = str(tmp_path / "mine.npz")
    with pytest.raises(KinetixError, match=r"mine\.npz: cannot be read"):
        run(GatherEpisodes(out=tmp_path / "set", sources=(LEVEL, missing)))
    assert played == [] and not (tmp_path / "set").exists()


@pytest.fixture
def states(monkeypatch: pytest.MonkeyPatch) -> dict[str, object]:
    """Stands in for playing again: changes to how it ends."""
    changes: dict[str, object] = {}

    def played(episode: RecordedEpisode, capacity: object = None) -> ReplayedEpisode:
        again = ReplayedEpisode(
            states=None, reward=episode.reward, length=episode.length, outcome=episode.outcome
        )
        return dataclasses.replace(again, **changes)

    def arrays(states: object) -> dict[str, np.ndarray]:
        return {"env_state/timestep": np.arange(STEPS)}

    monkeypatch.setattr("kinetix.datasets.replays.replay", played)
    monkeypatch.setattr("kinetix.datasets.offline.state_arrays", arrays)
    return changes


def _solution() -> RecordedEpisode:
    found = solution_episode(load_level(LEVEL))
    assert found is not None
    return found


@pytest.mark.parametrize("change", [{"length": 3}, {"outcome": "lost"}])
def test_what_ends_otherwise_at_the_size_of_an_export_is_left_out(
    tmp_path: Path, states: dict[str, object], change: dict[str, object]
) -> None:
    """The trajectory would not be that of its outcome."""
    states |= change
    told = write_offline(tmp_path / "out", [_solution()])
    assert told.trajectories == told.shards == 0
    assert "in states of this size, it ends with" in told.left_out[0]
    assert not (tmp_path / "out").exists()


def test_two_exports_do_not_write_into_one_folder(
    tmp_path: Path, states: dict[str, object]
) -> None:
    """The second one would write over the shards of the first."""
    out = tmp_path / "out"

    def asking_for_another() -> Iterator[RecordedEpisode]:
        with pytest.raises(KinetixError, match="another export writes here now"):
            write_offline(out, [_solution()])
        yield _solution()

    assert write_offline(out, asking_for_another()).trajectories == 1


def test_an_interrupted_export_says_where_its_shards_are_from(
    tmp_path: Path, states: dict[str, object]
) -> None:
    """A trajectory without a known origin counts as one of kinetix-env's."""

    def until_now() -> Iterator[RecordedEpisode]:
        yield from [_solution()] * (PER_SHARD + 1)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_offline(tmp_path / "out", until_now())
    assert len(list((tmp_path / "out").glob("*.npz"))) == 1
    told = json.loads((tmp_path / "out" / ORIGINS).read_text())
    assert len(told["trajectories"]) == PER_SHARD


def test_a_folder_of_everything_is_gathered(
    tmp_path: Path, states: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Data sets, exports and solutions below one folder; what is no level is told."""
    found = _solution()
    add_episodes(tmp_path / "set", [found])
    write_offline(tmp_path / "out", [found])
    save_level(found.level, tmp_path / "a.json")
    (tmp_path / "notes.json").write_text("{}")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "dataset.json").write_text('{"name": "of another program"}')
    (tmp_path / "A.NPZ").write_bytes(b"no archive")
    np.savez(tmp_path / "foreign.npz", x=np.zeros(3))
    sentences = check_source(str(tmp_path))
    assert [Path(one.split(":")[0]).relative_to(tmp_path).as_posix() for one in sentences] == [
        "other/dataset.json",
        "notes.json",
        "A.NPZ",
        "foreign.npz",
    ]
    for file in ("A.NPZ", "foreign.npz", "other"):  # what is named itself is refused
        with pytest.raises(KinetixError, match=file):
            check_source(str(tmp_path / file))
    monkeypatch.setattr("kinetix.datasets.sources.read_offline", lambda folder: iter([found]))
    places = [(one.place, one.name) for one in episodes_of(str(tmp_path))]
    assert places == [
        ("dataset", str(tmp_path / "set")),
        ("offline", str(tmp_path / "out")),
        ("solution", "a"),
    ]


def test_damaged_shards_below_a_folder_are_told_and_passed_over(tmp_path: Path) -> None:
    """One damaged file does not lose what lies beside it; what is named itself is refused."""
    found = _solution()
    for name in ("a", "b"):
        add_episodes(tmp_path / name, [found])
    shard = tmp_path / "a" / "episodes-00000.npz"
    shard.write_bytes(shard.read_bytes()[:-9])
    (tmp_path / "out").mkdir()
    np.savez(tmp_path / "out" / "shard.npz", **{"env_state/timestep": np.zeros(3)})
    assert check_source(str(tmp_path)) == ()
    told: list[str] = []
    assert [one.name for one in episodes_of(str(tmp_path), told.append)] == [str(tmp_path / "b")]
    assert [one.split(":")[0] for one in told] == [str(shard), str(tmp_path / "out" / "shard.npz")]
    assert len(list(origins_of(str(tmp_path)))) == 2
    for name in ("a", "out"):
        with pytest.raises(KinetixError, match=name):
            list(episodes_of(str(tmp_path / name)))


def test_a_bad_manifest_is_one_sentence_and_not_one_per_shard(tmp_path: Path) -> None:
    """Its shards are no damaged episodes of the editor."""
    add_episodes(tmp_path / "set", [_solution()])
    manifest = tmp_path / "set" / "dataset.json"
    manifest.write_text("{}")
    (sentence,) = check_source(str(tmp_path))
    assert sentence.startswith(f"{manifest}: ")
