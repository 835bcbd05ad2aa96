"""Write the generated parts of the documents: format tables, JSON Schemas, catalogue of levels.

`python -m scripts.reference_docs` writes; a test compares what it would write with what is there.
"""

import itertools
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from kinetix.compat.names import MODULES, Place
from kinetix.environment.observations.features import Layout
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.files.limits import CHECKPOINT_FILES, DEPTH, LIMITS, MEMBERS, MIB
from kinetix.level.codec import level_hash, load_level
from kinetix.level.json_schema import level_schema, level_set_schema
from kinetix.level.model import MAX_ENTITIES, MAX_STEPS, Level
from kinetix.level.sets import MAX_LEVELS, level_files
from kinetix.paths import levels_dir
from scripts.library.grades import Played, read_played

DOCS: Final = Path(__file__).resolve().parents[1] / "docs"
BEGIN, END = "<!-- generated: {} -->", "<!-- end of generated -->"


def format_tables() -> str:
    """Return one table for each kind of object in a level file."""
    parts = level_set_schema()["$defs"]
    order = ["Level", "Arena", "ArenaBody", "Geometry", "Body", "Circle", "Polygon"]
    order += ["MassProperties", "Joint", "Motor", "Limits", "Thruster", "Solution", "SizeHint"]
    order += ["LevelSet", "SetEntry"]
    return "\n".join(_table(name, parts[name]) for name in order)


def names_of_kinetix_env() -> str:
    """Return the modules and names of kinetix-env, and where each lives here."""
    rows = ["| there | here |", "| --- | --- |"]
    for module, names in MODULES.items():
        for home, group in itertools.groupby(names.items(), key=lambda item: _place(*item, module)):
            listed = ", ".join(f"`{name}`" for name, _ in group)
            rows.append(f"| `{module}`: {listed} | {home} |")
    return "\n".join([*rows, ""])


def _place(name: str, place: Place, module: str) -> str:
    if not place.home:
        return f"no; {place.instead}"
    where = "the same" if place.home == module or ".compat" in place.home else f"`{place.home}`"
    if place.name != name and ".compat" not in place.home:
        where = f"`{place.home}.{place.name}`"
    return f"works, and warns; better: {place.instead}" if place.old else where


def observation_columns() -> str:
    """Return one table for each kind of row that an agent sees."""
    layout = Layout.of(EnvParams(), StaticEnvParams())
    kinds = {
        "A circle": layout.circle,
        "A polygon": layout.polygon,
        "A joint, seen from one of its bodies": layout.joint,
        "A thruster": layout.thruster,
    }
    rows: list[str] = []
    for title, features in kinds.items():
        rows += [f"### {title}: {len(features)} numbers", ""]
        rows += ["| | name | unit | meaning |", "| --- | --- | --- | --- |"]
        rows += [
            f"| {index} | `{feature.name}` | {feature.unit} | {feature.meaning} |"
            for index, feature in enumerate(features)
        ]
        rows.append("")
    return "\n".join(rows)


def _table(name: str, part: dict[str, Any]) -> str:
    rows = [f"### {name}", "", part.get("description", "").split("\n")[0], ""]
    rows += ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
    for key, value in part["properties"].items():
        default = "–" if key in part.get("required", ()) else _default(value)
        rows.append(f"| `{key}` | {_kind(value)} | {default} | {_meaning(value)} |")
    return "\n".join([*rows, ""])


def _default(value: dict[str, Any]) -> str:
    if "default" not in value:
        # The arena's parts have defaults inside; the rest is absent where there is nothing to say.
        return "standard" if value.get("$ref", "").startswith("#/$defs/Arena") else "left out"
    return f"`{json.dumps(value['default'], ensure_ascii=False)}`"


def _meaning(value: dict[str, Any]) -> str:
    shown = next(
        (each for each in (value, *value.get("prefixItems", ())) if "description" in each), {}
    )
    unit = f" [{shown['x-unit']}]" if "x-unit" in shown else ""
    return shown.get("description", "") + unit


def _kind(value: dict[str, Any]) -> str:
    """Return a value's type and limits in words."""
    if "$ref" in value:
        name = value["$ref"].rsplit("/", 1)[1]
        return f"[{name}](#{name.lower()})"
    if "anyOf" in value:
        return " or ".join(dict.fromkeys(_kind(each) for each in value["anyOf"]))
    if "const" in value:
        return f"`{json.dumps(value['const'])}`"
    if "enum" in value:
        return ", ".join(f"`{json.dumps(each)}`" for each in value["enum"])
    if "prefixItems" in value:
        items = [_kind(item) for item in value["prefixItems"]]
        if len(set(items)) == 1:
            items = [f"{len(items)} × {items[0]}"]
        return f"[{', '.join(items)}]"
    if value.get("type") == "array":
        return f"list of {_kind(value['items'])}"
    words = {"number": "real", "integer": "whole", "boolean": "true/false", "string": "text"}
    return words.get(value["type"], value["type"]) + _limits(value)


