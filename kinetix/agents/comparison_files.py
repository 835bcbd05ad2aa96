"""A comparison of policies as a file: JSON with every attempt, CSV, or a page to look at."""

import csv
import html
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from kinetix.agents.compare import Contender, as_document, differences, leaderboard, unlike
from kinetix.agents.results import LevelFailure
from kinetix.errors import KinetixError
from kinetix.files.limits import LIMITS, MIB
from kinetix.wording import plural

SUFFIXES: Final = (".json", ".csv", ".html")


_LEVEL_BYTES: Final = 400
"""Length of what a JSON file says of a level per policy, episodes and its name aside."""
_HASH_BYTES: Final = 80
"""Length of a level's hash in a JSON file, and of what stands around it."""
_EPISODE_BYTES: Final = 45
"""Length of an episode in a JSON file."""


def check_size(path: Path, policies: int, levels: Sequence[str], attempts: int) -> None:
    """Refuse a comparison whose JSON file could not be read again, before it is measured.

    Args:
        path: The file to be written.
        policies: How many.
        levels: Their names.
        attempts: Per policy and level.

    Raises:
        KinetixError: The file would be too large.
    """
    each = _LEVEL_BYTES + attempts * _EPISODE_BYTES
    names = sum(len(json.dumps(name)) for name in levels)
    size = policies * (len(levels) * each + names) + len(levels) * _HASH_BYTES + names
    largest = LIMITS["kept"].largest
    if path.suffix.lower() == ".json" and size > largest:
        parts = plural(attempts, "attempt"), plural(policies, "policy", "policies")
        raise KinetixError(
            f"{path}: expected at most {largest // MIB} MiB, {parts[0]} of {parts[1]} in "
            f"{plural(len(levels), 'level')} would be some {size // MIB} MiB; ask for fewer, or "
            "for a .csv"
        )


def misfit_of(path: Path, text: str) -> str | None:
    """Return why a comparison that is written cannot be read again; None where it can.

    Args:
        path: The file.
        text: Its content.
    """
    largest = LIMITS["kept"].largest
    if path.suffix.lower() != ".json" or len(text) <= largest:
        return None
    return (
        f"{path}: has {len(text) // MIB} MiB, and the editor opens at most {largest // MIB} MiB; "
        "compare fewer, or write a .csv"
    )


def text_of(
    suffix: str, contenders: Sequence[Contender], hashes: dict[str, str], version: str
) -> str:
    """Return the content of a file.

    Args:
        suffix: One of `SUFFIXES`.
        contenders: The policies.
        hashes: `level_hash` of each level, by name.
        version: Of the program.
    """
    if suffix == ".json":
        return json.dumps(as_document(contenders, hashes, version)) + "\n"
    if suffix == ".csv":
        return _csv(contenders, hashes)
    return _page(contenders, hashes, version)


