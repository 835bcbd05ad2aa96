"""Allocation of arrays in a world's memory: two that are never alive at once may share a place."""

import dataclasses
from collections.abc import Iterable
from typing import Final

ALIGNMENT: Final = 4
"""Alignment of every array [bytes]."""


@dataclasses.dataclass(eq=False)
class Span:
    """Bytes that are needed from one time to another."""

    size: int
    first: int
    last: int
    place: int = 0


def prolonged(spans: Iterable[Span], loops: Iterable[tuple[int, int]]) -> None:
    """Keep what a loop reads, and what was there before it, until its end."""
    spans = list(spans)
    for start, end in sorted(loops, key=lambda loop: loop[1] - loop[0]):
        for span in spans:
            if span.first < start <= span.last < end:
                span.last = end


def placed(spans: Iterable[Span]) -> int:
    """Give each a place.

    Returns:
        Bytes in all.
    """
    done: list[Span] = []
    top = 0
    for span in sorted(spans, key=lambda span: (-span.size, span.first)):
        place = 0
        for other in sorted(done, key=lambda other: other.place):
            if other.last < span.first or span.last < other.first:
                continue
            if other.place - place >= span.size:
                break
            place = max(place, _aligned(other.place + other.size))
        span.place = place
        top = max(top, place + span.size)
        done.append(span)
    return _aligned(top)


def _aligned(place: int) -> int:
    return -(-place // ALIGNMENT) * ALIGNMENT
