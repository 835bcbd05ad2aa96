"""Promises of version 1: its files open byte for byte the same for ever.

Golden files are never edited and never removed. Where a test here fails, the change is wrong, not
the file; a new version of a format gets files of its own beside these.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

import pytest

from kinetix.agents.card import read_card, write_card
from kinetix.level.codec import dumps, level_hash, load_document
from kinetix.level.sets import dumps_set, load_set

FIXTURES = Path(__file__).parent / "fixtures"
LEVELS = {
    "cart_and_bell": (
        "6ac948e5695874465cda24c359441d6ec61ff2eb28658c604199b1d68d967687",
        "daba25ce81800a550b30b8e4f36e587aadec7ca8fd7fb8d48d9620c155ad6001",
    ),
    "elbow_room": (
        "e654b9d203161bfe6e14a0cea52900e26a169ccc16775a7562d7cef51f0cb10f",
        "42928460e769d16109d0a3aeaa7d4ae571ac30fba10d8072d1b689ec88aa8532",
    ),
    "everything": (
        "dcd53c921f55e4df44fae365433c7925ff11e9c2c53c10946da935156e733ac8",
        "8bc5e4ebc4b462c3f5216ecad8fcbea1c20f292136e8ef8eee37649b5513007a",
    ),
    "rover_ridge": (
        "56e2823d5ad8db1f18211892d6112e3227582afa3817b93b62e7f1fd788a8cb8",
        "b74709e128abb911f54b424389a09cc4ec33b3e7ac6708c2168b17892b946afa",
    ),
    "smallest": (
        "3850a0f47425da963b9681f0603bf7afa28c74c13ae6f624261d2f6802dfa5e8",
        "d856dbadfe5a87908e064a013e3482978dae7c5165cd4b073bf106cf7816d909",
    ),
}
"""SHA-256 of each file, and the `level_hash` by which sets, results and agents know it."""
NAMED = {
    "lunch_run": (
        "4fa402d112a8049f568b2ed22acf62237f02307c95f5f4128961889b87073bbb",
        "4dd3d6d7990b2ead5bb0661f161ab9369b0a4990070599f3e5b1f46f9c05b29b",
    ),
}
"""The same for version 2, which has names of bodies, joints and thrusters."""
SET = "60160458ff05a5495d6f6fd617b8bd6d263972234e1ae64dd33388d653a8e689"
CARD = "d09443421f7a8669d2057f4c6a19d606b292353147321ebad2f15d6d04deed1a"


def _sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_no_golden_file_was_added_or_removed_in_silence():
    assert {path.stem for path in (FIXTURES / "v1").glob("*.json")} == set(LEVELS)
    assert {path.stem for path in (FIXTURES / "v2").glob("*.json")} == set(NAMED)


@pytest.mark.parametrize("name", LEVELS)
def test_a_level_of_version_1_opens_byte_for_byte_the_same(name):
    path = FIXTURES / "v1" / f"{name}.json"
    file, content = LEVELS[name]
    assert _sha256(path) == file
    loaded = load_document(path)
    assert (loaded.format, loaded.warnings) == ("kinetix-level", ())
    assert dumps(loaded.level) == path.read_text()
    assert level_hash(loaded.level) == content


@pytest.mark.parametrize("name", NAMED)
def test_a_level_of_version_2_opens_byte_for_byte_the_same(name):
    path = FIXTURES / "v2" / f"{name}.json"
    file, content = NAMED[name]
    assert _sha256(path) == file
    loaded = load_document(path)
    assert (loaded.format, loaded.warnings) == ("kinetix-level", ())
    assert dumps(loaded.level) == path.read_text()
    assert level_hash(loaded.level) == content
    assert level_hash(loaded.level.unnamed()) == content


def test_a_level_set_of_version_1_opens_byte_for_byte_the_same():
    path = FIXTURES / "v1_sets" / "inline.json"
    assert _sha256(path) == SET
    loaded = load_set(path)
    assert dumps_set(loaded, inline=True) == path.read_text()
    assert [(each.name, each.split) for each in loaded.levels] == [
        ("First flight", "train"),
        ("Circus act", "eval"),
    ]


def _said_before(now: Any, before: Any) -> Any:
    """What is left of a description without what later versions say in addition."""
    if not isinstance(before, dict):
        return now
    return {key: _said_before(now[key], value) for key, value in before.items()}


def test_a_description_of_an_agent_of_version_1_opens_the_same(tmp_path):
    path = Path(__file__).parents[1] / "agents" / "fixtures" / "v1" / "agent.json"
    assert _sha256(path) == CARD
    card, inventory = read_card(path)
    write_card(tmp_path / "agent.json", card, inventory)
    again = json.loads((tmp_path / "agent.json").read_text())
    before = json.loads(path.read_text())
    assert _said_before(again, before) == before
