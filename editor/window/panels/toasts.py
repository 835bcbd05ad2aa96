"""Short messages in the window's lower right corner, beside the arena; they go by themselves."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions import BY_ID
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons, alpha, u32
from editor.toolkit.widgets import KIND_ICONS, kind_colour, px

if TYPE_CHECKING:
    from editor.session import Session

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
_FADE_SECONDS: Final = 0.4
_BUTTONS: Final = {"edit.undo": "Undo", "gallery.restore": "Undo"}


class Toasts:
    """Stacks the newest messages, the newest lowest."""

    def draw(
        self,
        session: "Session",
        area: tuple[tuple[float, float], tuple[float, float]],
        *,
        beside: float = 0.0,
    ) -> None:
        """Draw them in the lower right corner, where the level is not.

        Args:
            session: Whose toasts.
            area: Upper left corner and size of what lies between the bars [px].
            beside: Right edge of the arena [px]; 0: there is none.
        """
        (x, y), (width, height) = area
        room = min(px(460), width - px(28))
        if beside:
            room = min(room, max(x + width - beside - px(28), px(_LEAST)))
        bottom = y + height - px(14)
        for number, toast in enumerate(reversed(session.toasts[-_SHOWN_MAX:])):
            left = toast.until - session.time
            opacity = 1.0
            if not session.settings.reduced_motion:
                opacity = max(min(left / _FADE_SECONDS, 1.0), 0.02)
            imgui.push_style_var(imgui.StyleVar_.alpha, opacity)
            imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(14), px(9)))
            imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*alpha(COLOURS.raised, 0.97)))
            imgui.set_next_window_pos((x + width - px(14), bottom), 0, (1.0, 1.0))
            imgui.set_next_window_size_constraints((0, 0), (room, px(400)))
            imgui.begin(f"##toast-{number}", None, _FLAGS)
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
            action = toast.action
            tail = px(72) if action else px(40)
            imgui.push_text_wrap_pos(max(room - tail, px(120)))
            widgets.text(toast.text)
            imgui.pop_text_wrap_pos()
            self._button(session, action)
            imgui.same_line(0, px(10))
            # The cross is higher than a line of text: their middles meet.
            imgui.set_cursor_pos_y(
                imgui.get_cursor_pos_y() - (px(20) - imgui.get_text_line_height()) / 2
            )
            if widgets.icon_button(
                session, f"toast.{number}.close", Icons.close, height=px(20), tint=COLOURS.faint
            ):
                session.queue(lambda toast=toast: session.toasts.remove(toast))
            bottom -= imgui.get_window_size().y + px(8)
            imgui.end()
            imgui.pop_style_color()
            imgui.pop_style_var(2)

    def _button(self, session: "Session", action_id: str | None) -> None:
        if action_id is None:
            return
        imgui.same_line(0, px(12))
        label = _BUTTONS.get(action_id, BY_ID[action_id].label)
        if imgui.text_link(tr(label)):
            session.queue(action_id)
        widgets.probe(session, f"toast.{action_id}")
