"""Readers of levels and level sets, the JSON Schema beside them, and what is pasted."""

import dataclasses
import functools
import json
from pathlib import Path

import jsonschema

from kinetix.errors import LevelError
from kinetix.level.codec import dumps, level_hash, load_document, load_level, loads
from kinetix.level.json_schema import level_schema
from kinetix.level.kinetix_env.export import from_level
from kinetix.level.model import Level
from kinetix.level.sets import build_set, dumps_set, gather_levels, is_set_file, load_set
from kinetix.level.sizes import capacity_of
from kinetix.level.validate import validate
from kinetix.paths import levels_dir

FIXTURES = Path(__file__).parents[1] / "level" / "fixtures"


@functools.cache
def native_levels() -> tuple[bytes, ...]:
    """Levels with every feature, and some of the bundled ones."""
    files = [*sorted((FIXTURES / "v1").glob("*.json")), *sorted(levels_dir().glob("[sm]/*.json"))]
    return tuple(path.read_bytes() for path in files[:24])


@functools.cache
def kinetix_env_levels() -> tuple[bytes, ...]:
    """The same in kinetix-env's form, and files with gaps and the other forms of arrays."""
    own = [path.read_bytes() for path in sorted((FIXTURES / "kinetix_env").glob("*.json"))]
    made = [from_level(load_level(name))[0].encode() for name in ("s/first_flight", "s/goalkeeper")]
    return (*own, *made)


@functools.cache
def level_sets() -> tuple[bytes, ...]:
    """A set that carries its levels, and one that names files beside it."""
    levels = gather_levels([levels_dir() / "s"])[:3]
    inline = build_set(
        [dataclasses.replace(each, path=None) for each in levels], name="x", folder=Path("/")
    )
    entry = {"path": "a.json", "sha256": levels[0].sha256, "tags": [], "weight": 1.0}
    named = {"format": "kinetix-levelset", "version": 1, "name": "x", "size": "s"}
    return (
        dumps_set(inline, inline=True).encode(),
        json.dumps(named | {"levels": [entry | {"split": "train"}]}).encode(),
    )


def check_level(level: Level) -> None:
    """Check a level that a reader accepted."""
    text = dumps(level)
    assert loads(text) == level
    assert dumps(loads(text)) == text
    validate(level)
    level_hash(level)
    capacity_of(level)
    if level.solution is not None:
        assert sum(1 for _ in level.solution.unrolled()) == level.solution.steps <= 100_000


def read_level(data: bytes, folder: Path) -> None:
    path = folder / "x.json"
    path.write_bytes(data)
    loaded = load_document(path)
    check_level(loaded.level)
    if loaded.format == "kinetix-env":
        assert dumps(loaded.level, format="kinetix-env", source=loaded.source).encode() == data


SCHEMA_CANNOT_SAY = frozenset({"E003", "E008", "E009", "E010", "E011", "E012", "E013"})
"""Rules that tie several values together, or are about other versions."""
_NOR_THESE = ("$.tags", "$.solution.actions")


@functools.cache
def _schema() -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(level_schema())


def agree(data: bytes, folder: Path) -> None:
    """The JSON Schema, read by a program of others, says the same as our reader."""
    try:
        tree = json.loads(data.decode())  # from bytes it would take halves of surrogates
    except (ValueError, RecursionError):
        return
    if json.loads(data, object_pairs_hook=list) != json.loads(
        data, object_pairs_hook=lambda pairs: list(dict(pairs).items())
    ) or any(mark in data for mark in (b"NaN", b"Infinity")):
        return  # a key that stands twice, numbers that JSON does not have
    said = _schema().is_valid(tree)
    try:
        loads(data, "x")
    except LevelError as error:
        codes = {fault.code for fault in error.faults}
        beyond = codes <= SCHEMA_CANNOT_SAY or all(
            fault.code in SCHEMA_CANNOT_SAY
            or fault.path.startswith(_NOR_THESE)
            or "nested" in fault.message
            or "surrogate" in fault.message
            or "finite 32-bit" in fault.message
            or "digits" in fault.message
            or fault.message.startswith("expected a whole number")  # 1.0 is an integer to a schema
            for fault in error.faults
        )
        assert not said or beyond, f"only the schema accepts: {error}"
    else:
        assert said, "only the reader accepts"


def read_set(data: bytes, folder: Path) -> None:
    path = folder / "set.json"
    path.write_bytes(data)
    (folder / "a.json").write_bytes((levels_dir() / "s" / "circus_act.json").read_bytes())
    is_set_file(path)
    loaded = load_set(path)
    for each in loaded.levels:
        check_level(each.level)
        assert each.path is None or each.path.resolve().is_relative_to(folder.parent.resolve())
