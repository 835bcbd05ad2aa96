"""Level files and sets that ask for too much, reach too far, or once ended in a traceback."""

import json
import os

import pytest

from kinetix.cli import main
from kinetix.errors import LevelError
from kinetix.level.codec import dumps, load_level, loads, save_level
from kinetix.level.model import MAX_STEPS, Level, Solution
from kinetix.level.sets import build_set, gather_levels, load_set, save_set, within_reach

STILL = [0, 0, 0, 0, 0, 0]


def _level(**changes):
    return json.dumps(
        {
            "format": "kinetix-level",
            "version": 1,
            "name": "x",
            "gravity": [0.0, -9.81],
            "next_id": 1,
        }
        | changes
    )


@pytest.mark.parametrize("value", ["a", "s", 3, None, [], {}, {"type": "size", "params": 1}])
@pytest.mark.parametrize("key", ["static_env_params", "env_params"])
def test_parameters_of_kinetix_env_that_are_something_else(key, value):
    tree = {"env_state": {}, "env_params": {}, "static_env_params": {}} | {key: value}
    with pytest.raises(LevelError, match=r"\$\."):
        loads(json.dumps(tree))


@pytest.mark.parametrize(
    ("block", "name", "value"),
    [
        ("static_env_params", "frame_skip", 0),
        ("static_env_params", "frame_skip", 10**9),
        ("static_env_params", "num_motor_bindings", 10**9),
        ("static_env_params", "downscale", 0),
        ("static_env_params", "screen_dim", {"0": 1000000, "1": 500}),
        ("env_params", "dt", 0.0),
        ("env_params", "dt", -1.0),
    ],
)
def test_parameters_that_nothing_can_be_stepped_with(block, name, value):
    tree = json.loads(dumps(load_level("s/first_flight"), format="kinetix-env"))
    loads(json.dumps(tree))
    tree[block][name] = value
    with pytest.raises(LevelError, match=rf"\$\.{block}\.{name}.*: expected"):
        loads(json.dumps(tree))


def test_a_solution_is_as_long_as_an_episode_at_most():
    solution = {"physics": "balanced", "frame_skip": 2, "actions": [[MAX_STEPS, STILL]]}
    assert loads(_level(solution=solution)).solution.steps == MAX_STEPS
    solution["actions"] *= 2
    with pytest.raises(LevelError, match=r"\$\.solution\.actions: expected at most 100000 steps"):
        loads(_level(solution=solution))
    assert Solution(physics="fast", frame_skip=1, actions=[(3, tuple(STILL))]).steps == 3


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "own" / "deep").mkdir(parents=True)
    save_level(Level(name="good", next_id=1), tmp_path / "own" / "good.json")
    (tmp_path / "own" / "bad.json").write_text(
        '{"env_state": {}, "env_params": {}, "static_env_params": "a"}'
    )
    os.mkfifo(tmp_path / "own" / "pipe.json")
    (tmp_path / "own" / "loop.json").symlink_to("loop.json")
    (tmp_path / "own" / "round").symlink_to(".")
    os.close(os.open(os.fsencode(tmp_path / "own") + b"/latin\xe9.json", os.O_CREAT))
    (tmp_path / "own" / ("n" * 246 + ".json")).write_text("{}")
    return tmp_path / "own"


def test_one_bad_file_hides_no_other(folder, capsys):
    assert main(["validate", str(folder), "--json"]) == 1
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert {row["file"].rsplit("/", 1)[1] for row in rows} >= {"good.json", "bad.json"}
    good = next(row for row in rows if row["file"].endswith("good.json"))
    assert good["format"] == "kinetix-level"


def test_the_gallery_shows_what_is_beside_a_bad_file(folder, tmp_path):
    from editor.gallery.library import Library

    library = Library(cache=tmp_path / "cache")
    library.look([folder])
    assert library.wait(20)
    library.stop()
    faults = {card.file.name: card.fault for card in library.cards}
    assert faults["good.json"] == ""
    assert "static_env_params: expected an object" in faults["bad.json"]
    assert "pipe.json" not in faults


def test_a_fault_of_ours_in_one_file_hides_no_other(folder, tmp_path, monkeypatch, capsys):
    from editor.gallery import card
    from editor.gallery.library import Library
    from kinetix.level.sets import problems

    def broken(level):
        raise ZeroDivisionError

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setattr(card, "validate", broken)
    monkeypatch.setattr(problems, "validate", broken)
    assert main(["validate", str(folder)]) == 1
    out = capsys.readouterr().out
    assert "good.json: error E001 $: kinetix validate: something went wrong" in out
    assert "bad.json: error" in out
    library = Library(cache=tmp_path / "cache")
    library.look([folder])
    assert library.wait(20)
    library.stop()
    faults = {card.file.name: card.fault for card in library.cards}
    assert "ZeroDivisionError" in faults["good.json"]
    assert "static_env_params" in faults["bad.json"]


def test_a_folder_without_levels_is_no_success(tmp_path, capsys):
    assert main(["validate", str(tmp_path)]) == 1
    assert "expected level files in this folder, found none" in capsys.readouterr().out


@pytest.mark.parametrize(
    "path", ["/etc/hostname.json", "../../x.json", "a/../../../x.json", "C:\\x.json", "..\\..\\x"]
)
def test_sets_reach_only_what_lies_beside_them(tmp_path, path):
    assert not within_reach(path)
    entry = {"path": path, "sha256": "0" * 64}
    tree = {"format": "kinetix-levelset", "version": 1, "name": "x", "levels": [entry]}
    (tmp_path / "set.json").write_text(json.dumps(tree))
    with pytest.raises(LevelError, match=r"\$\.levels\[0\]\.path: expected a path inside the fold"):
        load_set(tmp_path / "set.json")


def test_a_set_carries_levels_that_it_may_not_name(tmp_path):
    folder = tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    far, near = load_level("s/first_flight"), load_level("s/circus_act")
    save_level(far, tmp_path / "far.json")
    save_level(near, tmp_path / "a" / "near.json")
    made = build_set(gather_levels([tmp_path]), name="x", folder=folder)
    save_set(made, folder / "set.json")
    entries = json.loads((folder / "set.json").read_text())["levels"]
    assert {entry.get("path") for entry in entries} == {None, "../near.json"}
    assert {each.level for each in load_set(folder / "set.json").levels} == {far, near}


def test_names_that_no_file_can_have(tmp_path):
    for name in ("n" * 300, str(tmp_path / ("x" * 256))):
        with pytest.raises(LevelError, match="there is no such file"):
            load_level(name)
    with pytest.raises(LevelError, match=r"a\\u0000b: there is no such file"):
        load_level("a\0b")


def test_what_is_no_regular_file_is_said_and_never_left_out_in_silence(tmp_path):
    (tmp_path / "lost.json").symlink_to(tmp_path / "gone")
    (tmp_path / "self.json").symlink_to("self.json")
    os.mkfifo(tmp_path / "pipe.json")
    for name, text in (
        ("lost", "leads to no file"),
        ("self", "leads to no file"),
        ("pipe", "pipe"),
    ):
        with pytest.raises(LevelError, match=text):
            load_level(tmp_path / f"{name}.json")
    save_level(load_level("s/first_flight"), tmp_path / "good.json")
    with pytest.raises(LevelError, match=r"lost\.json: a link to .*, which leads to no file"):
        gather_levels([tmp_path])
