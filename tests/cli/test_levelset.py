"""`kinetix levelset`; the playing of `verify` stands in for itself here."""

import json
import os
import sys
import types
from pathlib import Path

import pytest

from kinetix.cli import main
from kinetix.errors import KinetixError
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import dumps, load_level, save_level
from kinetix.level.sets import load_set

CART = Path(__file__).parents[1] / "level" / "fixtures" / "v1" / "cart_and_bell.json"


@pytest.fixture
def folder(tmp_path):
    cart = load_level(CART)
    for k in range(5):
        save_level(cart.replace(max_timesteps=100 + k), tmp_path / f"c{k}.json")
    return tmp_path


def test_build_and_split(folder, capsys):
    out = folder / "set.json"
    save_level(load_level(folder / "c0.json").replace(name="double"), folder / "d.json")
    assert main(["levelset", "build", str(out), "--levels", str(folder), "--seed", "4"]) == 0
    assert (
        "5 levels, 4 train, 1 eval, 1 left out because they equal others" in capsys.readouterr().out
    )
    before = [each.split for each in load_set(out).levels]
    assert main(["levelset", "split", str(out), "--seed", "1", "--split", "0.4"]) == 0
    after = [each.split for each in load_set(out).levels]
    assert after.count("train") == 2
    assert before.count("train") == 4
    assert load_set(out).manifest.seed == 1


def test_errors_name_the_places_of_kinetix_env_files(tmp_path, capsys):
    """The blue circle is the file's second, as the slot of the first is empty."""
    builder = LevelBuilder("Won")
    builder.rectangle(1.0, 2.0, 0.4, 0.4, role="green")
    builder.circle(4.0, 3.0, 0.2)
    builder.circle(1.0, 2.3, 0.2, role="blue")
    tree = json.loads(dumps(builder.build(), format="kinetix-env"))
    tree["env_state"]["circle"][0]["active"] = False
    (tmp_path / "won.json").write_text(json.dumps(tree))
    place = "$.env_state.circle[1]: "
    assert main(["levelset", "build", str(tmp_path / "set.json"), "--levels", str(tmp_path)]) == 1
    assert f"won.json: {place}E104" in capsys.readouterr().err
    assert main(["levelset", "verify", str(tmp_path)]) == 1
    assert f"E104 {place}" in capsys.readouterr().out
    assert main(["solve", str(tmp_path / "won.json")]) == 1
    assert f"won.json: {place}Green already touches blue" in capsys.readouterr().err


def test_where_the_levels_of_a_set_are_is_told_as_it_is(folder, tmp_path_factory, capsys):
    def told(out, *more):
        assert main(["levelset", "build", str(out), "--levels", str(folder), *more]) == 0
        return capsys.readouterr().out

    assert "names the levels by their paths" in told(folder / "set.json")
    assert "The levels themselves are in the file" in told(folder / "inline.json", "--inline")
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "far" / "away"
    elsewhere.mkdir(parents=True)
    assert "The levels themselves are in the file" in told(elsewhere / "set.json")
    save_level(load_level(folder / "c0.json").replace(max_timesteps=300), elsewhere / "own.json")
    mixed = told(elsewhere / "mixed.json", str(elsewhere / "own.json"))
    assert "names 1 level by path and holds 5 that are out of its reach" in mixed


def test_a_set_is_built_in_a_new_folder_and_a_bundled_one_stays(folder, capsys):
    out = folder / "new" / "deep" / "set.json"
    assert main(["levelset", "build", str(out), "--levels", str(folder), "--inline"]) == 0
    assert len(load_set(out).levels) == 5
    capsys.readouterr()
    assert main(["levelset", "split", "sets/s", "--seed", "9"]) == 1
    assert "sets/s: is bundled, and stays as it is" in capsys.readouterr().err


def test_a_level_that_changed_is_named(folder, capsys):
    out = folder / "set.json"
    assert main(["levelset", "build", str(out), "--levels", str(folder)]) == 0
    save_level(load_level(folder / "c1.json").replace(max_timesteps=77), folder / "c1.json")
    assert main(["levelset", "verify", str(out)]) == 1
    told = capsys.readouterr()
    assert "c1.json has changed since the set was built; build the set again" in told.err


def test_an_inline_set_stands_alone(folder, tmp_path_factory, capsys):
    out = tmp_path_factory.mktemp("elsewhere") / "set.json"
    assert main(["levelset", "build", str(out), "--levels", str(folder)]) == 0
    assert "--inline puts them into the file" in capsys.readouterr().out
    assert main(["levelset", "build", str(out), "--levels", str(folder), "--inline"]) == 0
    assert "--inline" not in capsys.readouterr().out
    for path in folder.glob("*.json"):
        path.unlink()
    assert len(load_set(out).levels) == 5
    assert main(["levelset", "split", str(out), "--seed", "7"]) == 0
    assert len(load_set(out).levels) == 5


