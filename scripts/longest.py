"""Print the longest files and functions: for information, nothing fails because of them."""

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("kinetix", "editor")
FILE_HABIT, FUNCTION_HABIT, SHOWN = 400, 60, 10


def files(root: Path = ROOT) -> list[tuple[int, str]]:
    """Lengths of all source files in lines, the longest first, with their paths below `root`."""
    found = (path for package in PACKAGES for path in (root / package).rglob("*.py"))
    return sorted(
        ((len(path.read_text().splitlines()), str(path.relative_to(root))) for path in found),
        reverse=True,
    )


def functions(root: Path = ROOT) -> list[tuple[int, str]]:
    """Lengths of all functions in lines, the longest first, with `path:line name`."""
    return sorted(
        (entry for _, path in files(root) for entry in _functions_of(root / path, path)),
        reverse=True,
    )


def _functions_of(file: Path, name: str) -> Iterator[tuple[int, str]]:
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            end = node.end_lineno or node.lineno
            yield end - node.lineno + 1, f"{name}:{node.lineno} {node.name}"


def main() -> None:
    """Print both lists, with a mark at what is longer than the habit."""
    for title, habit, entries in (
        ("files", FILE_HABIT, files()),
        ("functions", FUNCTION_HABIT, functions()),
    ):
        print(f"longest {title} (habit: {habit} lines; * marks what is longer)")
        for length, name in entries[:SHOWN]:
            print(f"{'*' if length > habit else ' '}{length:5}  {name}")


if __name__ == "__main__":
    main()
