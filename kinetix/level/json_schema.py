"""The formats as JSON Schema (draft 2020-12), for editors and other programs, from the model.

A schema restricts single values. References between ids, convexity and centres of mass are the
reader's to check (`kinetix validate`).
"""

from typing import Any, Final

import msgspec

from kinetix.level.canonical import FORMAT, VERSION
from kinetix.level.codec import LEVELSET_FORMAT
from kinetix.level.model import Level, Limits, Motor, Record
from kinetix.level.schema import REQUIRED
from kinetix.level.sets import VERSION as SET_VERSION
from kinetix.level.sets import LevelSet

_DRAFT: Final = "https://json-schema.org/draft/2020-12/schema"


def level_schema() -> dict[str, Any]:
    """Return the schema of a level file."""
    return _schema(Level, FORMAT, VERSION)


def level_set_schema() -> dict[str, Any]:
    """Return the schema of a level set; each of its levels stands in it or is named by its path."""
    schema = _schema(LevelSet, LEVELSET_FORMAT, SET_VERSION)
    level = _schema(Level, FORMAT, VERSION)
    entry = schema["$defs"]["SetEntry"]
    entry["properties"]["level"] = {"$ref": "#/$defs/Level"}
    entry["oneOf"] = [{"required": ["path"]}, {"required": ["level"]}]
    schema["$defs"] |= level["$defs"]
    return schema


def _schema(root: type[Record], name: str, version: int) -> dict[str, Any]:
    (top,), parts = msgspec.json.schema_components([root], ref_template="#/$defs/{name}")
    for cls in (Level, Motor, Limits):
        if cls.__name__ in parts:
            required = parts[cls.__name__].setdefault("required", [])
            required += sorted(REQUIRED[cls] - set(required))
    frame = parts[root.__name__]
    frame["properties"] = {
        "format": {"const": name},
        "version": {"type": "integer", "minimum": 1, "maximum": version},
    } | frame["properties"]
    frame["required"] = ["format", "version", *frame["required"]]
    for part in parts.values():
        _leave_out_absent(part)
    return {"$schema": _DRAFT, "title": name, **top, "$defs": parts}


def _leave_out_absent(part: dict[str, Any]) -> None:
    """Keys that a file leaves out instead of saying null; defaults that repeat the parts' own."""
    for name, value in part.get("properties", {}).items():
        if isinstance(value.get("default"), dict):
            del value["default"]
        # Motor and limits of a joint are the only keys that stand there as null.
        if "anyOf" in value and name not in ("motor", "limits"):
            value["anyOf"] = [kind for kind in value["anyOf"] if kind != {"type": "null"}]
            value.pop("default", None)
