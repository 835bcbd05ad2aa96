"""A card on the canvas that says what Play waits for, how far that is, and how to do without."""

import time
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import Point
from editor.base.language import tr
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, TEXT, u32
from editor.toolkit.widgets import font, px

if TYPE_CHECKING:
    from editor.session import Session
    from editor.worker.jobs import Job

_PATIENCE: Final = 0.2
"""Shortest wait that gets a card [s]."""
_LONG: Final = 10.0
"""Wait from which on its length is told: the last percents are a guess [s]."""
_WIDTH: Final = 340.0
_ROUND_SECONDS: Final = 1.6
"""Period of the light in a bar without a known fraction [s]."""


def awaited(session: "Session") -> tuple[str, "Job"] | None:
    """Return the reason for the wait, in words, and its job; None where nobody waits."""
    playback, expected = session.playback, session.expected
    job = getattr(playback.simulator, "job", None)
    if playback.waiting and job is not None:
        return (f"Preparing {playback.player}" if playback.player else "Preparing Play"), job
    rival = session.viewer.rival
    job = getattr(rival.simulator, "job", None)
    if rival.preparing and job is not None:
        return f"Preparing {rival.player}", job
    if expected is not None and not expected.finished:
        return expected.title, expected
    return None


def paint_waiting(session: "Session", draw: imgui.ImDrawList, area: tuple[Point, Point]) -> None:
    """Draw the card, where somebody waits.

    Args:
        session: The app.
        draw: Where to draw.
        area: Upper left corner and size of the canvas [px].
    """
    found = awaited(session)
    if found is None or time.monotonic() - found[1].since < _PATIENCE:
        return
    title, job = tr(found[0]), found[1]
    (x, y), (width, height) = area
    wide = min(px(_WIDTH), width - px(24))
    line, pad = px(TEXT + 8), px(18)
    tall = 2 * pad + 2 * line + px(20)
    low = (x + (width - wide) / 2, y + (height - tall) * 0.4)
    high = (low[0] + wide, low[1] + tall)
    draw.add_rect_filled(low, high, u32(COLOURS.backdrop), px(10))
    draw.add_rect(low, high, u32(COLOURS.accent), px(10), px(1.5))
    left, right = low[0] + pad, high[0] - pad
    with font(FONTS.bold, TEXT):
        draw.add_text((left, low[1] + pad), u32(COLOURS.text), title)
    waited = time.monotonic() - job.since
    share = "" if job.fraction is None else f"{job.fraction:.0%}"
    if waited >= _LONG:
        share = f"{share}   {tr(f'{waited:.0f} s so far')}"
    with font(FONTS.regular, SMALL):
        top = low[1] + pad + px(2)
        draw.add_text((right - imgui.calc_text_size(share).x, top), u32(COLOURS.muted), share)
        _bar(draw, (left, low[1] + pad + line + px(2)), (right, px(6)), job)
        top = high[1] - pad - imgui.get_text_line_height()
        words = f"{tr(job.message or 'Waiting')} …"
        draw.add_text((left, top), u32(COLOURS.muted), words)
        way_out = tr("Esc cancels")
        at = (right - imgui.calc_text_size(way_out).x, top)
        draw.add_text(at, u32(COLOURS.muted), way_out)


def _bar(draw: imgui.ImDrawList, low: Point, right_and_height: Point, job: "Job") -> None:
    """Draw the progress; where it is unknown, a light that moves on."""
    right, tall = right_and_height
    wide = right - low[0]
    draw.add_rect_filled(low, (right, low[1] + tall), u32(COLOURS.raised), tall / 2)
    if job.fraction is not None:
        begin, end = 0.0, max(job.fraction, tall / wide)
    else:
        begin = (time.monotonic() - job.since) / _ROUND_SECONDS % 1.0
        begin, end = max(begin * 1.2 - 0.2, 0.0), min(begin * 1.2, 1.0)
    if end > begin:
        draw.add_rect_filled(
            (low[0] + begin * wide, low[1]),
            (low[0] + end * wide, low[1] + tall),
            u32(COLOURS.accent),
            tall / 2,
        )
