"""Plain English: docstrings say what a thing is or does and cite real files."""

import ast
import functools
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted(
    path
    for package in ("kinetix", "editor", "scripts", "examples")
    for path in (ROOT / package).rglob("*.py")
)
DOCUMENTS = [
    *ROOT.glob("*.md"),
    *(ROOT / "docs").glob("*.md"),
    *(ROOT / "kinetix").rglob("*.md"),
    *(ROOT / "editor").rglob("*.md"),
]
QUESTION = re.compile(r"(?:What|Who|Whom|Whose|Whether|How|That|Which|When|Where|Why)\b")
BANNED = re.compile(
    r"\bthe peer\b|\bno number any ?more\b|\bnumbers that are none\b|\bgone on from\b"
    r"|\bby turns\b|\bhad better\b|\bone value a\b|\bdrawn by a seed\b",
    re.IGNORECASE,
)
"""Words that readers stumbled over; the plain ones are in CONTRIBUTING.md."""


def docstrings(tree: ast.Module) -> Iterator[str]:
    """Docstrings of modules, classes and functions, and those below fields."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for child in body if isinstance(body, list) else ():
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
                value = child.value.value
                if isinstance(value, str):
                    yield value.strip()


@functools.cache
def prose(path: Path) -> str:
    """All docstrings and comments of a module, or a whole document, with single spaces."""
    if path.suffix == ".md":
        return " ".join(path.read_text().split())
    with path.open("rb") as file:
        tokens = list(tokenize.tokenize(file.readline))
    comments = [token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT]
    return " ".join(" ".join([*comments, *docstrings(ast.parse(path.read_text()))]).split())


def test_docstrings_say_what_a_thing_is_or_does():
    found = [
        (path.relative_to(ROOT).as_posix(), text)
        for path in SOURCES
        for text in docstrings(ast.parse(path.read_text()))
    ]
    odd = [f"{path}: {text.splitlines()[0]}" for path, text in found if QUESTION.match(text)]
    assert len(found) > 5000
    assert odd == []


def test_words_that_readers_stumble_over_are_gone():
    found = [
        f"{path.relative_to(ROOT)}: {match.group()}"
        for path in [*SOURCES, *DOCUMENTS]
        for match in BANNED.finditer(prose(path))
    ]
    assert found == []


def test_documents_that_are_cited_exist():
    """A docstring cites a file of the repository, or says the fact in place."""
    known = {path.name for top in ROOT.glob("[!.]*") for path in [top, *top.rglob("*.md")]}
    missing = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in SOURCES
        for name in re.findall(r"\b([\w-]+\.md)\b", prose(path))
        if name not in known
    ]
    assert missing == []


def test_films_are_written_in_one_module():
    told = re.compile("save_all=True|GifImagePlugin")
    writers = [path for path in SOURCES if told.search(path.read_text())]
    assert [path.relative_to(ROOT).as_posix() for path in writers] == ["kinetix/render/film.py"]
