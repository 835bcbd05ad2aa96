"""Bundled levels and agents have names that work from any folder."""

import pytest

from kinetix import cli, load_agent, load_level
from kinetix.bundled import LEVEL_FOLDERS, named_agent, named_levels
from kinetix.errors import CheckpointError, LevelError
from kinetix.level.sets import gather_levels
from kinetix.paths import checkpoints_dir, levels_dir


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", ["s/first_flight", "levels/s/first_flight.json"])
def test_a_level(name):
    assert load_level(name).name == "First flight"


@pytest.mark.parametrize(("name", "file"), [("s", "s"), ("levels/s", "s"), ("levels", "")])
def test_folders_of_levels(name, file):
    assert named_levels(name) == levels_dir() / file
    assert len(gather_levels([name])) == len(list((levels_dir() / file).rglob("*.json"))) - (
        0 if file else len(list((levels_dir() / "sets").glob("*.json")))
    )


def test_sets():
    assert len(gather_levels(["sets/s"])) == len(gather_levels(["levels/sets/s.json"])) > 3


@pytest.mark.parametrize("name", ["general", "checkpoints/general"])
def test_agents(name):
    assert named_agent(name) == checkpoints_dir() / "general"
    assert load_agent(name).card.name


def test_typos_are_recognised():
    with pytest.raises(LevelError, match="did you mean 's/goalkeeper'"):
        load_level("s/goalkeper")
    with pytest.raises(CheckpointError, match="did you mean 'goalkeeper'"):
        load_agent("goal_keeper")
    with pytest.raises(CheckpointError, match="there are general, goalkeeper, noop"):
        load_agent("zzz")


def test_further_folders_come_first(tmp_path, monkeypatch):
    folder = tmp_path / "others" / "s"
    folder.mkdir(parents=True)
    text = (levels_dir() / "s" / "goalkeeper.json").read_text()
    (folder / "h0_weak_thrust.json").write_text(text)
    with pytest.raises(LevelError, match="no such file"):
        load_level("s/h0_weak_thrust")
    monkeypatch.setenv(LEVEL_FOLDERS, str(folder.parent))
    assert load_level("s/h0_weak_thrust").name == load_level("s/goalkeeper").name


def test_a_command_takes_names(capsys):
    assert cli.main(["validate", "s/first_flight", "levels/s"]) == 0
    assert "first_flight" in capsys.readouterr().out
