"""The timeline of the episode: scrub, loop, see what happened when, start again from anywhere."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.base.controls import channel_name
from editor.play.mode import Mode
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons, alpha, u32
from editor.toolkit.modes import OUTCOME_LOOK
from editor.toolkit.widgets import px
from editor.window.hints import key_of
from editor.window.panels.base import Panel
from editor.worker.snapshots import ENGINE_STEPS_PER_SECOND, Snapshot
from kinetix.level.controls import channels_in_use

if TYPE_CHECKING:
    from editor.session import Session

_TRACK: Final = 44.0
_LANES: Final = 3
"""Rows of marks: contacts, changes of the action, ends."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mark:
    """Something that happened at a moment."""

    index: int
    kind: str
    """`contact`, `flip` or `end`."""
    words: str


MARKS: Final[dict[str, tuple[str, str]]] = {
    "contact": ("Contacts begin", "info"),
    "flip": ("Action changes", "warn"),
    "end": ("End", "good"),
}
"""Names of the colours of episodes' ends."""


def marks_of(moments: Sequence[Snapshot], controls: Mapping[int, str]) -> list[Mark]:
    """Return what happened in an episode: new contacts, changes of the action, the end.

    Args:
        moments: The episode.
        controls: Names of the entries of the action that drive anything; changes of others are
            none.
    """
    found: list[Mark] = []
    for index in range(1, len(moments)):
        before, now = moments[index - 1], moments[index]
        new = set(now.touching) - set(before.touching)
        if new:
            count = len(new)
            words = "a contact begins" if count == 1 else f"{count} contacts begin"
            found.append(Mark(index=index, kind="contact", words=words))
        was, played = before.action, now.action
        changed = [k for k in controls if was and played[k : k + 1] != was[k : k + 1]]
        if changed:
            names = ", ".join(controls[k] for k in changed)
            found.append(Mark(index=index, kind="flip", words=f"the action changes: {names}"))
        if now.outcome is not None:
            found.append(Mark(index=index, kind="end", words=now.outcome))
    return found


