"""Measuring players: the levels, each once, the progress, and the rates of the parts of a set."""

import contextlib
import sys
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from kinetix.agents.results import LevelFailure, LevelResult, rates_of_parts
from kinetix.cli.shared.terminal import Terminal
from kinetix.level.sets import SetLevel, distinct, gather_levels
from kinetix.wording import plural

if TYPE_CHECKING:
    from kinetix.agents.evaluate import NamedLevel, Progress


def levels_to_measure(sources: Sequence[str]) -> list[SetLevel]:
    """Return the levels of a command line, equal ones once; print what is left out.

    Args:
        sources: As for `gather_levels`.

    Raises:
        LevelError: As for `gather_levels`.
    """
    found = gather_levels(sources)
    levels = distinct(found)
    if len(levels) < len(found):
        doubles = plural(len(found) - len(levels), "level")
        print(f"{doubles} left out: equal to others, and counted once", file=sys.stderr)
    return levels


def named(levels: Iterable[SetLevel]) -> "list[NamedLevel]":
    """Return levels as an evaluation takes them."""
    from kinetix.agents.evaluate import NamedLevel

    return [
        NamedLevel(name=level.name, source=level.level if level.path is None else str(level.path))
        for level in levels
    ]


def watched(measuring: "Iterable[Progress]", who: str = "") -> "Progress":
    """Measure to the end, with the progress on stderr.

    Args:
        measuring: From `evaluate`.
        who: Who is measured, where there are several.
    """
    begin, last = f"{who}: " if who else "", None
    with contextlib.closing(Terminal()) as terminal:
        terminal.status(f"{begin}compiling the player and the step")
        for last in measuring:
            if last.total:  # none where no level can be played
                terminal.status(f"{begin}{last.done} of {plural(last.total, 'episode')}")
    assert last is not None
    return last


def parts_of(
    levels: Iterable[SetLevel], results: Iterable[LevelResult | LevelFailure]
) -> dict[str, float]:
    """Return the mean solve rate of each part of the sets; nothing unless there are several parts.

    Args:
        levels: What was measured on.
        results: One a level at most.
    """
    parts = {level.name: level.split for level in levels if level.split is not None}
    return rates_of_parts([one for one in results if isinstance(one, LevelResult)], parts)


def told_parts(rates: dict[str, float]) -> str:
    """Return the rates of the parts in words: `train 0.900, eval 0.400`."""
    return ", ".join(f"{part} {rate:.3f}" for part, rate in rates.items())
