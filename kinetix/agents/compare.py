"""Policies beside each other on the same levels and seeds: who is better, and how sure that is.

Free of JAX, so that a window can use it.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any, Final

from kinetix.agents.results import WILSON_Z, LevelFailure, LevelResult, Provenance, summarise

_SETTINGS: Final = (
    ("frame_skip", "frame skip", "their steps are of different lengths"),
    (
        "dense_reward_scale",
        "weight of the distance reward",
        "their mean returns cannot be compared",
    ),
)
"""Settings of policies: the field of the provenance, what it is called, what follows."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Contender:
    """A policy and how it did on every level."""

    label: str
    """Unique among the contenders."""
    provenance: Provenance
    results: tuple[LevelResult | LevelFailure, ...]
    """One a level, in the same order for all contenders."""

    @property
    def played(self) -> dict[str, LevelResult]:
        """The levels that it could play, by name."""
        return {one.level: one for one in self.results if isinstance(one, LevelResult)}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Difference:
    """Difference of two policies' solve rates on the levels that both play."""

    first: str
    second: str
    levels: int
    """Levels that both could play."""
    difference: float | None
    """Mean over levels of the difference of the solve rates; None without a common level."""
    low: float | None
    """95 % interval over attempts at these levels."""
    high: float | None
    better: int
    """Attempts that only the first one won."""
    worse: int
    """Attempts that only the second one won."""

    def as_dict(self) -> dict[str, Any]:
        """Return the line that `kinetix compare --json` prints."""
        return dataclasses.asdict(self)


def labels_of(provenances: Sequence[Provenance]) -> list[str]:
    """Return a label per policy: its name, its digest where two have the same name, its number."""
    names = [one.agent for one in provenances]
    labels = [
        f"{one.agent} {one.digest[:6]}".strip() if names.count(one.agent) > 1 else one.agent
        for one in provenances
    ]
    counts = [labels[: place + 1].count(label) for place, label in enumerate(labels)]
    return [
        label if count == 1 else f"{label} ({count})"
        for label, count in zip(labels, counts, strict=True)
    ]


def paired(first: Contender, second: Contender) -> Difference:
    """Compare two policies attempt by attempt: attempt n of each has the same random numbers.

    The interval is that of a difference of paired proportions, with half an attempt added to each
    of the four outcomes of a pair, averaged over the levels.

    Args:
        first: One policy.
        second: Another one, measured with the same attempts and seed.

    Source: Agresti & Min, "Simple improved confidence intervals for comparing matched proportions"
    (2005).
    """
    a, b = first.played, second.played
    common = [level for level in a if level in b]
    better = worse = 0
    total = variance = 0.0
    for level in common:
        pairs = list(zip(a[level].episodes, b[level].episodes, strict=True))
        won = sum(x.outcome == "won" != y.outcome for x, y in pairs)
        lost = sum(y.outcome == "won" != x.outcome for x, y in pairs)
        better, worse = better + won, worse + lost
        total += (won - lost) / len(pairs)
        count = len(pairs) + 2
        more, less = (won + 0.5) / count, (lost + 0.5) / count
        variance += (more + less - (more - less) ** 2) / count
    count = len(common)
    mean = total / count if count else None
    half = WILSON_Z * math.sqrt(variance) / count if count else 0.0
    return Difference(
        first=first.label,
        second=second.label,
        levels=count,
        difference=mean,
        low=None if mean is None else max(mean - half, -1.0),
        high=None if mean is None else min(mean + half, 1.0),
        better=better,
        worse=worse,
    )


def leaderboard(contenders: Sequence[Contender]) -> list[dict[str, Any]]:
    """Return a row per policy, the best mean solve rate first.

    Args:
        contenders: The policies. Their means are over the levels that all of them play, so that
            none gains by refusing what is hard.
    """
    common = common_levels(contenders)
    rows = []
    for contender in contenders:
        played = contender.played
        summary = summarise([played[level] for level in common])
        row = {"label": contender.label, **summary, "played": len(played)}
        rows.append(row | contender.provenance.as_dict())
    rows.sort(key=lambda row: (-(row["mean_solve_rate"] or 0.0), row["label"]))
    return [{"rank": rank, **row} for rank, row in enumerate(rows, start=1)]


def common_levels(contenders: Sequence[Contender]) -> list[str]:
    """Return the levels that all policies could play, in their order."""
    first, *others = (contender.played for contender in contenders)
    return [level for level in first if all(level in other for other in others)]


def differences(contenders: Sequence[Contender]) -> list[Difference]:
    """Return the paired difference of every two policies, each pair once."""
    return [paired(one, other) for k, one in enumerate(contenders) for other in contenders[k + 1 :]]


def unlike(contenders: Sequence[Contender]) -> list[str]:
    """Return a sentence per setting, physics aside, in which policies are known to differ.

    Args:
        contenders: The policies; what is not known of one is not guessed.
    """
    sentences = []
    for name, what, why in _SETTINGS:
        told = {one.label: getattr(one.provenance, name) for one in contenders}
        if len({value for value in told.values() if value is not None}) > 1:
            each = [
                f"{label} {'not known' if value is None else format(value, 'g')}"
                for label, value in told.items()
            ]
            sentences.append(f"{what}: {', '.join(each)}; {why}")
    sentences += [
        f"{one.label} and {other.label} have the same parameters, and cards that differ"
        for k, one in enumerate(contenders)
        for other in contenders[k + 1 :]
        if one.provenance.digest == other.provenance.digest
        and one.provenance.card_digest
        and other.provenance.card_digest
        and one.provenance.card_digest != other.provenance.card_digest
    ]
    return sentences


def as_document(
    contenders: Sequence[Contender], hashes: dict[str, str], version: str
) -> dict[str, Any]:
    """Return everything as one JSON document: what was measured, of what, with what.

    Args:
        contenders: The policies.
        hashes: `level_hash` of each level, by name.
        version: Of the program.
    """
    return {
        "format": FORMAT,
        "version": 1,
        "program": version,
        "levels": hashes,
        "leaderboard": leaderboard(contenders),
        "differences": [one.as_dict() for one in differences(contenders)],
        "policies": [
            {
                "label": contender.label,
                **contender.provenance.as_dict(),
                "results": [_with_episodes(one) for one in contender.results],
            }
            for contender in contenders
        ],
    }


FORMAT = "kinetix-comparison"
"""The first field of a stored comparison."""


def _with_episodes(one: LevelResult | LevelFailure) -> dict[str, Any]:
    if isinstance(one, LevelFailure):
        return one.as_dict()
    episodes = [[e.outcome, e.length, e.total_reward] for e in one.episodes]
    return one.as_dict() | {"episodes": episodes}
