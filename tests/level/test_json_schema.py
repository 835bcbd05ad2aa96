"""The JSON Schemas: they accept what is good, and refuse what the reader refuses."""

import json
from pathlib import Path

import jsonschema
import pytest

from kinetix.level.canonical import level_tree
from kinetix.level.codec import load_level
from kinetix.level.json_schema import level_schema, level_set_schema
from kinetix.paths import levels_dir

FIXTURES = Path(__file__).parent / "fixtures" / "v1"
FILES = sorted([*levels_dir().glob("[sml]/*.json"), *FIXTURES.glob("*.json")])


@pytest.fixture(scope="module")
def level_validator():
    jsonschema.Draft202012Validator.check_schema(level_schema())
    return jsonschema.Draft202012Validator(level_schema())


def test_every_level_of_ours_is_accepted(level_validator):
    for path in FILES:
        tree = json.loads(path.read_text())
        assert [error.message for error in level_validator.iter_errors(tree)] == []


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("colour",), "green"),
        (("next_id",), 0),
        (("version",), 3),
        (("bodies", 0, "friction"), -1.0),
        (("bodies", 0, "name"), ""),
        (("bodies", 0, "name"), None),
        (("bodies", 0, "role"), "yellow"),
        (("bodies", 0, "shape", "kind"), "star"),
        (("bodies", 0, "mass_properties"), None),
        (("gravity",), [0.0]),
        (("size",), "xl"),
    ],
    ids=lambda value: ".".join(map(str, value)) if isinstance(value, tuple) else str(value),
)
def test_faults_are_refused(level_validator, place, value):
    tree = json.loads(json.dumps(level_tree(load_level("m/elbow_room"))))
    inner = tree
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    assert list(level_validator.iter_errors(tree))


@pytest.mark.parametrize("key", ["name", "next_id", "format", "version"])
def test_keys_without_a_default_must_be_there(level_validator, key):
    tree = level_tree(load_level("m/elbow_room"))
    del tree[key]
    assert list(level_validator.iter_errors(tree))


def test_an_entry_of_a_set_has_a_path_or_a_level():
    validator = jsonschema.Draft202012Validator(level_set_schema())
    entry = {"sha256": "0" * 64, "tags": [], "weight": 1.0, "split": "train"}
    level = level_tree(load_level("s/goalkeeper"))
    tree = {"format": "kinetix-levelset", "version": 1, "name": "two"}
    good = [entry | {"path": "a.json"}, entry | {"level": level}]
    assert list(validator.iter_errors(tree | {"levels": good})) == []
    for bad in (entry, entry | {"path": "a.json", "level": level}):
        assert list(validator.iter_errors(tree | {"levels": [bad]}))
