"""The column beside the arena in Play: mode, step, result; the keys under them.

Where there is no room beside the arena the same lines stand in its upper left corner, on a plate.
"""

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import ARENA, Point
from editor.base.controls import GLYPHS
from editor.base.language import tr
from editor.play.mode import Mode
from editor.toolkit.appearance import COLOURS, FONTS, HUGE, SMALL, TEXT, Rgba, alpha, u32
from editor.toolkit.modes import MODE_LOOK, OUTCOME_LOOK
from editor.toolkit.widgets import broken, draw_key_plate, fitted, font, px
from editor.window.hints import pressed
from editor.worker.snapshots import Snapshot
from kinetix.environment.outcome import Outcome
from kinetix.level.controls import channels_in_use, driven_by
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session


_WIDTH: Final = 250.0
"""Width of the column [px at 100 %]; less where there is less room."""
_LEAST: Final = 112.0
"""In less room it stands over the arena."""
_EDGE: Final = 14.0
_LARGE: Final = 320.0
"""Side of an arena that has room for all that is said of an episode's end [px at 100 %]."""


@dataclasses.dataclass(kw_only=True)
class _Column:
    """Writes one line under the other."""

    draw: imgui.ImDrawList
    x: float
    y: float
    width: float
    bottom: float
    """Nothing is written below [px]."""
    plates: bool
    """True if it stands over the level, on a plate."""
    short: bool
    """True if how it ended has to stand in one line."""
    reach: Point = (0.0, 0.0)
    """Lower right corner of all that is written [px]."""

    def gap(self, height: float) -> None:
        self.y += px(height)

    def wrote(self, right: float, bottom: float) -> None:
        """Note how far something reaches that was written."""
        self.reach = max(self.reach[0], right), max(self.reach[1], bottom)

    def underlay(self, top: float) -> None:
        """Draw the plate under all that was written from there on: the channel below is for it."""
        if not self.reach[0]:
            return
        around = px(8)
        low = (self.x - around, top - around)
        high = (self.reach[0] + around, self.reach[1] + around)
        self.draw.channels_set_current(0)
        self.draw.add_rect_filled(low, high, u32(alpha(COLOURS.raised, 0.92)), px(8))
        self.draw.channels_set_current(1)

    def lines(
        self, words: str, colour: Rgba, size: float = SMALL, face: imgui.ImFont | None = None
    ) -> None:
        """Write words, broken to the column's width."""
        with font(face or FONTS.regular, size):
            for line in broken(words, self.width):
                extent = imgui.calc_text_size(line)
                if self.y + extent.y > self.bottom:
                    return
                self.draw.add_text((self.x, self.y), u32(colour), line)
                self.wrote(self.x + extent.x, self.y + extent.y)
                self.y += extent.y + px(4)


def paint_side(
    session: "Session", draw: imgui.ImDrawList, area: tuple[Point, Point], *, split: bool
) -> float:
    """Draw the column.

    Args:
        session: What is played.
        draw: Where to draw.
        area: Upper left corner and size of the canvas [px].
        split: Whether two players share the canvas, so that nothing is free beside the arena.

    Returns:
        How far it reaches to the right [px].
    """
    (x, y), (width, height) = area
    corner = session.camera.to_screen((ARENA[0][0], ARENA[1][1]))
    side = session.camera.to_screen(ARENA[1])[0] - corner[0]
    left = corner[0] - x
    free = left - 2 * px(_EDGE)
    beside = not split and free >= px(_LEAST)
    if beside:
        wide = min(free, px(_WIDTH))
        at, top = x + left - px(_EDGE) - wide, y + px(_EDGE)
    else:
        at, top = max(corner[0], x) + px(_EDGE), max(corner[1], y) + px(_EDGE)
        wide = min(px(_WIDTH), x + (width / 2 if split else width) - at - px(_EDGE))
    bottom = y + height - px(_EDGE)
    short = not beside and session.mode is Mode.ENDED and side < px(_LARGE)
    column = _Column(
        draw=draw, x=at, y=top, width=wide, bottom=bottom, plates=not beside, short=short
    )
    draw.channels_split(2)
    draw.channels_set_current(1)
    if not short:
        _badge(session, column)
    _results(session, column, area, split=split)
    if not short:
        _progress(session, column, beside)
    if beside:
        _keys(session, column)
        _goal(session, column)
    else:
        column.underlay(top)
    draw.channels_merge()
    return column.reach[0]