def _csv(contenders: Sequence[Contender], hashes: dict[str, str]) -> str:
    rows: list[dict[str, Any]] = []
    for contender in contenders:
        whence = contender.provenance.as_dict()
        for one in contender.results:
            row = {"label": contender.label, "level_hash": hashes.get(one.level, "")}
            rows.append(row | one.as_dict() | whence)
    out = io.StringIO()
    heads = dict.fromkeys(name for row in rows for name in row)
    writer = csv.DictWriter(out, list(heads), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def _page(contenders: Sequence[Contender], hashes: dict[str, str], version: str) -> str:
    """Return a heat map of levels and policies, the leaderboard, the differences, in one file."""
    shown = html.escape
    board = leaderboard(contenders)
    by_label = {contender.label: contender for contender in contenders}
    order = [by_label[row["label"]] for row in board]
    heads = "".join(f"<th>{shown(contender.label)}</th>" for contender in order)
    lines = []
    for level, sha256 in hashes.items():
        cells = "".join(_cell(contender, level) for contender in order)
        lines.append(f'<tr><th title="{sha256}">{shown(level)}</th>{cells}</tr>')
    ranks = [
        (
            f"<tr><td>{row['rank']}</td><td>{shown(row['label'])}</td>"
            f"<td>{_number(row['mean_solve_rate'])}</td><td>{_number(row['best_of_k'])}</td>"
            f"<td>{row['levels']} of {row['played']}</td><td>{shown(row['physics'])}</td>"
            f"<td><code>{row['digest'][:12]}</code></td></tr>"
        )
        for row in board
    ]
    pairs = [
        (
            f"<tr><td>{shown(one.first)}</td><td>{shown(one.second)}</td>"
            f"<td>{signed(one.difference)}</td><td>{signed(one.low)} … {signed(one.high)}</td>"
            f"<td>{one.better} : {one.worse}</td></tr>"
        )
        for one in differences(contenders)
    ]
    told = contenders[0].provenance
    mode = "likeliest actions" if told.deterministic else "actions drawn from the policy"
    how = f"{told.attempts} attempts a level, seed {told.seed}, {mode}; kinetix-editor {version}"
    return _PAGE.format(
        how=shown(how),
        heads=heads,
        lines="\n".join(lines),
        ranks="\n".join(ranks),
        pairs="\n".join(pairs),
        unlike="\n".join(f"<p>{shown(sentence)}.</p>" for sentence in unlike(contenders)),
    )


def _cell(contender: Contender, level: str) -> str:
    one = next((one for one in contender.results if one.level == level), None)
    if one is None:
        return "<td></td>"
    if isinstance(one, LevelFailure):
        return f'<td class="none" title="{html.escape(one.error)}">–</td>'
    low, high = one.bounds
    told = f"{one.solved} of {one.attempts} won, {low:.2f} to {high:.2f}"
    if one.failures:
        told += f"; otherwise {one.failures}"
    # From grey to green, the numbers readable on both.
    light = f"hsl(145 45% {94 - 44 * one.solve_rate:.0f}%)"
    return f'<td style="background:{light}" title="{told}">{one.solve_rate:.2f}</td>'


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"


def signed(value: float | None) -> str:
    """Return a difference with its sign; what rounds to nothing has a plus, never a minus."""
    if value is None:
        return "–"
    return f"{round(value, 3) + 0.0:+.3f}"


_PAGE: Final = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Policies compared</title>
<style>
body {{ font: 15px/1.45 system-ui, sans-serif; margin: 2rem; color: #20242c; background: #fff; }}
table {{ border-collapse: collapse; margin: .6rem 0 2rem; }}
td, th {{ padding: .25rem .6rem; text-align: right; border: 1px solid #e3e6ea; font-weight: 400; }}
thead th {{ font-weight: 600; position: sticky; top: 0; background: #fff; }}
tbody th, th.name, .names td:nth-child(-n+2), .names th:nth-child(-n+2) {{ text-align: left; }}
.ranks td:first-child, .ranks th:first-child {{ text-align: right; }}
td.none {{ color: #8a919c; }}
</style></head><body>
<h1>Policies compared</h1>
<p>{how}</p>
<h2>Leaderboard</h2>
<p>Means over the levels that all policies play.</p>
<table class="names ranks"><thead><tr><th>Rank</th><th>Policy</th><th>Solved</th><th>Best of k</th>
<th>Levels</th><th>Physics</th><th>Parameters</th></tr></thead><tbody>
{ranks}
</tbody></table>
{unlike}
<h2>Paired differences</h2>
<p>Solve rate of the first less that of the second on equal seeds, with 95 % intervals; attempts
that only one of them won.</p>
<table class="names"><thead><tr><th>First</th><th>Second</th><th>Difference</th><th>95 %</th>
<th>Only one won</th></tr></thead><tbody>
{pairs}
</tbody></table>
<h2>Levels</h2>
<table><thead><tr><th class="name">Level</th>{heads}</tr></thead><tbody>
{lines}
</tbody></table>
</body></html>
"""
