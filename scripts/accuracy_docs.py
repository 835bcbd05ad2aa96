"""Write the tables of docs/accuracy.md again from the rows in bench/accuracy/ and bench/peers/."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kinetix.bench.chart.points import file_name, read_rows
from kinetix.bench.peers.catalogue import PEERS
from kinetix.bench.report import class_errors, markdown_table, verdict_counts
from kinetix.scenes import SCENE_CLASSES, SCENES

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "accuracy.md"
RESULTS = ROOT / "bench" / "accuracy"
PEER_RESULTS = ROOT / "bench" / "peers"
ORDER = (
    "jax2d",
    "pgs_soft",
    "soft_step",
    "xpbd",
    "jacobi",
    "fast",
    "balanced",
    "accurate",
    "reference",
)

Rows = Mapping[str, Sequence[Mapping[str, Any]]]


def main() -> None:
    """Put the results between the marks of the page."""
    ours = {file.stem: read_rows(file) for file in sorted(RESULTS.glob("*.jsonl"), key=_place)}
    files = {peer.name: PEER_RESULTS / f"{file_name(peer.name)}.jsonl" for peer in PEERS}
    there = {name: file for name, file in files.items() if file.exists()}
    peers = {_told(name, ours): read_rows(file) for name, file in there.items()}
    text = between(PAGE.read_text(), "results", ours)
    PAGE.write_text(between(text, "peers", peers))


def _told(name: str, ours: Rows) -> str:
    """Return the engine's name, told apart from a method of ours of the same name."""
    return f"{name} (package)" if name in ours else name


def between(text: str, mark: str, results: Rows) -> str:
    """The page with tables of results between `<!-- MARK -->` and `<!-- end of MARK -->`."""
    start, end = f"<!-- {mark} -->", f"<!-- end of {mark} -->"
    head, rest = text.split(start)
    _, tail = rest.split(end)
    return head + "\n\n".join([start, summary(results), markdown_table(results), end]) + tail


def _place(file: Path) -> tuple[int, str]:
    return (ORDER.index(file.stem) if file.stem in ORDER else len(ORDER), file.stem)


def summary(results: Rows) -> str:
    """Return a line an engine: counts of verdicts and class errors."""
    lines = [
        "| physics | scenes | good | ok | fail | " + " | ".join(SCENE_CLASSES) + " |",
        "| --- |" + " ---: |" * (4 + len(SCENE_CLASSES)),
    ]
    for physics, rows in results.items():
        # A class of which a core scene is not measured yet has no error.
        absent = set(SCENES) - {row["scene"] for row in rows}
        unfinished = {SCENES[id].group for id in absent if SCENES[id].counted}
        errors = {k: v for k, v in class_errors(rows).items() if k not in unfinished}
        cells = [f"{errors[name]:.2g}" if name in errors else "" for name in SCENE_CLASSES]
        counts = verdict_counts(rows)
        cells = [str(count) for count in (sum(counts.values()), *counts.values())] + cells
        lines.append(f"| `{physics}` | " + " | ".join(cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