def _badge(session: "Session", column: _Column) -> None:
    word, name = MODE_LOOK[session.mode]
    word, colour = tr(word), COLOURS.of(name)
    with font(FONTS.bold, SMALL):
        size = imgui.calc_text_size(word)
        high = (column.x + size.x + px(16), column.y + size.y + px(8))
        column.draw.add_rect_filled((column.x, column.y), high, u32(colour), px(5))
        at = (column.x + px(8), column.y + px(4))
        column.draw.add_text(at, u32(COLOURS.backdrop), word)
    column.wrote(*high)
    column.y = high[1]
    column.gap(10)


def _results(
    session: "Session", column: _Column, area: tuple[Point, Point], *, split: bool
) -> None:
    """Write how the episode ended; of two players side by side, each in its own half."""
    playback, rival = session.playback, session.viewer.rival
    if session.mode is not Mode.ENDED or playback.outcome is None:
        return
    mine = [_after(playback.step_count)]
    other = rival.shown(playback.engine_step) if rival.active else None
    if other is not None and split:
        _, (width, _) = area
        top = column.y
        half = dataclasses.replace(column, x=column.x + width / 2, reach=(0.0, 0.0))
        if other.outcome is not None:
            write_verdict(half, other.outcome, [_after(other.step)])
        else:
            size = SMALL if column.short else TEXT
            half.lines(tr(_of_rival(session, other)), COLOURS.text, size)
        half.underlay(top)
    elif other is not None:
        mine.append(_of_rival(session, other))
    write_verdict(column, playback.outcome, mine)
    if column.short:
        return
    for action, does in (("run.reset", "to restart"), ("run.stop", "to edit")):
        line = pressed(session, action, does)
        if line:
            column.lines(tr(line), COLOURS.muted)
    column.gap(8)


def _after(steps: int) -> str:
    return f"after {plural(steps, 'step')}"


def _of_rival(session: "Session", shown: Snapshot) -> str:
    """Return how it stands with the second player, whose first one has ended."""
    rival, after = session.viewer.rival, _after(shown.step)
    if rival.goes_on and rival.level is not None:
        return f"{rival.player} goes on: step {shown.step} / {rival.level.max_timesteps}"
    verdict = OUTCOME_LOOK[shown.outcome][1].lower() if shown.outcome else "undecided"
    return f"{rival.player}: {verdict} {after}"


def write_verdict(column: _Column, outcome: Outcome, details: Sequence[str]) -> None:
    """Write the outcome of an episode in large letters, with its details.

    Args:
        column: Where to write.
        outcome: How it ended.
        details: Lines under it; where it has to be short the first one goes on after the outcome.
    """
    icon, word, name = OUTCOME_LOOK[outcome]
    colour = COLOURS.of(name)
    if column.short:
        told = f"{icon}  {tr(word)} {tr(details[0])}"
        column.lines(told, colour, SMALL, FONTS.bold)
        for words in details[1:]:
            column.lines(tr(words), COLOURS.text)
        return
    title = f"{icon}  {tr(word)}"
    with font(FONTS.bold, HUGE):
        wanted = imgui.calc_text_size(title).x
    size = HUGE * min(1.0, column.width / max(wanted, 1.0))
    with font(FONTS.bold, size):
        extent = imgui.calc_text_size(title)
        column.draw.add_text((column.x, column.y), u32(colour), title)
    column.wrote(column.x + extent.x, column.y + extent.y)
    column.y += extent.y
    column.gap(8)
    for words in details:
        column.lines(tr(words), COLOURS.text, TEXT)


