"""Results of an evaluation: per level, over all levels, by group. Free of JAX."""

import dataclasses
import functools
import math
import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, Final

from kinetix.environment.outcome import Outcome

WILSON_Z: Final = 1.959964
"""Standard normal quantile of a 95 % interval."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class EpisodeResult:
    """Result of one attempt."""

    outcome: Outcome
    total_reward: float
    """Sum of the rewards, the distance reward included."""
    length: int
    """Environment steps."""
    dropped_contacts: int = 0
    """Steps in which bodies overlapped so much that there was no room for all contacts."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class LevelResult:
    """Result of a player on one level. Only the first episode of an attempt counts."""

    level: str
    attempts: int
    solved: int
    """Attempts that ended with green touching blue."""
    mean_return: float
    """Mean reward of an episode, the distance reward included."""
    mean_length: float
    """Mean number of environment steps."""
    episodes: tuple[EpisodeResult, ...] = ()
    """The attempts one by one, in their order."""

    @classmethod
    def of(cls, level: str, episodes: Sequence[EpisodeResult]) -> "LevelResult":
        """Return the result of some attempts.

        Args:
            level: What the level is called.
            episodes: At least one.
        """
        count = len(episodes)
        return cls(
            level=level,
            attempts=count,
            solved=sum(episode.outcome == "won" for episode in episodes),
            mean_return=math.fsum(episode.total_reward for episode in episodes) / count,
            mean_length=sum(episode.length for episode in episodes) / count,
            episodes=tuple(episodes),
        )

    @functools.cached_property
    def failures(self) -> str:
        """Outcomes of failed attempts, the commonest first: "12 timeout, 3 lost"; empty if none."""
        counts = Counter(e.outcome for e in self.episodes if e.outcome != "won")
        return ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())

    @property
    def dropped_contacts(self) -> int:
        """Steps of all attempts without room for all contacts."""
        return sum(episode.dropped_contacts for episode in self.episodes)

    @property
    def solve_rate(self) -> float:
        """Share of solved attempts."""
        return self.solved / self.attempts

    @functools.cached_property
    def bounds(self) -> tuple[float, float]:
        """95 % interval of the solve rate."""
        return wilson(self.solved, self.attempts)

    def as_dict(self) -> dict[str, Any]:
        """Return the line that `kinetix eval --json` prints."""
        low, high = self.bounds
        dropped = self.dropped_contacts
        return {
            "level": self.level,
            "solve_rate": self.solve_rate,
            "low": low,
            "high": high,
            "attempts": self.attempts,
            "mean_return": self.mean_return,
            "mean_length": self.mean_length,
            **({"dropped_contacts": dropped} if dropped else {}),
        }


@dataclasses.dataclass(frozen=True, kw_only=True)
class LevelFailure:
    """A level that could not be played, and why."""

    level: str
    error: str
    """One sentence."""

    def as_dict(self) -> dict[str, Any]:
        """Return the line that `kinetix eval --json` prints."""
        return {"level": self.level, "error": self.error}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Provenance:
    """Everything that a result depends on, levels aside: equal ones give equal results."""

    agent: str
    """Name of the player."""
    digest: str
    """SHA-256 of its parameters; empty for scripted players."""
    physics: str
    """Physics preset or solver."""
    seed: int
    attempts: int
    """Attempts a level."""
    deterministic: bool
    """True if the likeliest actions were taken."""
    frame_skip: int | None = None
    """Physics steps per action; None where it is not known, as of older files."""
    dense_reward_scale: float | None = None
    """Weight of the distance reward in the returns; None where it is not known."""
    card_digest: str = ""
    """Beginning of the SHA-256 of the rest of its card that affects play, such as the statistics
    of its observations; empty for scripted players, and where it is not known."""

    def as_dict(self) -> dict[str, Any]:
        """Return what is known of it, as in the last line of `kinetix eval --json`."""
        told = dataclasses.asdict(self)
        return {
            name: value for name, value in told.items() if name not in _LATER or value not in _NONE
        }


_LATER: Final = ("frame_skip", "dense_reward_scale", "card_digest")
"""Fields that older files lack."""
_NONE: Final = (None, "")
"""Their values where nothing is known."""


def report(
    results: Sequence[LevelResult | LevelFailure], provenance: Provenance
) -> list[dict[str, Any]]:
    """Return the lines that `kinetix eval --json` prints: a line a level, then the summary.

    Args:
        results: One a level, in the order in which the levels were asked for.
        provenance: What they depend on.
    """
    played = [result for result in results if isinstance(result, LevelResult)]
    lines = [result.as_dict() for result in results]
    return [*lines, summarise(played) | provenance.as_dict()]


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """95 % interval of a probability.

    Args:
        successes: How often it happened.
        trials: How often it was tried; at least 1.

    Source: Wilson, "Probable Inference, the Law of Succession, and Statistical Inference" (1927).
    """
    share, z2 = successes / trials, WILSON_Z**2
    centre = (share + z2 / (2 * trials)) / (1 + z2 / trials)
    variance = share * (1 - share) / trials + z2 / (4 * trials**2)
    half = WILSON_Z * math.sqrt(variance) / (1 + z2 / trials)
    return max(centre - half, 0.0), min(centre + half, 1.0)


def summarise(results: Sequence[LevelResult]) -> dict[str, Any]:
    """Means over levels, every level counting the same.

    Args:
        results: One a level; of none the means are None.

    Returns:
        `mean_solve_rate`, `best_of_k` (share of levels solved at least once), `groups` (mean solve
        rate by group) and `levels` (how many).
    """
    groups: dict[str, list[float]] = defaultdict(list)
    for result in results:
        for group in groups_of(result.level):
            groups[group].append(result.solve_rate)
    return {
        "mean_solve_rate": _mean([result.solve_rate for result in results]),
        "best_of_k": _mean([float(result.solved > 0) for result in results]),
        "groups": {name: _mean(rates) for name, rates in sorted(groups.items())},
        "levels": len(results),
    }


def rates_of_parts(results: Sequence[LevelResult], parts: Mapping[str, str]) -> dict[str, float]:
    """Return the mean solve rate of each part of a split set; empty unless there are several.

    An agent that was trained on one part has learnt its levels: the mean of both says little.

    Args:
        results: One a level.
        parts: The part of each level that is in one, by the level's name.
    """
    rates: dict[str, list[float]] = {part: [] for part in sorted(set(parts.values()), reverse=True)}
    for result in results:
        if result.level in parts:
            rates[parts[result.level]].append(result.solve_rate)
    means = {part: math.fsum(each) / len(each) for part, each in rates.items() if each}
    return means if len(means) > 1 else {}


def groups_of(name: str) -> tuple[str, ...]:
    """Return the metric groups of a level: by folder, and by folder and first word of its name.

    Args:
        name: `folder/word_rest`; digits in the word do not count, `h` and `r` mean handmade and
            random.
    """
    if "/" not in name:
        return ()
    folder, rest = name.rsplit("/", 1)
    folder = folder.rsplit("/", 1)[-1]
    word = re.sub(r"\d", "", rest.split("_", 1)[0])
    word = {"h": "handmade", "r": "random"}.get(word, word)
    return (f"{folder}_all", f"{folder}_{word}") if word else (f"{folder}_all",)


def _mean(values: Sequence[float]) -> float | None:
    return math.fsum(values) / len(values) if values else None
