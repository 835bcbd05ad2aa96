"""`kinetix validate`."""

import json
from pathlib import Path

from kinetix.cli import main
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import dumps

FIXTURES = Path(__file__).parents[1] / "level" / "fixtures"
CART = FIXTURES / "v1" / "cart_and_bell.json"
EMPTY = FIXTURES / "v1" / "smallest.json"


def lines(capsys):
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_a_good_level_of_either_format(capsys):
    peer = FIXTURES / "kinetix_env" / "cart_and_bell.json"
    assert main(["validate", str(CART), str(peer), "--json"]) == 0
    reports = lines(capsys)
    assert [report["format"] for report in reports] == ["kinetix-level", "kinetix-env"]
    assert reports[0] == {"file": str(CART), "ok": True, "format": "kinetix-level", "issues": []}


def test_errors_make_the_exit_status_one(capsys):
    assert main(["validate", str(CART), str(EMPTY), "--json"]) == 1
    report = lines(capsys)[1]
    assert not report["ok"]
    assert [issue["code"] for issue in report["issues"]] == ["E101", "E102", "W201"]
    assert report["issues"][0] == {
        "code": "E101",
        "severity": "error",
        "path": "$",
        "message": "No green shape: the level cannot be won.",
    }


def test_warnings_do_not(capsys):
    assert main(["validate", str(FIXTURES / "v1" / "everything.json")]) == 0
    assert "warning W209 $.joints[0]: Joint 4: anchor mismatch" in capsys.readouterr().out


def test_a_bad_file_is_reported_with_its_paths(tmp_path, capsys):
    bad = tmp_path / "bad.json"
    bad.write_text(CART.read_text().replace('"density": 0.5', '"density": -1').replace("256", "0"))
    assert main(["validate", str(bad), "--json"]) == 1
    report = lines(capsys)[0]
    assert report["format"] == "kinetix-level"
    assert [(issue["code"], issue["path"]) for issue in report["issues"]] == [
        ("E007", "$.max_timesteps"),
        ("E007", "$.bodies[0].density"),
    ]
    assert report["issues"][1]["message"] == "expected 0.001 ≤ x ≤ 1000, got -1"


def test_a_bad_file_is_told_the_format_that_it_says(tmp_path, capsys):
    texts = {
        "kinetix-env": '{"env_state": 1}',
        "kinetix-levelset": '{"format": "kinetix-levelset"}',
        None: '{"format": "other"}',
    }
    for number, text in enumerate(texts.values()):
        (tmp_path / f"{number}.json").write_text(text)
    (tmp_path / "3.json").write_text("{")
    assert main(["validate", str(tmp_path), "--json"]) == 1
    assert [report["format"] for report in lines(capsys)] == [*texts, None]


def test_a_missing_file_and_no_file(tmp_path, capsys):
    assert main(["validate", str(tmp_path / "none.json")]) == 1
    assert "there is no such file" in capsys.readouterr().out
    assert main(["validate"]) == 2


def test_a_set_without_levels_is_refused_as_by_the_other_commands(tmp_path, capsys):
    empty = tmp_path / "empty.json"
    tree = {"format": "kinetix-levelset", "version": 1, "name": "empty", "seed": 0}
    empty.write_text(json.dumps(tree | {"engine_version": "0.1.0", "levels": []}))
    assert main(["validate", str(empty)]) == 1
    assert "error E001 $.levels: Expected levels in this set" in capsys.readouterr().out
    assert main(["levelset", "split", str(empty), "--seed", "1"]) == 1
    assert "expected levels, found none" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["empty.json"]
    assert main(["levelset", "split", str(tmp_path / "none.json"), "--seed", "1"]) == 1
    assert "there is no such level set" in capsys.readouterr().err


def test_folders_and_sets(tmp_path, capsys):
    out = tmp_path / "set.json"
    assert main(["levelset", "build", str(out), "--levels", str(CART)]) == 0
    capsys.readouterr()
    assert main(["validate", str(tmp_path), "--json"]) == 0
    assert lines(capsys)[0]["format"] == "kinetix-levelset"


def test_a_folder_without_levels_is_an_error_also_beside_others(tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    assert main(["validate", str(CART), str(tmp_path / "empty"), "--json"]) == 1
    good, empty = lines(capsys)
    assert good["ok"] and not empty["ok"]
    assert "found none" in empty["issues"][0]["message"]


def peer_level(place):
    """A file of kinetix-env whose second slot for circles alone is filled, outside the arena."""
    builder = LevelBuilder("Far", gravity=(0.0, 0.0))
    builder.rectangle(1.0, 2.0, 0.4, 0.4, role="green")
    builder.circle(1.0, 3.0, 0.2, role="blue")
    builder.circle(9.0, 3.0, 0.2)
    tree = json.loads(dumps(builder.build(), format="kinetix-env"))
    tree["env_state"]["circle"][0]["active"] = False
    for corner in tree["env_state"]["polygon"][4]["vertices"].values():
        corner["0"] += 0.1
    place.write_text(json.dumps(tree))


def test_paths_are_those_of_the_file(tmp_path, capsys):
    peer_level(tmp_path / "far.json")
    main(["validate", str(tmp_path / "far.json"), "--json"])
    (report,) = lines(capsys)
    places = {issue["code"]: issue["path"] for issue in report["issues"]}
    assert places["W203"] == "$.env_state.circle[1].position"
    assert places["W210"] == "$.env_state.polygon[4].vertices"


def test_of_a_set_that_names_files_the_file_and_its_own_path_are_told(tmp_path, capsys):
    peer_level(tmp_path / "far.json")
    tree = json.loads((tmp_path / "far.json").read_text())
    tree["env_state"]["circle"][0]["active"] = True
    (tmp_path / "far.json").write_text(json.dumps(tree))
    out = tmp_path / "set.json"
    assert main(["levelset", "build", str(out), "--levels", str(tmp_path / "far.json")]) == 0
    capsys.readouterr()
    assert main(["validate", str(out), "--json"]) == 0
    (report,) = lines(capsys)
    found = {issue["code"]: issue for issue in report["issues"]}
    assert found["W203"]["path"] == found["W210"]["path"] == "$.levels[0].path"
    assert found["W203"]["message"].startswith("far.json: $.env_state.circle[1].position: ")
