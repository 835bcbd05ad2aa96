"""The documents: what they print runs, what is generated is up to date, the site stands alone."""

import dataclasses
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import kinetix
from kinetix import EnvParams, StaticEnvParams, UEDParams, cli
from kinetix.environment.replay import noop_outcome, play_actions
from kinetix.level.validate import validate
from kinetix.training.config import PpoConfig

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = sorted((ROOT / "docs").glob("*.md"))


def blocks(document, language):
    return re.findall(
        rf"^```{language}\n(.*?)^```$", document.read_text(), re.MULTILINE | re.DOTALL
    )


def commands():
    """Every kinetix command, lines that end with a backslash joined."""
    for document in (ROOT / "README.md", *DOCUMENTS):
        for block in blocks(document, "sh"):
            for line in block.replace("\\\n", " ").splitlines():
                if line.startswith("kinetix "):
                    yield pytest.param(line, id=f"{document.stem}: {line.split('#')[0].strip()}")


@pytest.mark.slow
@pytest.mark.parametrize(
    "document", [d for d in DOCUMENTS if blocks(d, "python")], ids=lambda path: path.stem
)
def test_the_snippets_run_in_order(document, tmp_path, monkeypatch):
    shutil.copytree(ROOT / "checkpoints", tmp_path / "checkpoints")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "snippet"}
    for block in blocks(document, "python"):
        exec(compile(block, document.name, "exec"), names)


@pytest.mark.slow
def test_the_small_level_is_won_as_its_description_says(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(blocks(ROOT / "docs" / "level_format.md", "python")[0], names)
    level = names["level"]
    assert level.description.startswith("Hold 1 ") and validate(level) == ()
    held = [(0, 0, 0, 0, 1, 0)] * level.max_timesteps
    assert play_actions(level, held).outcome == "won"
    assert noop_outcome(level) != "won"


@pytest.mark.parametrize("line", list(commands()))
def test_the_commands_are_understood(line, monkeypatch):
    words = shlex.split(line, comments=True)[1:]
    assert not any("|" in word for word in words), "a shell takes | for a pipe"
    seen = []
    monkeypatch.setattr(f"kinetix.cli.{words[0]}.run", lambda command: seen.append(command) or 0)
    assert cli.main(words) == 0
    assert len(seen) == 1


def test_every_page_is_in_the_menu_of_the_site():
    menu = re.findall(r"(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    pages = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert pages - set(menu) == set()


def test_configurations_can_be_read():
    found = [block for document in DOCUMENTS for block in blocks(document, "toml")]
    assert found and all(tomllib.loads(block) for block in found)


def test_the_files_and_names_of_the_architecture_exist():
    text = (ROOT / "ARCHITECTURE.md").read_text()
    paths = set(re.findall(r"\b((?:kinetix|editor)(?:/\w+)+(?:\.py|\.md)?)", text))
    assert len(paths) > 40
    assert [path for path in sorted(paths) if not (ROOT / path).exists()] == []
    # `file` (`name`, `Class.method` …): the file defines them.
    named = re.findall(r"`([\w/]+\.py)`\s+\(`([^)`]+)`(?:, `([^)`]+)`)*\)", text)
    assert len(named) > 10
    missing = []
    for path, *names in named:
        source = (ROOT / path).read_text()
        for part in ".".join(filter(None, names)).split("."):
            if not re.search(rf"^ *(?:def|class) {part}\b", source, re.MULTILINE):
                missing.append(f"{path}: {part}")
    assert missing == []


def test_generated_parts_are_up_to_date():
    from scripts.reference_docs import documents

    stale = [path.name for path, text in documents().items() if path.read_text() != text]
    assert stale == [], "run `make levels`"


def test_a_tuple_of_unlike_items_is_told_item_by_item():
    from scripts.reference_docs import format_tables

    tables = format_tables()
    assert "| list of [whole 1 … 100000, [6 × whole 0 … 2]] |" in tables
    assert "| `gravity` | [2 × real -100 … 100] |" in tables


def test_the_page_on_accuracy_names_every_scene_that_is_not_good():
    measured = ROOT / "bench" / "accuracy"
    rows = {
        physics: list(map(json.loads, (measured / f"{physics}.jsonl").read_text().splitlines()))
        for physics in ("fast", "balanced", "accurate")
    }
    bad = {
        (physics, row["scene"])
        for physics, of in rows.items()
        for row in of
        if row["verdict"] in ("ok", "fail")
    }
    text = (ROOT / "docs/accuracy.md").read_text()
    told = text.partition("What is not\ngood, and why:")[2].partition("<!-- results -->")[0]
    named = set()
    for who, which in re.findall(r"^\| ([^|]*) \| ([A-Z]\d[^|]*) \|", told, re.MULTILINE):
        players = rows if who == "all three" else re.findall(r"`(\w+)`", who)
        named |= {(physics, scene) for physics in players for scene in which.split(", ")}
    assert named == bad


def test_the_reference_has_the_public_names():
    sections = dict(
        re.findall(r"^## (.*?)$(.*?)(?=^## |\Z)", (ROOT / "docs/api.md").read_text(), re.M | re.S)
    )
    of_kinetix = ("Names", "Parameters", "Kinds of action and observation", "Errors")
    listed = {
        place for title in of_kinetix for place in re.findall(r"^::: (\S+)$", sections[title], re.M)
    }
    homes = {f"{home}.{name}": home for name, home in kinetix._HOME.items()}
    homes.pop("kinetix.version.__version__")
    assert sorted(place for place, home in homes.items() if not {place, home} & listed) == []
    assert sorted(listed - set(homes) - set(homes.values())) == []


def test_every_level_has_its_thumbnail():
    from kinetix.level.sets import level_files
    from kinetix.paths import levels_dir

    pictures = ROOT / "docs" / "pictures" / "levels"
    levels = {path.relative_to(levels_dir()).with_suffix("") for path in level_files(levels_dir())}
    drawn = {path.relative_to(pictures).with_suffix("") for path in pictures.rglob("*.png")}
    assert drawn == levels


def test_the_site_is_complete_and_needs_no_network(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "-d", tmp_path / "site"],
        cwd=ROOT,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    pages = {path.stem for path in (tmp_path / "site").glob("*.html")}
    assert {document.stem for document in DOCUMENTS} <= pages
    reference = (tmp_path / "site" / "api.html").read_text()
    fields = [
        f'id="{record.__module__}.{record.__name__}.{field.name}"'
        for record in (EnvParams, StaticEnvParams, UEDParams, PpoConfig)
        for field in dataclasses.fields(record)
    ]
    assert [name for name in fields if name not in reference] == []
    for page in (tmp_path / "site").rglob("*.html"):
        text = page.read_text()
        assert re.findall(r'(?:src|<link[^>]*href)="(?:https?:)?//[^"]*"', text) == [], page