@pytest.fixture
def outcomes(monkeypatch):
    """Replaces the simulator: outcome by the level's time limit, for its solution and the no-op."""
    table = {}

    module = types.ModuleType("kinetix.environment.replay")
    module.replay_solution = lambda level: table.get((level.max_timesteps, True), "won")
    module.noop_outcome = lambda level, physics: table.get((level.max_timesteps, False), "timeout")
    monkeypatch.setitem(sys.modules, "kinetix.environment.replay", module)
    return table


def verdicts(capsys):
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_verify_passes_what_its_solution_wins(folder, outcomes, capsys):
    assert main(["levelset", "verify", str(folder), "--json"]) == 0
    found = verdicts(capsys)
    assert [verdict["level"] for verdict in found] == [f"c{k}" for k in range(5)]
    assert all(verdict["ok"] and verdict["solution"] == "won" for verdict in found)


def test_verify_tells_why_a_level_fails(folder, outcomes, capsys):
    outcomes[(100, False)] = "won"
    outcomes[(101, True)] = "lost"
    level = load_level(folder / "c2.json")
    save_level(level.replace(solution=None), folder / "c2.json")
    save_level(
        load_level(folder / "c3.json").replace(solution=None, tags=("unsolved",)),
        folder / "c3.json",
    )
    none_green = tuple(body.replace(role="none") for body in level.bodies)
    save_level(level.replace(bodies=none_green, solution=None), folder / "c4.json")
    assert main(["levelset", "verify", str(folder), "--json"]) == 1
    found = verdicts(capsys)
    assert [verdict["ok"] for verdict in found] == [False, False, False, True, False]
    assert found[0]["problems"] == ["doing nothing wins it"]
    assert found[1]["problems"] == ["its recorded solution ends with lost"]
    assert found[2]["problems"] == ["it has no recorded solution"]
    assert found[3]["problems"] == ["it has no recorded solution"]
    assert found[4]["problems"][0].startswith("E101")
    assert found[4]["noop"] is None


def test_damaged_files_do_not_keep_the_others_from_being_verified(folder, outcomes, capsys):
    (folder / "c1.json").write_text("{")
    (folder / "c3.json").write_text('{"format": "kinetix-level"}')
    assert main(["levelset", "verify", str(folder), "--json"]) == 1
    found = {Path(each["level"]).stem: each for each in verdicts(capsys)}
    assert [name for name in sorted(found) if not found[name]["ok"]] == ["c1", "c3"]
    assert found["c1"]["problems"][0].startswith("E001") and found["c1"]["noop"] is None
    # Commands that need every level name all that cannot be read.
    assert main(["levelset", "build", str(folder / "set.json"), "--levels", str(folder)]) != 0
    told = capsys.readouterr().err
    assert "2 of 5 files cannot be read" in told
    assert "c1.json" in told and "c3.json" in told


def test_verify_in_words(folder, outcomes, capsys):
    outcomes[(104, True)] = "timeout"
    assert main(["levelset", "verify", str(folder)]) == 1
    text = capsys.readouterr().out
    assert "c0: ok" in text
    assert "c4: FAILED: its recorded solution ends with timeout" in text


def test_a_format_that_records_no_solution_is_not_to_blame(tmp_path, outcomes, capsys):
    cart = load_level(CART).replace(solution=None)
    save_level(cart, tmp_path / "theirs.json", format="kinetix-env")
    assert main(["levelset", "verify", str(tmp_path)]) == 0
    assert "theirs: ok, its format records no solution" in capsys.readouterr().out
    save_level(cart, tmp_path / "ours.json")
    assert main(["levelset", "verify", str(tmp_path)]) == 1
    assert "ours: FAILED: it has no recorded solution" in capsys.readouterr().out


def test_wrong_usage(capsys):
    assert main(["levelset"]) == 2
    assert main(["levelset", "split", "set.json"]) == 2
    capsys.readouterr()


def test_a_set_does_not_take_the_place_of_a_level(tmp_path, capsys):
    level = tmp_path / "a.json"
    save_level(load_level("s/first_flight"), level)
    before = level.read_bytes()
    assert main(["levelset", "build", str(level), "--levels", str(level)]) == 1
    assert "there is a file that is no level set" in capsys.readouterr().err
    assert level.read_bytes() == before
    made = str(tmp_path / "set.json")
    for _ in range(2):  # a set takes the place of a set
        assert main(["levelset", "build", made, "--levels", str(level)]) == 0


