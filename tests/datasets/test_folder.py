"""Data sets on disk: round trips, hashes, damage, foreign folders. No JAX."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from kinetix.cli import main
from kinetix.datasets.episode import RecordedEpisode, solution_episode, winning_plan
from kinetix.datasets.folder import (
    MANIFEST,
    add_episodes,
    read_dataset,
    read_manifest,
    unlisted_shards,
)
from kinetix.datasets.shard import SCHEMA, read_shard
from kinetix.errors import KinetixError
from kinetix.level.codec import level_hash, load_level
from kinetix.level.model import MAX_STEPS


def episode(name: str = "s/goalkeeper", steps: int = 5) -> RecordedEpisode:
    """A made-up plan."""
    rows = np.tile([1, 2, 0, 0, 1, 0], (steps, 1))
    return winning_plan(load_level(name), rows, physics="balanced", frame_skip=2)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    """Levels, controls, rewards and facts come back; equal levels are written once."""
    person = dataclasses.replace(episode(steps=7), source="person", outcome="lost", replays=False)
    other = dataclasses.replace(
        episode("s/first_flight"), source="agent", player="general", digest="ab", seed=-3, attempt=2
    )
    told = add_episodes(tmp_path / "set", [person, other, episode()])
    assert (told.added, told.known, told.empty) == (3, 0, 0)
    found = list(read_dataset(tmp_path / "set"))
    for before, after in zip((person, other, episode()), found, strict=True):
        assert level_hash(after.level) == level_hash(before.level)
        assert np.array_equal(after.control, before.control)
        assert np.array_equal(after.reward, before.reward)
        for name in ("outcome", "source", "player", "digest", "seed", "attempt", "replays"):
            assert getattr(after, name) == getattr(before, name), name
    (shard,) = (tmp_path / "set").glob("*.npz")
    with np.load(shard) as arrays:
        assert set(arrays) == set(SCHEMA)
        assert len(arrays["level_end"]) == 2
        assert json.loads(str(arrays["schema"]))["format"] == "kinetix-episodes"
        assert np.flatnonzero(arrays["done"]).tolist() == [6, 11, 16]
        assert arrays["action"][0].tolist() == [1, 2, 0, 0, 1, 0]


def test_episodes_are_added_once(tmp_path: Path) -> None:
    """A second run adds a shard with what is new; empty episodes are left out."""
    add_episodes(tmp_path, [episode()])
    told = add_episodes(tmp_path, [episode(), episode(steps=9), episode(steps=0)])
    assert (told.added, told.known, told.empty) == (1, 1, 1)
    manifest = read_manifest(tmp_path)
    assert (len(manifest.shards), manifest.episodes, manifest.steps) == (2, 2, 14)


UNFIT = {
    "no number": {"control": np.full((5, 6), np.nan, np.float32)},
    "beyond 1": {"control": np.full((5, 6), 1.5, np.float32)},
    "too long": {
        "control": np.zeros((MAX_STEPS + 1, 6), np.float32),
        "reward": np.zeros(MAX_STEPS + 1, np.float32),
    },
    "of another length": {"reward": np.zeros(4, np.float32)},
    "too few controls": {"control": np.zeros((5, 5), np.float32)},
    "no such outcome": {"outcome": "draw"},
    "no such source": {"source": "nobody"},
    "a vast seed": {"seed": 2**64},
}
"""Changes after which an episode could not be read again."""


@pytest.mark.parametrize("name", UNFIT)
def test_what_could_not_be_read_again_is_left_out_and_told(tmp_path: Path, name: str) -> None:
    """The other episodes of the shard are there."""
    unfit = dataclasses.replace(episode(), **UNFIT[name])
    told = add_episodes(tmp_path, [episode(steps=3), unfit, episode(steps=4)])
    assert told.added == 2
    (sentence,) = told.unfit
    assert sentence.startswith("Goalkeeper: left out: ")
    assert [one.length for one in read_dataset(tmp_path)] == [3, 4]


def test_a_stopped_recording_keeps_whole_shards(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The shards before the stop are a data set; recording again adds the rest."""
    monkeypatch.setattr("kinetix.datasets.folder.SHARD_STEPS", 5)

    def stopping():
        yield episode()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        add_episodes(tmp_path, stopping())
    assert read_manifest(tmp_path).episodes == 1
    assert add_episodes(tmp_path, [episode(), episode(steps=6)]).added == 1


