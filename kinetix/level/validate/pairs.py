"""Problems of bodies that touch or overlap at the start."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from kinetix.engine.constants import TOUCH_SLOP
from kinetix.engine.pairs import touching_points
from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.geometry import overlap_depth
from kinetix.level.graph import components, may_push, modes_meet
from kinetix.level.model import Level, Polygon
from kinetix.level.sizes import capacity_of, describe_capacity
from kinetix.level.validate.issue import Issue, capital, describe, issue
from kinetix.level.validate.placed import Placed

OVERLAP_TOLERANCE: Final = 0.01
"""Overlap that no solver notices: the published levels' slop [m]."""
MOST_OVERLAPS: Final = 200
"""Most pairs of overlapping bodies that are listed: a pile of hundreds has tens of thousands."""


def pair_issues(level: Level, placed: list[Placed]) -> Iterator[Issue]:
    """Yield touches that decide the level at once, overlaps (W202) and crowds (W211).

    A touch with red (E105) beats one with blue (E104), as in the game.
    """
    component = components(level.joints)
    capacity = capacity_of(level)
    room = touching_points(capacity.polygons - ARENA_BODIES, capacity.circles)
    contacts = overlaps = 0
    decided: list[Issue] = []
    for a, b in _pairs_of_boxes(placed):
        enough = overlaps > MOST_OVERLAPS and contacts > room
        green = "green" in (a.body.role, b.body.role)
        if (enough and not green) or not modes_meet(a.body, b.body):
            continue
        pushing = may_push((a.reference, a.body), (b.reference, b.body), component)
        if not (pushing or green):
            continue
        depth = overlap_depth(a.body, b.body)
        if pushing and depth >= -TOUCH_SLOP:
            both = isinstance(a.body.shape, Polygon) and isinstance(b.body.shape, Polygon)
            contacts += 2 if both else 1
        decided += _touch_issues(a, b, depth, pushing=pushing)
        if pushing and depth > OVERLAP_TOLERANCE:
            overlaps += 1
            if overlaps <= MOST_OVERLAPS:
                yield _overlap_issue(a, b, depth)
    if overlaps > MOST_OVERLAPS:
        message = f"More shapes overlap than the {MOST_OVERLAPS} pairs that are listed."
        yield issue("W202", message)
    lost = [issue for issue in decided if issue.code == "E105"]
    yield from lost or decided
    yield from _crowd_issues(level, contacts, room)


def _pairs_of_boxes(placed: list[Placed]) -> Iterator[tuple[Placed, Placed]]:
    """Return the pairs whose boxes meet, but for those of the arena, in order."""
    low, high = (
        np.array([each.box[part] for each in placed], float).reshape(-1, 2)
        for part in (slice(0, 2), slice(2, 4))
    )
    arena = np.array([isinstance(each.reference, str) for each in placed], bool)
    for index, each in enumerate(placed):
        rest = slice(index + 1, None)
        meets = (low[rest] <= high[index] + TOUCH_SLOP) & (low[index] <= high[rest] + TOUCH_SLOP)
        for later in np.flatnonzero(meets.all(axis=1) & ~(arena[rest] & arena[index])):
            yield each, placed[index + 1 + later]


def _crowd_issues(level: Level, contacts: int, room: int) -> Iterator[Issue]:
    if contacts > room:
        capacity = capacity_of(level)
        message = (
            f"Bodies overlap so much that {contacts} contact points or more meet at the start; "
            f"size {describe_capacity(capacity)} has room for {room}: some will be left out. Move "
            f"bodies apart."
        )
        yield issue("W211", message)


def _touch_issues(a: Placed, b: Placed, depth: float, *, pushing: bool) -> Iterator[Issue]:
    roles = {a.body.role, b.body.role}
    ids = (a.reference, b.reference)
    path = b.path
    if depth >= -TOUCH_SLOP if pushing else depth > 0:
        if roles == {"green", "blue"}:
            message = "Green already touches blue at the start: solved at t=0."
            yield issue("E104", message, path=path, ids=ids)
        if roles == {"green", "red"}:
            message = "Green already touches red at the start: lost at t=0."
            yield issue("E105", message, path=path, ids=ids)


def _overlap_issue(a: Placed, b: Placed, depth: float) -> Issue:
    first, second = describe(a.reference, a.body), describe(b.reference, b.body)
    message = f"{capital(first)} and {second} overlap by {depth:.3g} m and will be pushed apart."
    return issue("W202", message, path=b.path, ids=(a.reference, b.reference))
