"""The card of the guided first level: what to do next, how far one is, how to do without."""

from typing import TYPE_CHECKING, Final, TypeAlias

from imgui_bundle import imgui

from editor.actions import guide
from editor.base.camera import ARENA
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, alpha, u32
from editor.toolkit.widgets import px
from editor.window import layouts
from editor.window.hints import key_of

if TYPE_CHECKING:
    from editor.session import Session

_WIDTH: Final = 320.0
_NARROW: Final = 236.0
"""As wide as it is at least in Edit, and in a low window."""
_LEAST: Final = 190.0
"""Its least width in Play."""
_MARGIN: Final = 14.0
_GAP: Final = 4.0
_WINDOW: Final = "###guide"

Rect: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Upper left and lower right corner [px]."""


class GuideCard:
    """A small window in a lower corner, beside the arena; it can be moved, folded and closed."""

    def __init__(self) -> None:
        self.place: Rect | None = None
        """The rectangle of the card [px]; None while it is hidden."""
        self._dragged = False
        """True once it was dragged out of the corner."""
        self._at_bottom = True
        """True while its lower edge is where it may be at most."""

    def draw(self, session: "Session") -> None:
        """Draw it while somebody is guided."""
        guide.follow(session)
        number = session.settings.guide_step
        offered = number == guide.OFFERED and not session.editing
        if number == guide.CLOSED or offered or session.gallery.open:
            self.place = None
            return
        left, width = _corner(session)
        self._put(left=left)
        imgui.set_next_window_size((width, 0.0))
        flags = (
            imgui.WindowFlags_.no_docking.value
            | imgui.WindowFlags_.no_saved_settings.value
            | imgui.WindowFlags_.no_resize.value
            | imgui.WindowFlags_.no_focus_on_appearing.value
            | imgui.WindowFlags_.no_nav.value
        )
        with widgets.coloured(window_bg=COLOURS.raised, border=COLOURS.accent):
            imgui.push_style_var(imgui.StyleVar_.window_border_size, px(1.5))
            imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(16), px(12)))
            shown, kept = imgui.begin(tr(f"{self._title(number)}{_WINDOW}"), True, flags)
            if shown:
                self._content(session, number)
            at, size = imgui.get_window_pos(), imgui.get_window_size()
            self.place = (at.x, at.y), (at.x + size.x, at.y + size.y)
            imgui.end()
            imgui.pop_style_var(2)
        if not kept:
            session.queue(lambda: guide.close(session))

    def _put(self, *, left: bool) -> None:
        """Keep it between the bars; at the bottom it grows upwards when a step has more to say."""
        viewport = imgui.get_main_viewport()
        right = viewport.work_pos.x + viewport.work_size.x - px(_MARGIN)
        bottom = viewport.work_pos.y + viewport.work_size.y - px(_MARGIN)
        window = imgui.internal.find_window_by_name(_WINDOW)
        if self.place is None or window is None:
            self._dragged, self._at_bottom = False, True
        elif (window.pos.x, window.pos.y) != self.place[0]:
            self._dragged = True
            self._at_bottom = window.pos.y + window.size.y >= bottom
        if window is None or not self._dragged:
            if left:
                imgui.set_next_window_pos((viewport.work_pos.x + px(_MARGIN), bottom), 0, (0, 1))
            else:
                imgui.set_next_window_pos((right, bottom), 0, (1.0, 1.0))
            return
        edge, lower = window.pos.x + window.size.x, window.pos.y + window.size.y
        if self._at_bottom or edge > right or lower > bottom:
            lower = bottom if self._at_bottom else min(lower, bottom)
            imgui.set_next_window_pos((min(edge, right), lower), 0, (1.0, 1.0))

    def _title(self, number: int) -> str:
        if 0 <= number < len(guide.STEPS):
            return f"Your first level   {number + 1} of {len(guide.STEPS)}"
        return "Your first level"

    def _content(self, session: "Session", number: int) -> None:
        step = guide.current(session)
        if step is not None:
            self._progress(number)
            self._step(session, step)
        elif number == guide.OFFERED:
            widgets.wrapped(
                "New here? Build a car and drive it to its goal: ten small steps, right here in "
                "the editor."
            )
            self._buttons(session, "Not now", ("Start", guide.start))
        else:
            with widgets.font(FONTS.bold, 0.0):
                widgets.text("That is all there is to it.")
            widgets.wrapped(
                "F1 lists every key, Tools has ready-made parts, File ▸ New From other machines, "
                "and F6 lets an agent try your level.",
                COLOURS.muted,
            )
            self._buttons(session, "Close", ("Once more", guide.start))

    def _step(self, session: "Session", step: guide.Step) -> None:
        with widgets.font(FONTS.bold, 0.0):
            widgets.text(step.title)
        if step.action:
            key = key_of(session, step.action)
            if key:
                widgets.beside(60)
                widgets.key_caps(key)
        widgets.wrapped(step.words, COLOURS.muted)
        self._buttons(session, "Leave", ("Skip this step", guide.skip))

    def _progress(self, number: int) -> None:
        """A line that grows from step to step."""
        start, width = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
        draw, tall = imgui.get_window_draw_list(), px(4)
        end = (start.x + width, start.y + tall)
        draw.add_rect_filled(start, end, u32(alpha(COLOURS.text, 0.12)), tall / 2)
        share = (number + 0.5) / len(guide.STEPS)
        draw.add_rect_filled(
            start, (start.x + width * share, end[1]), u32(COLOURS.accent), tall / 2
        )
        imgui.dummy((width, px(8)))

    def _buttons(self, session: "Session", leave: str, go_on: tuple) -> None:
        imgui.dummy((0, px(4)))
        label, run = go_on
        # What is to be done is done on the canvas: skipping must not look like the way to go.
        kind = widgets.button if guide.current(session) else widgets.primary_button
        if kind(session, "guide.next", label):
            session.queue(lambda: run(session))
        widgets.beside_words(leave, gap=14)
        if widgets.button(session, "guide.close", leave):
            session.queue(lambda: guide.close(session))


def _corner(session: "Session") -> tuple[bool, float]:
    """Return whether it belongs to the left, and its width [px]: what a step is about is free.

    In Edit that is the canvas, what is below it and the Inspector: it stands over the left column,
    if there is one, else over the lower part of the right one. In Play it stands beside the arena.
    """
    viewport, camera = imgui.get_main_viewport(), session.camera
    (low, _), (high, _) = camera.to_screen(ARENA[0]), camera.to_screen(ARENA[1])
    end = viewport.work_pos.x + viewport.work_size.x
    dock = px(_NARROW + _MARGIN)
    before = camera.origin[0] - viewport.work_pos.x
    after = end - camera.origin[0] - camera.size[0]
    wide = layouts.room_now() is layouts.Room.WIDE
    left = wide and (not session.editing or before >= dock)
    if left:
        free = before if session.editing else low - viewport.work_pos.x
    else:
        free = after if session.editing and after >= dock else end - high
    narrow = session.editing or layouts.room_now() is layouts.Room.LOW
    least = px(_NARROW if narrow else _LEAST)
    return left, min(max(free - px(_MARGIN + _GAP), least), px(_WIDTH))
