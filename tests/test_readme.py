"""Commands and scripts of the README can be run."""

import glob
import re
import shlex
from pathlib import Path

import pytest

from kinetix import cli

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("kinetix/**/*.md")])


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def commands():
    return [line for block in blocks("sh") for line in block.splitlines()]


@pytest.mark.slow
def test_the_snippets_run_in_order():
    names = {}
    for block in blocks("python"):
        exec(compile(block, "README.md", "exec"), names)
    assert names["picture"].shape == (125, 125, 3)
    assert names["picture"].max() > names["picture"].min()
    # The second snippet plays the bundled level: its box, its two balls and the arena.
    assert int(names["level"].bodies.active.sum()) == 7


QUICK = tuple(f"kinetix {name} " for name in ("validate", "convert", "play", "sample", "eval"))
"""Sub-commands that take seconds; the others run in tests of their own, on something small."""


@pytest.mark.slow
@pytest.mark.parametrize("line", [line for line in commands() if line.startswith(QUICK)])
def test_quick_commands_run_as_printed(line, tmp_path, monkeypatch, capsys):
    for name in ("levels", "checkpoints"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    words = [
        found
        for word in shlex.split(line, comments=True)[1:]
        for found in (sorted(glob.glob(word)) if "*" in word else [word])
    ]
    assert cli.main(words) == 0
    assert any(capsys.readouterr())
    made = [path for path in (tmp_path / "out").rglob("*") if path.is_file()]
    assert bool(made) == any(word.startswith("out/") for word in words)


@pytest.mark.parametrize(
    ("physics", "part"), [("balanced", "results"), ("jax2d (package)", "peers")]
)
def test_the_comparison_says_what_was_measured(physics, part):
    accuracy = (ROOT / "docs" / "accuracy.md").read_text()
    table = accuracy.split(f"<!-- {part} -->")[1].split("<!--")[0]
    row = re.search(
        rf"^\| `{re.escape(physics)}` \| (\d+) \| (\d+) \| (\d+) \| (\d+) ", table, re.MULTILINE
    )
    count, good, passable, failed = row.groups()
    said = rf"{count}[^|:]*: {good} good, {passable} passable, {failed} failed"
    assert re.search(said, README), f"docs/accuracy.md has {row.group()}"


def test_the_targets_exist():
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    text = README + (ROOT / "CONTRIBUTING.md").read_text()
    assert set(re.findall(r"^make ([a-z-]+)", text, re.MULTILINE)) <= targets


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(document):
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", document.read_text())
    local = [link for link in links if "://" not in link]
    assert [link for link in local if not (document.parent / link).exists()] == []
