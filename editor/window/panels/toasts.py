"""Short messages in the window's lower right corner, beside the arena; they go by themselves."""

import functools
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions import BY_ID
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons, alpha, u32
from editor.toolkit.widgets import KIND_ICONS, kind_colour, px
from editor.window.panels.guide import Rect

if TYPE_CHECKING:
    from editor.session import Session
    from editor.session.messages import Toast

_FLAGS: Final = (
    imgui.WindowFlags_.no_decoration.value
    | imgui.WindowFlags_.always_auto_resize.value
    | imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_focus_on_appearing.value
    | imgui.WindowFlags_.no_nav.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_docking.value
)
_SHOWN_MAX: Final = 4
_LEAST: Final = 230.0
"""Width that a message has at least, also where the arena leaves less [px at 100 %]."""
_LEAST_WORDS: Final = 120.0
"""Width of its text at least: a button that would leave less stands below [px at 100 %]."""
_GAP: Final = 8.0
_CROSS: Final = 20.0
_BEFORE_CROSS: Final = 10.0
_BEFORE_BUTTON: Final = 12.0
_FADE_SECONDS: Final = 0.4
_BUTTONS: Final[dict[str, str]] = dict.fromkeys(
    ("edit.undo", "gallery.restore", "gallery.set_back", "file.undiscard"), "Undo"
)


class Toasts:
    """Stacks the newest messages, the newest lowest."""

    def draw(
        self,
        session: "Session",
        area: tuple[tuple[float, float], tuple[float, float]],
        *,
        beside: float = 0.0,
        card: Rect | None = None,
    ) -> None:
        """Draw them in the lower right corner, where the level is not.

        Args:
            session: Whose toasts.
            area: Upper left corner and size of what lies between the bars [px].
            beside: Right edge of the arena [px]; 0: there is none.
            card: What they stand above where they would cover it [px].
        """
        (x, y), (width, height) = area
        room = min(px(460), width - px(28))
        if beside:
            room = min(room, max(x + width - beside - px(28), px(_LEAST)))
        bottom = y + height - px(14)
        for number, toast in enumerate(reversed(session.toasts[-_SHOWN_MAX:])):
            if card is not None and self._meets(number, x + width - px(14) - room, bottom, card):
                bottom = card[0][1] - px(_GAP)
            left = toast.until - session.time
            opacity = 1.0
            if not session.settings.reduced_motion:
                opacity = max(min(left / _FADE_SECONDS, 1.0), 0.02)
            imgui.push_style_var(imgui.StyleVar_.alpha, opacity)
            imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(14), px(9)))
            imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*alpha(COLOURS.raised, 0.97)))
            imgui.set_next_window_pos((x + width - px(14), bottom), 0, (1.0, 1.0))
            imgui.set_next_window_size_constraints((0, 0), (room, px(400)))
            imgui.begin(_name(number), None, _FLAGS)
            if not imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value):
                # Menus and questions stay in front of messages.
                imgui.internal.bring_window_to_display_front(imgui.internal.get_current_window())
            colour = kind_colour(toast.kind)
            at, size = imgui.get_window_pos(), imgui.get_window_size()
            draw = imgui.get_window_draw_list()
            draw.add_rect_filled(
                (at.x, at.y + px(6)), (at.x + px(3), at.y + size.y - px(6)), u32(colour), px(2)
            )
            widgets.text(KIND_ICONS[toast.kind], colour)
            imgui.same_line(0, px(9))
            self._words(session, toast, number, room)
            if imgui.is_window_hovered():
                session.queue(functools.partial(session.messages.hold, toast))
            bottom -= imgui.get_window_size().y + px(_GAP)
            imgui.end()
            imgui.pop_style_color()
            imgui.pop_style_var(2)

    def _meets(self, number: int, left: float, bottom: float, card: Rect) -> bool:
        """Return whether a message whose lower edge is at `bottom` would cover the card."""
        known = imgui.internal.find_window_by_name(_name(number))
        height = known.size.y if known is not None else px(2 * _CROSS)
        (_, upper), (right, lower) = card
        return right > left and upper < bottom and lower > bottom - height - px(_GAP)

    def _words(self, session: "Session", toast: "Toast", number: int, room: float) -> None:
        """Draw the text, the button beside or below it, and the cross."""
        action, label = toast.action, _label(toast.action)
        start, padding = imgui.get_cursor_pos_x(), imgui.get_style().window_padding.x
        cross = widgets.icon_width(Icons.close, px(_CROSS)) + px(_BEFORE_CROSS)
        button = imgui.calc_text_size(label).x + px(_BEFORE_BUTTON) if action else 0.0
        edge = max(room - padding - cross, start + px(_LEAST_WORDS))
        below = edge - button < start + px(_LEAST_WORDS)
        imgui.push_text_wrap_pos(edge if below else edge - button)
        widgets.text(toast.text)
        imgui.pop_text_wrap_pos()
        if action and not below:
            imgui.same_line(0, px(_BEFORE_BUTTON))
            self._button(session, action, label)
        imgui.same_line(0, px(_BEFORE_CROSS))
        # The cross is higher than a line of text: their middles meet.
        imgui.set_cursor_pos_y(
            imgui.get_cursor_pos_y() - (px(_CROSS) - imgui.get_text_line_height()) / 2
        )
        name = f"toast.{number}.close"
        if widgets.icon_button(session, name, Icons.close, height=px(_CROSS), tint=COLOURS.faint):
            session.queue(lambda: session.toasts.remove(toast))
        if action and below:
            imgui.set_cursor_pos_x(start)
            self._button(session, action, label)

    def _button(self, session: "Session", action_id: str, label: str) -> None:
        if imgui.text_link(label):
            session.queue(action_id)
        widgets.probe(session, f"toast.{action_id}")


def _name(number: int) -> str:
    """Return the id of the window of a message."""
    return f"##toast-{number}"


def _label(action_id: str | None) -> str:
    """Return the label of a message's button; empty without one."""
    if action_id is None:
        return ""
    return tr(_BUTTONS.get(action_id, BY_ID[action_id].label))
