"""Every key of the app, to be changed: press the field, press the new key."""

import dataclasses
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions import rebinding
from editor.actions.keyed import Keyed, KeyedAction, KeyedDrive
from editor.base.controls import CHANNELS, Drive
from editor.base.language import tr
from editor.base.prompts import Choice, Question
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons
from editor.toolkit.keys import label as chord_label
from editor.toolkit.widgets import px
from editor.window.panels.menu import MENUS

if TYPE_CHECKING:
    from editor.session import Session

_DRIVING: Final = "Driving in Play"
_ALL: Final = "All as at first"
_KEYS: Final = 230.0
"""Width of the keys' column, at most half of what there is [px at 100 %]."""
_BUTTONS: Final = 64.0
"""Width of the buttons' column [px at 100 %]."""
_GROUPS: Final[tuple[tuple[str, tuple[Keyed, ...]], ...]] = (
    *(
        (menu, tuple(KeyedAction(action) for action in actions.ACTIONS if action.menu == menu))
        for menu in MENUS
    ),
    (
        _DRIVING,
        tuple(
            KeyedDrive(Drive(channel=channel, value=value))
            for channel in range(CHANNELS)
            for value in ((1, 2) if channel < 4 else (1,))
        ),
    ),
)
"""Titles and rows."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Clash:
    """A new key that means something else already."""

    target: Keyed
    chord: str
    other: str


class KeysWindow:
    """A window over everything while `session.view.keys` is on."""

    def __init__(self) -> None:
        self._typed = ""
        self._target: Keyed | None = None
        self._clash: _Clash | None = None

    def draw(self, session: "Session") -> None:
        """Draw the window of keys."""
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
        beside = imgui.calc_text_size(tr(_ALL)).x + 2 * imgui.get_style().frame_padding.x + px(10)
        beside += widgets.icon_width(Icons.close) + px(4) if self._typed else 0.0
        room = imgui.get_content_region_avail().x - beside
        imgui.set_next_item_width(max(min(px(300), room), px(100)))
        hint = f"{Icons.search}  Command or key"
        _, self._typed = widgets.input_line("keys.search", hint, self._typed)
        widgets.probe(session, "keys.search")
        if imgui.is_item_active() or (self._target is not None and imgui.is_mouse_clicked(0)):
            self._stop(session)
        if self._typed and widgets.clear_button(session, "keys.search"):
            self._typed = ""
        widgets.beside_words(_ALL, gap=10)
        with widgets.disabled(not rebinding.any_changed(session)):
            if widgets.button(session, "keys.reset_all", _ALL):
                self._stop(session)
                session.queue(lambda: _ask_reset(session))
        self._message(session)
        imgui.dummy((0, px(4)))

    def _message(self, session: "Session") -> None:
        """Draw the instruction, or the question about a key that is taken."""
        imgui.align_text_to_frame_padding()
        if self._clash is not None:
            clash = self._clash
            label = clash.target.label
            widgets.wrapped(
                f"{Icons.warning}  {chord_label(clash.chord)} is taken: {clash.other}. "
                f"Give it to {label}?",
                COLOURS.warn,
            )
            widgets.beside_words("Use it here", gap=10)
            if widgets.button(session, "keys.take", "Use it here"):
                self._give(session, clash.target, clash.chord)
            widgets.beside_words("Keep it there")
            if widgets.button(session, "keys.leave", "Keep it there"):
                self._clash = None
        elif self._target is not None:
            label = self._target.label
            widgets.wrapped(f"{label}: press the new key. Esc keeps the old one.", COLOURS.accent)
        else:
            widgets.wrapped("Click a key, then press another one.", COLOURS.muted)

    def _rows(self, session: "Session") -> None:
        found = False
        for title, rows in _GROUPS:
            names = (title,) if title == _DRIVING else ()
            chosen = [row for row in rows if self._finds((row.label, *names), row.chords(session))]
            if chosen:
                found = True
                self._group(session, title, chosen)
        if not found:
            widgets.wrapped(f"Nothing here is called {self._typed}.", COLOURS.muted)

    def _group(self, session: "Session", title: str, rows: Sequence[Keyed]) -> None:
        with widgets.font(FONTS.bold, SMALL):
            widgets.raw(tr(title).upper(), COLOURS.accent)
        if imgui.begin_table(f"keys-{title}", 3, imgui.TableFlags_.sizing_stretch_prop.value):
            imgui.table_setup_column("what", imgui.TableColumnFlags_.width_stretch.value)
            fixed = imgui.TableColumnFlags_.width_fixed.value
            room = imgui.get_content_region_avail().x - px(_BUTTONS)
            imgui.table_setup_column("keys", fixed, min(px(_KEYS), room / 2))
            imgui.table_setup_column("reset", fixed, px(_BUTTONS))
            for row in rows:
                imgui.table_next_row()
                self._row(session, row)
            imgui.end_table()
        imgui.dummy((0, px(8)))

    def _row(self, session: "Session", row: Keyed) -> None:
        imgui.table_next_column()
        imgui.align_text_to_frame_padding()
        widgets.text(row.label)
        if row.tooltip:
            widgets.tooltip(row.label, row.tooltip)
        imgui.table_next_column()
        self._field(session, row)
        # No key, and as at first, where that would change something.
        imgui.table_next_column()
        if row.chords(session):
            if widgets.icon_button(session, f"keys.clear.{row.name}", Icons.close):
                session.queue(lambda: row.unbind(session))
            widgets.tooltip("No key")
            imgui.same_line(0, px(2))
        if row.changed(session):
            if widgets.icon_button(session, f"keys.reset.{row.name}", Icons.reset):
                session.queue(lambda: _reset(session, row))
            widgets.tooltip("As at first")

    def _field(self, session: "Session", target: Keyed) -> None:
        words = "   ".join(map(chord_label, target.chords(session)))
        waiting = self._target == target
        shown = "…" if waiting else words or "none"
        colour = COLOURS.accent if waiting else (COLOURS.text if words else COLOURS.faint)
        with widgets.coloured(text=colour):
            pressed = widgets.button(session, f"keys.{target.name}", shown, width=-1.0)
        if pressed:
            self._target, self._clash = target, None
            session.hands.capture = lambda chord: self._pressed(session, chord)

    def _pressed(self, session: "Session", chord: str) -> None:
        """Take the key that was pressed; it means nothing else this time."""
        target, self._target = self._target, None
        session.hands.capture = None
        if target is None or chord == "escape":
            return
        if not target.takes(chord):
            session.complain(f"{chord_label(chord)} cannot drive: only a key by itself can.")
            return
        other = target.conflict(session, chord)
        if other:
            self._clash = _Clash(target=target, chord=chord, other=other)
        else:
            self._give(session, target, chord)

    def _give(self, session: "Session", target: Keyed, chord: str) -> None:
        self._clash = None
        target.bind(session, chord)

    def _finds(self, names: Iterable[str], chords: Iterable[str]) -> bool:
        """Return whether all that is typed is in the keys, or in the English or shown names."""
        shown = [part for name in names for part in (name, tr(name))]
        words = " ".join((*shown, *map(chord_label, chords))).lower()
        return all(word in words for word in self._typed.lower().split())


def _reset(session: "Session", target: Keyed) -> None:
    """The keys as at first, unless something else has them now."""
    for chord in target.first:
        other = target.conflict(session, chord)
        if other:
            session.complain(f"{chord_label(chord)} is {other} now.")
            return
    target.reset(session)


def _ask_reset(session: "Session") -> None:
    """Set all keys back, after asking: the changes are gone then."""

    def answer(choice: str) -> None:
        if choice == "reset":
            rebinding.reset_all(session)

    session.ask(
        Question(
            title="All keys as at first?",
            message="Every key that you have changed is lost.",
            choices=(
                Choice(id="reset", label=_ALL),
                Choice(id="cancel", label="Cancel"),
            ),
            default="cancel",
            cancel="cancel",
            answer=answer,
        )
    )