class Timeline(Panel):
    """A track with a cursor, lanes of marks, and the buttons of a player."""

    id, title, icon = "timeline", "Timeline", Icons.film

    def __init__(self) -> None:
        self._marks: tuple[int, list[Mark]] = (0, [])
        self._known: tuple[object, ...] = ()

    def draw(self, session: "Session") -> None:
        """Draw the buttons and the track."""
        session.viewer.timeline_open = True
        playback = session.playback
        moments = playback.moments
        if not playback.active or len(moments) < 2:
            widgets.empty_state(
                Icons.film,
                "Nothing to look back on yet",
                "Play with Space, or let an agent play with F6; then drag here to go back in time.",
            )
            return
        self._buttons(session, moments)
        self._track(session, moments)

    def _buttons(self, session: "Session", moments: Sequence[Snapshot]) -> None:
        replay = session.mode is Mode.REPLAY
        moving = session.playback.running if replay else session.mode is Mode.PLAYING
        shown = (
            ("run.pause", Icons.pause if moving else Icons.play, ""),
            ("run.step_back", Icons.step_back, ""),
            ("run.step", Icons.step, ""),
            ("run.loop_from", "[", "Loop from"),
            ("run.loop_to", "]", "Loop to"),
            ("run.loop_clear", Icons.close, "No loop"),
            ("run.start_here", Icons.user, "Start here"),
            ("file.export_clip", Icons.film, "Export clip"),
        )
        for index, (name, icon, label) in enumerate(shown):
            if index:
                imgui.same_line(0, px(2))
            action = actions.BY_ID[name]
            enabled = actions.available(session, action)
            words = label if imgui.get_window_width() > px(760) else ""
            if widgets.icon_button(session, f"timeline.{name}", icon, label=words, enabled=enabled):
                session.queue(name)
            widgets.tooltip(action.label, action.tooltip, key_of(session, name))
        imgui.same_line(0, px(14))
        imgui.align_text_to_frame_padding()
        index = session.playback.replay_index
        snapshot = moments[index]
        seconds = snapshot.step * snapshot.frame_skip / ENGINE_STEPS_PER_SECOND
        with widgets.font(FONTS.mono, SMALL):
            widgets.text(f"step {snapshot.step} of {moments[-1].step}   {seconds:.2f} s")

    def _track(self, session: "Session", moments: Sequence[Snapshot]) -> None:
        level = session.playback.level
        used = () if level is None else channels_in_use(level)
        marks = self._marks_of(moments, {k: channel_name(level, k) for k in used if level})
        at, space = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        width, height = max(space.x - px(8), px(60)), min(max(space.y, px(_TRACK)), px(96))
        imgui.invisible_button("track", (width, height))
        widgets.probe(session, "timeline.track")
        low, high = (at.x, at.y), (at.x + width, at.y + height)
        last = len(moments) - 1

        def x(index: float) -> float:
            return low[0] + px(6) + (width - px(12)) * index / last

        mouse = imgui.get_io().mouse_pos.x
        pointed = round((mouse - low[0] - px(6)) / (width - px(12)) * last)
        pointed = min(max(pointed, 0), last)
        if imgui.is_item_active():
            session.playback.running = False
            session.queue(lambda: session.playback.scrub(pointed))
        draw = imgui.get_window_draw_list()
        draw.add_rect_filled(low, high, u32(COLOURS.field), px(5))
        loop = session.playback.loop
        if loop is not None:
            draw.add_rect_filled(
                (x(loop[0]), low[1]), (x(loop[1]), high[1]), u32(alpha(COLOURS.accent, 0.25))
            )
        self._lanes(draw, marks, moments, x, (low[1], height))
        cursor = x(session.playback.replay_index)
        draw.add_line((cursor, low[1]), (cursor, high[1]), u32(COLOURS.text), px(2))
        draw.add_circle_filled((cursor, low[1] + px(4)), px(5), u32(COLOURS.text))
        if imgui.is_item_hovered():
            self._tell(marks, moments, pointed)

    def _lanes(
        self,
        draw: imgui.ImDrawList,
        marks: Sequence[Mark],
        moments: Sequence[Snapshot],
        x: Callable[[float], float],
        span: tuple[float, float],
    ) -> None:
        top, height = span
        lane = (height - px(10)) / _LANES
        for mark in marks:
            _, name = MARKS[mark.kind]
            if mark.kind == "end":
                outcome = moments[mark.index].outcome
                name = name if outcome is None else OUTCOME_LOOK[outcome][2]
            colour = COLOURS.of(name)
            row = list(MARKS).index(mark.kind)
            low = top + px(8) + row * lane
            place = x(mark.index)
            if mark.kind == "end":
                draw.add_rect_filled(
                    (place - px(4), top + px(8)), (place + px(4), top + height), u32(colour), px(2)
                )
            else:
                draw.add_line((place, low), (place, low + lane * 0.8), u32(colour), px(2))

    def _tell(self, marks: Sequence[Mark], moments: Sequence[Snapshot], pointed: int) -> None:
        if not imgui.begin_tooltip():
            return
        widgets.text(f"step {moments[pointed].step}")
        near = max(len(moments) // 150, 1)
        for mark in marks:
            if abs(mark.index - pointed) <= near:
                with widgets.font(None, SMALL):
                    widgets.muted(f"step {moments[mark.index].step}: {mark.words}")
        imgui.end_tooltip()

    def _marks_of(self, moments: Sequence[Snapshot], controls: Mapping[int, str]) -> list[Mark]:
        """Return the marks, worked out again only when there is a new moment."""
        known = (moments[0], moments[-1], len(moments))
        if len(known) != len(self._known) or any(
            a is not b for a, b in zip(known[:2], self._known[:2], strict=True)
        ):
            self._known = known
            self._marks = (len(moments), marks_of(moments, controls))
        return self._marks[1]