@pytest.mark.parametrize("stop", [KeyboardInterrupt, KinetixError])
def test_what_was_recorded_before_a_stop_is_kept(tmp_path: Path, stop: type) -> None:
    def stopping():
        yield episode()
        yield episode(steps=6)
        raise stop

    with pytest.raises(stop):
        add_episodes(tmp_path, stopping())
    assert read_manifest(tmp_path).episodes == len(list(read_dataset(tmp_path))) == 2


def test_an_exchanged_shard_is_told(tmp_path: Path) -> None:
    """The manifest's hash guards the file, the identities guard its content."""
    add_episodes(tmp_path, [episode()])
    (path,) = tmp_path.glob("*.npz")
    with np.load(path) as arrays:
        changed = dict(arrays)
    changed["control"] = -changed["control"]
    np.savez(path, **changed)
    with pytest.raises(KinetixError, match="SHA-256"):
        list(read_dataset(tmp_path))
    with pytest.raises(KinetixError, match="identity"):
        read_shard(path)


def test_a_manifest_that_counts_otherwise_than_its_shards_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The counts that are printed are those of the episodes."""
    add_episodes(tmp_path, [episode()])
    path = tmp_path / MANIFEST
    path.write_text(path.read_text().replace('"episodes": 1', '"episodes": 999'))
    assert main(["dataset", "verify", str(tmp_path), "--no-replay"]) == 1
    told = capsys.readouterr().err
    assert "dataset.json: $.shards[0]: expected 1 episode and 5 steps as in episodes-0000" in told
    assert "got 999 episodes and 5 steps" in told


@pytest.mark.parametrize("name", [n for n in SCHEMA if n not in ("schema", "action", "reward")])
def test_damage_is_one_sentence(tmp_path: Path, name: str) -> None:
    """A shard whose arrays do not belong to each other is refused with its name."""
    add_episodes(tmp_path, [episode(), episode("s/first_flight")])
    (path,) = tmp_path.glob("*.npz")
    with np.load(path) as arrays:
        changed = dict(arrays)
    changed[name] = changed[name][:-1]
    np.savez(path, **changed)
    with pytest.raises(KinetixError, match=r"episodes-00000\.npz: expected a shard"):
        read_shard(path)


def test_other_folders_are_left_alone(tmp_path: Path) -> None:
    """A folder with other files is no data set and becomes none."""
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(KinetixError, match="holds no data set"):
        add_episodes(tmp_path, [episode()])
    with pytest.raises(KinetixError, match="found none"):
        read_manifest(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_a_manifest_names_no_file_elsewhere(tmp_path: Path) -> None:
    """A data set from somewhere else cannot have other files read."""
    add_episodes(tmp_path, [episode()])
    path = tmp_path / MANIFEST
    path.write_text(path.read_text().replace("episodes-00000.npz", "../secret.npz"))
    with pytest.raises(KinetixError, match="without a folder"):
        list(read_dataset(tmp_path))


def test_no_shard_is_ever_overwritten(tmp_path: Path) -> None:
    """A manifest that says nothing is refused; one that forgot a shard has it told and left."""
    add_episodes(tmp_path, [episode()])
    path, (shard,) = tmp_path / MANIFEST, tmp_path.glob("*.npz")
    tree, data = json.loads(path.read_text()), shard.read_bytes()
    path.write_text("{}")
    with pytest.raises(KinetixError, match=r"dataset\.json: .*format"):
        add_episodes(tmp_path, [episode("s/first_flight")])
    path.write_text(json.dumps(tree | {"shards": []}))
    assert unlisted_shards(tmp_path) == [shard]
    assert main(["dataset", "verify", str(tmp_path)]) == 1
    add_episodes(tmp_path, [episode("s/first_flight")])
    assert shard.read_bytes() == data
    assert len(list(read_dataset(tmp_path))) == 1


def test_solutions_become_episodes() -> None:
    """The controls of a recorded solution are those of its actions."""
    level = load_level("s/goalkeeper")
    found = solution_episode(level)
    assert found is not None and level.solution is not None
    assert found.action.tolist() == [list(row) for row in level.solution.unrolled()]
    assert found.source == "solver" and found.outcome == "won" and found.reward[-1] == 1.0
    assert solution_episode(level.replace(solution=None)) is None


def test_controls_become_the_nearest_action() -> None:
    """Half of the way to full drive decides."""
    control = np.zeros((6, 6), np.float32)
    control[:, 0] = [0.01, -0.01, 0.4, 0.6, -0.6, 1.0]
    control[:, 4] = [0.0, 0.1, 0.4, 0.6, 0.9, 1.0]
    action = dataclasses.replace(episode(), control=control).action
    assert action[:, 0].tolist() == [0, 0, 0, 1, 2, 1]
    assert action[:, 4].tolist() == [0, 0, 0, 1, 1, 1]