def test_no_set_is_lost_to_the_second_command_after_it(folder):
    target = folder / "set.json"
    assert main(["levelset", "build", str(target), "--levels", str(folder), "--inline"]) == 0
    first = target.read_bytes()
    assert main(["levelset", "build", str(target), "--levels", "s/first_flight"]) == 0
    assert main(["levelset", "split", str(target), "--seed", "4", "--split", "0"]) == 0
    kept = [path.read_bytes() for path in folder.glob("set.json.bak*")]
    assert first in kept


def test_weights_set_by_hand_are_kept_beside_a_set_that_is_built_anew(folder, capsys):
    made = folder / "set.json"
    assert main(["levelset", "build", str(made), "--levels", str(folder)]) == 0
    assert main(["levelset", "build", str(made), "--levels", str(folder)]) == 0
    assert ".bak" not in capsys.readouterr().err
    by_hand = made.read_text().replace('"split"', '"weight": 7.0, "split"', 1)
    made.write_text(by_hand)
    assert main(["levelset", "build", str(made), "--levels", str(folder)]) == 0
    assert "set.json.bak" in capsys.readouterr().err
    assert (folder / "set.json.bak").read_text() == by_hand


@pytest.mark.parametrize("word", ["mine", "sets/s"])
def test_a_set_is_split_where_it_lies(folder, monkeypatch, word):
    monkeypatch.chdir(folder)
    assert main(["levelset", "build", f"{word}.json", "--levels", "."]) == 0
    assert main(["levelset", "split", word, "--seed", "4", "--split", "0"]) == 0
    assert not (folder / word).exists()
    assert {each.split for each in load_set(folder / f"{word}.json").levels} == {"eval"}


def test_a_split_leaves_paths_through_links_as_they_are(folder, tmp_path_factory):
    (folder / "sets").mkdir()
    (folder / "levels").mkdir()
    for path in folder.glob("c*.json"):
        path.rename(folder / "levels" / path.name)
    made = folder / "sets" / "a.json"
    assert main(["levelset", "build", str(made), "--levels", str(folder / "levels")]) == 0
    paths = [entry.path for entry in load_set(made).manifest.levels]
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "levels"
    (folder / "levels").rename(elsewhere)
    (folder / "levels").symlink_to(elsewhere)
    assert main(["levelset", "split", str(made), "--seed", "3"]) == 0
    assert [entry.path for entry in load_set(made).manifest.levels] == paths


def test_the_name_of_a_set_is_as_long_as_it_may_be(folder):
    out = folder / f"{'x' * 200}.json"
    assert main(["levelset", "build", str(out), "--levels", str(folder), "--inline"]) == 0
    assert load_set(out).manifest.name == "x" * 120


@pytest.mark.skipif(os.name != "posix", reason="names of files are text elsewhere")
def test_files_with_names_that_are_no_text(folder, capsys):
    odd = os.fsdecode(os.fsencode(folder) + b"/caf\xe9")
    (folder / "c0.json").rename(f"{odd}.json")
    assert main(["levelset", "build", f"{odd}-set.json", "--levels", str(folder)]) == 0
    assert load_set(f"{odd}-set.json").manifest.name == "caf?-set"


def test_a_solution_that_cannot_be_played_is_a_problem_of_its_level(folder, outcomes, capsys):
    replay = sys.modules["kinetix.environment.replay"]
    played = replay.noop_outcome

    def noop_outcome(level, physics):
        if physics == "warped":
            raise KinetixError("physics 'warped': expected one of balanced")
        return played(level, physics)

    replay.noop_outcome = noop_outcome
    level = load_level(folder / "c1.json")
    warped = level.solution.replace(physics="warped")
    save_level(level.replace(solution=warped), folder / "c1.json")
    assert main(["levelset", "verify", str(folder), "--json"]) == 1
    found = verdicts(capsys)
    assert [verdict["ok"] for verdict in found] == [True, False, True, True, True]
    assert found[1]["problems"] == [
        "it cannot be played: physics 'warped': expected one of balanced"
    ]


def test_what_an_inline_level_does_not_carry_of_its_file_is_told(folder, capsys):
    text = dumps(load_level(folder / "c0.json"), format="kinetix-env")
    tree = json.loads(text)
    row = next(k for k, each in enumerate(tree["env_state"]["polygon"]) if k > 3 and each["active"])
    tree["env_state"]["polygon"][row]["highlighted"] = True
    peer, out = folder / "peer.json", folder / "set.json"
    peer.write_text(json.dumps(tree))
    build = ["levelset", "build", str(out), "--levels", str(peer)]
    assert main(build) == 0
    assert "not carried" not in capsys.readouterr().err
    assert main([*build, "--inline"]) == 0
    assert f"{peer}: put into the set; not carried: highlights" in capsys.readouterr().err