def _progress(session: "Session", column: _Column, beside: bool) -> None:
    """Write who plays, the step, the speed and what goes on."""
    playback = session.playback
    total = playback.level.max_timesteps if playback.level is not None else 0
    if playback.waiting:
        job = getattr(playback.simulator, "job", None)
        words = f"{tr(job.message or job.title)} …" if job is not None else tr("Preparing …")
        column.lines(words, COLOURS.text)
        return
    if playback.player:
        column.lines(playback.player, COLOURS.text, SMALL, FONTS.bold)
    column.lines(tr(f"step {playback.step_count} / {total}"), COLOURS.text)
    if beside and total and column.y < column.bottom:
        share = min(playback.step_count / total, 1.0)
        low = (column.x, column.y)
        high = (column.x + column.width, column.y + px(4))
        column.draw.add_rect_filled(low, high, u32(COLOURS.field), px(2))
        end = (column.x + column.width * share, high[1])
        column.draw.add_rect_filled(low, end, u32(COLOURS.of(MODE_LOOK[session.mode][1])), px(2))
        column.gap(10)
    for words in _states(session):
        column.lines(tr(words), COLOURS.warn)
    column.gap(10)


def _states(session: "Session") -> list[str]:
    playback = session.playback
    words = []
    if playback.speed != 1.0:
        words.append(f"{speed_words(playback.speed)} speed")
    actual = playback.real_time_factor
    if session.mode is Mode.PLAYING and 0 < actual < 0.85 * playback.speed:
        words.append(f"running at {actual:.2g}×")
    if playback.perturbed:
        words.append("perturbed")
    shown = playback.snapshot
    if shown is not None and shown.dropped:
        words.append(f"contacts left out in {shown.dropped} of {plural(shown.step, 'step')}")
    return words


def speed_words(speed: float) -> str:
    """Return a speed as people say it: `2×`, `1/4×`."""
    return f"{speed:g}×" if speed >= 1 else f"1/{round(1 / speed)}×"


def _keys(session: "Session", column: _Column) -> None:
    """Draw the keys of the level and what they drive; held ones are lit."""
    level = session.playback.level
    if level is None or not session.settings.key_caps:
        return
    keys = session.control_keys
    side = px(19)
    for channel in channels_in_use(level):
        if column.y + side > column.bottom:
            return
        driving = sorted((d.value, key) for key, d in keys.items() if d.channel == channel)
        x = column.x
        with font(FONTS.bold, SMALL - 1):
            for _, key in driving:
                words, lit = GLYPHS.get(key, key.upper()), key in session.hands.held
                extent = imgui.calc_text_size(words)
                wide = max(extent.x + px(9), side)
                plate = (x, column.y), (x + wide, column.y + side)
                draw_key_plate(column.draw, *plate, lit=lit)
                ink = COLOURS.backdrop if lit else COLOURS.text
                at = (x + (wide - extent.x) / 2, column.y + (side - extent.y) / 2)
                column.draw.add_text(at, u32(ink), words)
                x += wide + px(3)
        names = [session.document.spoken_name_of(entity) for entity in driven_by(level, channel)]
        offset = x + px(6) - column.x
        with font(FONTS.regular, SMALL):
            words = fitted(", ".join(names), column.width - offset)
            at = (column.x + offset, column.y + (side - imgui.get_text_line_height()) / 2)
            column.draw.add_text(at, u32(COLOURS.muted), words)
        column.y += side + px(5)
    column.gap(10)


def _goal(session: "Session", column: _Column) -> None:
    """Write the level's description, if there is room under the keys."""
    level = session.playback.level
    words = level.description if level is not None else ""
    if not words:
        return
    with font(FONTS.regular, SMALL):
        height = len(broken(words, column.width)) * (imgui.get_text_line_height() + px(4))
    if column.y + height < column.bottom:
        column.lines(words, COLOURS.muted)
