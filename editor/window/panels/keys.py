"""Every key of the app, to be changed: press the field, press the new key."""

import dataclasses
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions import rebinding
from editor.actions.base import Action
from editor.base.controls import CHANNELS, Drive
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons
from editor.toolkit.keys import label as chord_label
from editor.toolkit.widgets import px
from editor.window.panels.menu import MENUS

if TYPE_CHECKING:
    from editor.session import Session

_DRIVING: Final = "Driving in Play"
_DRIVES: Final = tuple(
    Drive(channel=channel, value=value)
    for channel in range(CHANNELS)
    for value in ((1, 2) if channel < 4 else (1,))
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Clash:
    """A new key that means something else already."""

    target: Action | Drive
    chord: str
    other: str


class KeysWindow:
    """A window over everything while `session.view.keys` is on."""

    def __init__(self) -> None:
        self._typed = ""
        self._target: Action | Drive | None = None
        self._clash: _Clash | None = None

    def draw(self, session: "Session") -> None:
        """Draw it."""
        if not session.view.keys:
            self._stop(session)
            return
        with widgets.raised_window("keys-window", 720, 680):
            self._head(session)
            imgui.begin_child("rows")
            self._rows(session)
            imgui.end_child()

    def _stop(self, session: "Session") -> None:
        if self._target is not None:
            session.hands.capture = None
        self._target = self._clash = None

    def _head(self, session: "Session") -> None:
        with widgets.font(FONTS.bold, 22):
            widgets.text(f"{Icons.controls}  Change keys")
        imgui.same_line(imgui.get_window_width() - px(58))
        if widgets.icon_button(session, "keys.close", Icons.close):
            session.view.keys = False
        imgui.set_next_item_width(px(300))
        hint = f"{Icons.search}  Command or key"
        _, self._typed = widgets.input_line("keys.search", hint, self._typed)
        widgets.probe(session, "keys.search")
        imgui.same_line(0, px(10))
        with widgets.disabled(not rebinding.any_changed(session)):
            if widgets.button(session, "keys.reset_all", "All as at first"):
                session.queue(lambda: rebinding.reset_all(session))
        self._message(session)
        imgui.dummy((0, px(4)))

    def _message(self, session: "Session") -> None:
        """Draw the instruction, or the question about a key that is taken."""
        if self._clash is not None:
            clash = self._clash
            imgui.align_text_to_frame_padding()
            widgets.text(
                f"{Icons.warning}  {chord_label(clash.chord)} is taken: {clash.other}.",
                COLOURS.warn,
            )
            imgui.same_line(0, px(10))
            if widgets.button(session, "keys.take", "Use it here"):
                self._give(session, clash.target, clash.chord)
            imgui.same_line()
            if widgets.button(session, "keys.leave", "Keep it there"):
                self._clash = None
        elif self._target is not None:
            imgui.align_text_to_frame_padding()
            widgets.text("Press the new key. Esc keeps the old one.", COLOURS.accent)
        else:
            imgui.align_text_to_frame_padding()
            widgets.muted("Click a key, then press another one.")

    def _rows(self, session: "Session") -> None:
        for menu in MENUS:
            rows = [
                action
                for action in actions.ACTIONS
                if action.menu == menu and self._fits(session, action)
            ]
            if rows:
                self._group(session, menu, rows)
        drives = [drive for drive in _DRIVES if self._drive_fits(session, drive)]
        if drives:
            self._group(session, _DRIVING, drives)

    def _group(self, session: "Session", title: str, rows: list[Action] | list[Drive]) -> None:
        with widgets.font(FONTS.bold, SMALL):
            widgets.raw(tr(title).upper(), COLOURS.accent)
        if imgui.begin_table(f"keys-{title}", 3, imgui.TableFlags_.sizing_stretch_prop.value):
            imgui.table_setup_column("what", imgui.TableColumnFlags_.width_stretch.value)
            fixed = imgui.TableColumnFlags_.width_fixed.value
            imgui.table_setup_column("keys", fixed, px(230))
            imgui.table_setup_column("reset", fixed, px(64))
            for row in rows:
                imgui.table_next_row()
                if isinstance(row, Drive):
                    self._drive(session, row)
                else:
                    self._action(session, row)
            imgui.end_table()
        imgui.dummy((0, px(8)))

    def _action(self, session: "Session", action: Action) -> None:
        imgui.table_next_column()
        imgui.align_text_to_frame_padding()
        widgets.text(action.label)
        if action.tooltip:
            widgets.tooltip(action.label, action.tooltip)
        imgui.table_next_column()
        words = "   ".join(map(chord_label, actions.chords(session, action)))
        self._field(session, action, action.id, words)
        imgui.table_next_column()
        if actions.chords(session, action):
            if widgets.icon_button(session, f"keys.clear.{action.id}", Icons.close):
                session.queue(lambda: rebinding.unbind(session, action))
            widgets.tooltip("No key")
            imgui.same_line(0, px(2))
        if rebinding.changed(session, action):
            if widgets.icon_button(session, f"keys.reset.{action.id}", Icons.reset):
                session.queue(lambda: self._reset(session, action))
            widgets.tooltip("As at first")

    def _drive(self, session: "Session", drive: Drive) -> None:
        imgui.table_next_column()
        imgui.align_text_to_frame_padding()
        widgets.text(rebinding.drive_label(drive))
        imgui.table_next_column()
        words = "   ".join(map(chord_label, _driving(session, drive)))
        self._field(session, drive, f"drive.{drive.channel}.{drive.value}", words)
        imgui.table_next_column()

    def _field(self, session: "Session", target: Action | Drive, name: str, words: str) -> None:
        waiting = self._target == target
        shown = "…" if waiting else words or "none"
        colour = COLOURS.accent if waiting else (COLOURS.text if words else COLOURS.faint)
        with widgets.coloured(text=colour):
            pressed = widgets.button(session, f"keys.{name}", shown, width=px(220))
        if pressed:
            self._target, self._clash = target, None
            session.hands.capture = lambda chord: self._pressed(session, chord)

    def _reset(self, session: "Session", action: Action) -> None:
        """The keys of an action as at first, unless something else has them now."""
        for chord in action.keys:
            other = rebinding.conflict(session, action, chord)
            if other:
                session.complain(f"{chord_label(chord)} is {other} now.")
                return
        session.settings.keys.pop(action.id, None)

    def _pressed(self, session: "Session", chord: str) -> None:
        """Take the key that was pressed; it means nothing else this time."""
        target, self._target = self._target, None
        session.hands.capture = None
        if target is None or chord == "escape":
            return
        if isinstance(target, Drive):
            chord = chord.rpartition("+")[2] or chord
            other = rebinding.drive_conflict(session, target, chord)
        else:
            other = rebinding.conflict(session, target, chord)
        if other:
            self._clash = _Clash(target=target, chord=chord, other=other)
        else:
            self._give(session, target, chord)

    def _give(self, session: "Session", target: Action | Drive, chord: str) -> None:
        self._clash = None
        if isinstance(target, Drive):
            rebinding.bind_drive(session, target, chord)
        else:
            rebinding.bind(session, target, chord)

    def _fits(self, session: "Session", action: Action) -> bool:
        return self._finds((action.label,), actions.chords(session, action))

    def _drive_fits(self, session: "Session", drive: Drive) -> bool:
        return self._finds((rebinding.drive_label(drive), _DRIVING), _driving(session, drive))

    def _finds(self, names: Iterable[str], chords: Iterable[str]) -> bool:
        """Return whether all that is typed is in the keys, or in the English or shown names."""
        shown = [part for name in names for part in (name, tr(name))]
        words = " ".join((*shown, *map(chord_label, chords))).lower()
        return all(word in words for word in self._typed.lower().split())


def _driving(session: "Session", drive: Drive) -> list[str]:
    return [key for key, does in session.control_keys.items() if does == drive]
