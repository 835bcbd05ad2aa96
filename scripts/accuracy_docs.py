"""Write the table of docs/accuracy.md anew from the measured rows in bench/accuracy/."""

import json
from pathlib import Path

from kinetix.bench.report import class_errors, markdown_table, verdict_counts
from kinetix.scenes import SCENE_CLASSES

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "accuracy.md"
RESULTS = ROOT / "bench" / "accuracy"
ORDER = ("jax2d", "fast", "balanced", "accurate", "reference")
START, END = "<!-- results -->", "<!-- end of results -->"


def main() -> None:
    """Put the results between the two marks of the page."""
    results = {
        file.stem: [json.loads(line) for line in file.read_text().splitlines()]
        for file in sorted(RESULTS.glob("*.jsonl"), key=_place)
    }
    head, rest = PAGE.read_text().split(START)
    _, tail = rest.split(END)
    parts = [START, summary(results), markdown_table(results), END]
    PAGE.write_text(head + "\n\n".join(parts) + tail)


def _place(file: Path) -> tuple[int, str]:
    return (ORDER.index(file.stem) if file.stem in ORDER else len(ORDER), file.stem)


def summary(results: dict[str, list[dict]]) -> str:
    """A line a physics: counts of verdicts and class errors."""
    lines = [
        "| physics | scenes | good | ok | fail | " + " | ".join(SCENE_CLASSES) + " |",
        "| --- |" + " ---: |" * (4 + len(SCENE_CLASSES)),
    ]
    for physics, rows in results.items():
        errors = class_errors(rows)
        cells = [f"{errors[name]:.2g}" if name in errors else "" for name in SCENE_CLASSES]
        counts = [str(count) for count in verdict_counts(rows).values()]
        lines.append(f"| `{physics}` | {len(rows)} | " + " | ".join(counts + cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
