"""The keyboard: keys and text go to the app unless a field, a pop-up or a panel owns them.

A chord that means nothing in a text, such as Ctrl+S, takes what was typed and is the app's then; so
does the window's close button. Otherwise both would overlook what was typed last.
"""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions import dispatch
from editor.base import events
from editor.toolkit import keys

if TYPE_CHECKING:
    from editor.session import Session

_NAVIGATION: Final = frozenset({"left", "right", "up", "down", "space", "return", "tab", "escape"})
"""Keys that move between the fields of a panel while the keyboard is there."""
_TEXT_KEYS: Final = frozenset("acvxyz") | {
    *("left", "right", "up", "down", "home", "end", "page up", "page down"),
    *("backspace", "delete", "insert", "tab", "return", "enter", "space"),
}
"""Keys that do something in a text while Ctrl is down."""
_FUNCTION_KEYS: Final = frozenset(f"f{number}" for number in range(1, 13))


class Keyboard:
    """Hands keys on; remembers whether a pop-up was open, whose key Esc was."""

    def __init__(self) -> None:
        self._after_typing: list[events.InputEvent] = []
        """Events to handle once the panel has taken the text that was being typed."""
        self._popup = False
        """True if a pop-up was open in the last frame."""
        self._dragging = False
        """True if something was dragged from one panel to another in the last frame."""

    def take(self, session: "Session", *, submenu: bool, in_panel: bool) -> None:
        """Hand keys and text on unless a text field or a pop-up owns them.

        Args:
            session: The session.
            submenu: True if a menu of the menu bar is open.
            in_panel: True if the keyboard is in a panel.
        """
        io = imgui.get_io()
        modifiers = events.Modifiers(ctrl=io.key_ctrl, shift=io.key_shift, alt=io.key_alt)
        popup = bool(session.prompts) or imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)
        # Dear ImGui has closed the pop-up already: Esc belonged to it and is swallowed.
        closed, self._popup = self._popup and not popup, popup
        # The same holds for a drag from one panel to another.
        dragging = imgui.get_drag_drop_payload_py_id() is not None
        dragged, self._dragging = self._dragging, dragging
        # The palette has the keyboard from the key on that opens it, its field two frames later.
        typing = io.want_text_input or session.view.palette
        taken = (typing or popup) and session.hands.capture is None
        navigating = _navigation(session, popup=popup, closed=closed, in_panel=in_panel)
        there = imgui.is_popup_open("", imgui.PopupFlags_.any_popup.value)
        if submenu and there and imgui.is_key_pressed(imgui.Key.escape, False):
            # Dear ImGui closes the submenu alone, and the pointer that rests there opens it again.
            imgui.internal.close_popup_to_level(0, True)
        for name, key in keys.IMGUI.items():
            if imgui.is_key_released(key):
                actions.handle(
                    session, events.KeyEvent(key=name, pressed=False, modifiers=modifiers)
                )
            elif imgui.is_key_pressed(key, True):
                repeat = not imgui.is_key_pressed(key, False)
                event = events.KeyEvent(key=name, pressed=True, modifiers=modifiers, repeat=repeat)
                if name == "escape" and (closed or dragged or _closes_overlay(session)):
                    continue
                moves = name in navigating and not modifiers.ctrl and session.hands.capture is None
                if not taken and not moves:
                    actions.handle(session, event)
                elif _leaves_text(session, event) and not (session.prompts or session.view.palette):
                    self.leave_text(event)
        typed = "" if taken else "".join(chr(code) for code in io.input_queue_characters)
        if typed.strip() and session.gallery.open:
            session.gallery.search(typed)
        elif typed and session.driver.active:
            actions.handle(session, events.TextEvent(text=typed))

    def leave_text(self, event: events.InputEvent) -> None:
        """End the typing: its panel takes what was typed, then `hand_on` has the event handled.

        An open menu ends too.
        """
        imgui.internal.close_popups_except_modals()
        imgui.internal.clear_active_id()
        self._after_typing.append(event)

    def hand_on(self, session: "Session") -> None:
        """Handle what waited for the panels to be drawn, and for what they asked for."""
        waiting, self._after_typing = self._after_typing, []
        for event in waiting:
            actions.handle(session, event)


def _leaves_text(session: "Session", event: events.KeyEvent) -> bool:
    """Return whether a key means nothing to the text that is being typed, but to the app."""
    chord = event.modifiers.ctrl and event.key not in _TEXT_KEYS
    apart = chord or event.key in _FUNCTION_KEYS
    return apart and not event.repeat and dispatch.find(session, event.chord) is not None


def _closes_overlay(session: "Session") -> bool:
    """Let Esc close the help, the keys' window or the preferences; whether one was open."""
    shown = session.view
    if session.hands.capture is not None or session.prompts:
        return False
    if not shown.covered:
        return False
    shown.help = shown.keys = shown.preferences = False
    return True


def _navigation(session: "Session", *, popup: bool, closed: bool, in_panel: bool) -> frozenset[str]:
    """Return keys that move between the fields of a panel now, so that they are not the app's.

    The arrows nudge and drive, so they must not start Dear ImGui's navigation: it is only on
    while a pop-up is open, on the way from one menu of the bar to the next, or while the keyboard
    is in a panel already (Tab there, Esc back).
    """
    io = imgui.get_io()
    flag = imgui.ConfigFlags_.nav_enable_keyboard.value
    in_bar = imgui.get_current_context().nav_layer == imgui.internal.NavLayer.menu
    in_panel = in_panel and session.editing
    inside = (io.nav_visible and (in_panel or in_bar)) or (closed and in_bar)
    if popup or inside or io.want_text_input:
        io.config_flags |= flag
    else:
        io.config_flags &= ~flag
    keys_taken = _NAVIGATION if inside else frozenset()
    return keys_taken | {"tab"} if in_panel else keys_taken
