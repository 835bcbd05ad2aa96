"""The rules of the house that no tool of its own checks."""

import ast
import collections
import importlib
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from kinetix.level.codec import dumps, load_level
from kinetix.level.validate import validate
from kinetix.paths import levels_dir

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted(
    path for package in ("kinetix", "editor") for path in (ROOT / package).rglob("*.py")
)
FACADES = ("kinetix", "kinetix.engine", "kinetix.environment", "kinetix.render")
LEVELS = sorted(path for size in ("s", "m", "l") for path in (levels_dir() / size).glob("*.json"))


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_for_types(tree: ast.Module) -> dict[str, str]:
    """Names that a module imports under TYPE_CHECKING, with the modules that they come from."""
    return {
        alias.asname or alias.name: f"{node.module}"
        for block in tree.body
        if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


@pytest.mark.parametrize("facade", FACADES)
def test_facade_says_the_same_to_people_and_to_the_type_checker(facade):
    module = importlib.import_module(facade)
    names = imported_for_types(ast.parse(Path(str(module.__file__)).read_text()))
    # What the layers forbid to name as an import is exported by its string alone.
    by_string = {name for name, home in module._HOME.items() if facade not in home and "." in home}
    assert set(module.__all__) == set(module._HOME)
    assert set(names) <= set(module._HOME)
    assert set(module._HOME) - set(names) <= by_string


@pytest.mark.parametrize("facade", FACADES)
def test_every_name_of_a_facade_is_found_at_its_home(facade):
    module = importlib.import_module(facade)
    for name, home in module._HOME.items():
        full = home if home.startswith("kinetix.") else f"{facade}.{home}"
        assert getattr(module, name) is getattr(importlib.import_module(full), name)


def test_a_facade_lists_what_it_has_when_asked_for_something_else():
    import kinetix

    with pytest.raises(AttributeError, match=r"'xyzzy'.*it has ActionType, "):
        kinetix.xyzzy  # noqa: B018


def test_public_classes_are_defined_once():
    homes = collections.defaultdict(list)
    for path in SOURCES:
        if path.relative_to(ROOT).parts[0] != "kinetix":
            continue
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(module_name(path))
    assert {name: where for name, where in homes.items() if len(where) > 1} == {}


def test_nothing_public_is_defined_twice_in_a_module():
    twice = []
    for path in SOURCES:
        names = collections.Counter(
            node.name
            for node in ast.parse(path.read_text()).body
            if isinstance(node, ast.FunctionDef | ast.ClassDef)
        )
        twice += [f"{module_name(path)}.{name}" for name, count in names.items() if count > 1]
    assert twice == []


def test_questions_about_files_never_raise():
    """`Path.exists` and its like raise where a folder is locked or a drive is gone."""
    asked = re.compile(r"\.(exists|is_dir|is_file)\(\)")
    assert [module_name(path) for path in SOURCES if asked.search(path.read_text())] == []


def test_opening_and_saving_a_level_loads_no_jax(tmp_path):
    code = (
        "import sys, kinetix, kinetix.scenes; "
        f"level = kinetix.load_level({str(LEVELS[0])!r}); "
        f"kinetix.save_level(level, {str(tmp_path / 'copy.json')!r}); "
        "sys.exit(', '.join({'jax', 'flax', 'pygame', 'imgui_bundle'} & set(sys.modules)) or 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    assert (tmp_path / "copy.json").read_bytes() == LEVELS[0].read_bytes()


def test_levels_are_found():
    assert {path.parent.name for path in LEVELS} == {"s", "m", "l"}


@pytest.mark.parametrize("path", LEVELS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_bundled_levels_are_good(path):
    text = path.read_text()
    level = load_level(path)
    assert dumps(level) == text
    assert [issue.message for issue in validate(level)] == []
    assert level.size == path.parent.name
    assert level.description
    assert sum(tag.startswith("difficulty-") for tag in level.tags) == 1


def test_layers_hold():
    found = subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout + found.stderr


def test_every_package_is_in_a_layer():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    contracts = settings["tool"]["importlinter"]["contracts"]
    layers = next(one for one in contracts if one["name"] == "layers")["layers"]
    named = {name.strip() for layer in layers for name in layer.split("|")}
    there = {
        f"kinetix.{path.stem}"
        for path in (ROOT / "kinetix").iterdir()
        if (path / "__init__.py").exists() or path.suffix == ".py"
    }
    assert there - named == {"kinetix.__init__", "kinetix.__main__"}


def test_longest_files_and_functions_are_reported():
    # A habit, not a gate: only that the report works is tested.
    found = subprocess.run(
        [sys.executable, ROOT / "scripts" / "longest.py"],
        capture_output=True,
        text=True,
        check=True,
    )
    lines = found.stdout.splitlines()
    assert [line.split("(")[0].strip() for line in lines if line.startswith("longest")] == [
        "longest files",
        "longest functions",
    ]
    assert len(lines) == 22


@pytest.mark.slow
def test_recorded_solutions_win(capsys):
    from kinetix import cli

    status = cli.main(["levelset", "verify", str(levels_dir())])
    printed = capsys.readouterr()
    assert status == 0, printed.out + printed.err
