"""The futures that a planner tried, fanned out from where the green shape is."""

from typing import Any, Final

from editor.drawing.vectors import Painter
from editor.toolkit.appearance import COLOURS, Rgba, alpha, u32
from editor.toolkit.widgets import px
from editor.worker.snapshots import Futures, Snapshot
from kinetix.wording import plural

_FAINT: Final = 0.38
"""Opacity of what was not chosen."""
_DOT: Final = 5
"""Places of the chosen way between two dots."""


def paint_futures(painter: Painter, snapshot: Snapshot) -> None:
    """Draw the ways that a planner tried; the one that it follows is thick.

    Args:
        painter: Where to draw.
        snapshot: The moment; without futures nothing is drawn.
    """
    futures = futures_of(snapshot)
    if futures is None:
        return
    draw, camera = painter.draw, painter.camera
    for k in reversed(range(len(futures.ends))):
        places: list[Any] = [camera.to_screen((x, y)) for x, y in futures.ways[k].tolist()]
        colour, chosen = _colour(futures.ends[k]), k == 0
        if chosen:
            draw.add_polyline(places, u32(alpha(COLOURS.backdrop, 0.6)), px(5.5), 0)
        shade = u32(colour if chosen else alpha(colour, _FAINT))
        draw.add_polyline(places, shade, px(3.0 if chosen else 1.5), 0)
        for at in places[_DOT::_DOT] if chosen else ():
            draw.add_circle_filled(at, px(2.5), u32(COLOURS.backdrop))
        draw.add_circle_filled(places[-1], px(5 if chosen else 3), shade)


def futures_of(snapshot: Snapshot) -> Futures | None:
    """Return the ways that are still ahead of a moment: none once the episode has ended."""
    if snapshot.mind is None or snapshot.outcome is not None:
        return None
    return snapshot.mind.futures


def _colour(end: str) -> Rgba:
    return {"won": COLOURS.good, "lost": COLOURS.bad}.get(end, COLOURS.info)


def outlook(futures: Futures) -> str:
    """Return in words what the plan leads to."""
    if futures.ends[0] == "won":
        return f"plans: a win {plural(futures.steps[0], 'step')} ahead"
    if all(end == "lost" for end in futures.ends):
        return "plans: sees no way out"
    return "plans: no win in sight yet"