def _limits(value: dict[str, Any]) -> str:
    low, high = value.get("minimum"), value.get("maximum")
    if high is not None and abs(high) >= 2**53:
        high = None
    if low is not None and high is not None:
        return f" {low:g} … {high:g}"
    return f" ≥ {low:g}" if low is not None else ""


def catalogue() -> str:
    """Return the bundled levels with their pictures, by size."""
    return "\n".join(
        "\n".join([f"## Size {size}", "", *_rows(size), ""]) for size in ("s", "m", "l")
    )


def _rows(size: str) -> Iterator[str]:
    played = read_played()
    yield f"| | level | what to do | difficulty | {' · '.join(_players())} | proof |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for path in level_files(levels_dir() / size):
        level, name = load_level(path), f"{size}/{path.stem}"
        picture = f'![{level.name}](pictures/levels/{name}.png){{ width="90" }}'
        yield (
            f"| {picture} | **{level.name}**<br>`{name}` | {level.description} | "
            f"{_difficulty(level)} | {_rates(level, played.get(name))} | {_proof(level)} |"
        )


def _rates(level: Level, played: Played | None) -> str:
    """Rates at which players win a level; a dash where one cannot play it or was not measured."""
    current = played is not None and played.level == level_hash(level)
    rates = played.rates if played is not None and current else {}
    return " · ".join(f"{rates[player]:.2f}" if player in rates else "–" for player in _players())


def _players() -> list[str]:
    """Players that were measured, the best first."""
    measured = {player for each in read_played().values() for player in each.rates}
    return [player for player in ("planner", "general", "random") if player in measured]


def _difficulty(level: Level) -> str:
    words = ("trivial", "easy", "medium", "demanding", "hard")
    tag = next(tag for tag in level.tags if tag.startswith("difficulty-"))
    return words[int(tag.removeprefix("difficulty-")) - 1]


def _proof(level: Level) -> str:
    if level.solution is None:
        return "not solved yet"
    steps = sum(repeat for repeat, _ in level.solution.actions)
    return f"{steps} steps, `{level.solution.physics}`"


def limits() -> str:
    """Return the table of limits of files."""
    rows = ["| file | largest | usual |", "| --- | --- | --- |"]
    rows += [f"| {one.what} | {_size(one.largest)} | {one.why} |" for one in LIMITS.values()]
    more = (
        ("depth of arrays and objects in JSON", DEPTH),
        ("arrays in an episode", MEMBERS),
        ("files in the folder of an agent", CHECKPOINT_FILES),
        ("bodies, joints, thrusters of a level, each", MAX_ENTITIES),
        ("levels of a set", MAX_LEVELS),
        ("steps of an episode and of a recorded solution", MAX_STEPS),
    )
    rows += ["", "| count | most |", "| --- | --- |"]
    rows += [f"| {what} | {most} |" for what, most in more]
    return "\n".join([*rows, ""])


def _size(largest: int) -> str:
    return f"{largest // MIB} MiB" if largest < 1024 * MIB else f"{largest // (1024 * MIB)} GiB"


def documents() -> dict[Path, str]:
    """Return every file that has generated parts, as it should be."""
    made = {
        DOCS / "schemas" / "kinetix-level.schema.json": _json(level_schema()),
        DOCS / "schemas" / "kinetix-levelset.schema.json": _json(level_set_schema()),
    }
    parts = (
        ("environment", "environment", observation_columns()),
        ("level_format", "level_format", format_tables()),
        ("levels", "levels", catalogue()),
        ("migrating", "migrating", names_of_kinetix_env()),
        ("security", "limits", limits()),
    )
    for document, name, text in parts:
        path = DOCS / f"{document}.md"
        made[path] = _with_part(path.read_text(encoding="utf-8"), name, text)
    return made


def _json(tree: Any) -> str:
    return json.dumps(tree, indent=2, ensure_ascii=False) + "\n"


def _with_part(document: str, name: str, text: str) -> str:
    before, _, rest = document.partition(BEGIN.format(name))
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN.format(name)}\n\n{text}\n{END}{after}"


def main() -> None:
    """Write what has changed."""
    for path, text in documents().items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        sys.stdout.write(f"{path}\n")


if __name__ == "__main__":
    main()
