"""F1: every key that works, from the action table itself."""

from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.actions import ACTIONS, Context, chords
from editor.base.controls import key_caps
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons
from editor.toolkit.keys import label as chord_label
from editor.toolkit.widgets import px
from editor.window.panels.menu import MENUS
from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS

if TYPE_CHECKING:
    from editor.session import Session

_CHANGE: Final = "Change keys…"
_CONTEXTS: Final = {Context.EDIT: "in Edit", Context.PLAY: "in Play"}
_MOUSE: Final = (
    ("Wheel", "Zoom at the pointer"),
    ("Middle or right drag", "Pan"),
    ("Right click", "List what lies under the pointer"),
    ("Drag on empty canvas", "Rubber band; leftwards takes what it touches"),
    ("Shift+click", "Add to the selection"),
    ("Alt+click", "Next one underneath"),
    ("Shift while drawing", "Square, or one axis"),
    ("Alt while drawing", "From the centre"),
    ("Ctrl while dragging", "Turn snapping around"),
    ("Digits while drawing", "Set the size exactly"),
    ("Drag in Play", "Pull a body"),
    ("Gamepad", "Sticks turn motors, A and B fire thrusters, Start plays"),
)


class HelpOverlay:
    """A window over everything; Esc or F1 closes it."""

    def draw(self, session: "Session") -> None:
        """Draw it while `session.view.help` is on."""
        if not session.view.help:
            return
        with widgets.raised_window("help", 1060, 720):
            self._head(session)
            imgui.begin_child("keys")
            self._columns(session)
            imgui.end_child()

    def _head(self, session: "Session") -> None:
        width = imgui.calc_text_size(tr(_CHANGE)).x + 2 * imgui.get_style().frame_padding.x
        left = imgui.get_window_width() - px(68) - width
        with widgets.font(FONTS.bold, 22):
            words = tr(f"{Icons.controls}  Keys and gestures")
            room = left - imgui.get_cursor_pos_x() - px(10)
            widgets.raw(widgets.fitted(words, room), COLOURS.text)
        imgui.same_line(left)
        if widgets.button(session, "help.keys", _CHANGE):
            session.queue("app.help")
            session.queue("app.keys")
        imgui.same_line(imgui.get_window_width() - px(58))
        if widgets.icon_button(session, "help.close", Icons.close):
            session.view.help = False
        widgets.wrapped(
            "Make a level in which green can touch blue without ever touching red. "
            "Draw in Edit, try it in Play.",
            COLOURS.muted,
        )
        imgui.dummy((0, px(6)))

    def _columns(self, session: "Session") -> None:
        columns = max(1, min(3, int(imgui.get_content_region_avail().x / px(310))))
        groups = [(menu, rows_of(session, menu)) for menu in MENUS]
        groups.append(("Mouse", list(_MOUSE)))
        groups.append(("Driving", _driving(session)))
        groups = [(title, rows) for title, rows in groups if rows]
        if not imgui.begin_table("help", columns):
            return
        imgui.table_next_row()
        lengths = [0] * columns
        shares: list[list[tuple[str, list[tuple[str, str]]]]] = [[] for _ in range(columns)]
        for title, rows in groups:
            shortest = lengths.index(min(lengths))
            shares[shortest].append((title, rows))
            lengths[shortest] += len(rows) + 2
        for share in shares:
            imgui.table_next_column()
            for title, rows in share:
                self._group(title, rows)
        imgui.end_table()

    def _group(self, title: str, rows: list[tuple[str, str]]) -> None:
        with widgets.font(FONTS.bold, SMALL):
            widgets.raw(tr(title).upper(), COLOURS.accent)
        if imgui.begin_table(f"group-{title}", 2, imgui.TableFlags_.sizing_stretch_prop.value):
            fixed = imgui.TableColumnFlags_.width_stretch.value
            imgui.table_setup_column("keys", fixed, 0.47)
            imgui.table_setup_column("does", fixed, 0.53)
            for keys, label in rows:
                imgui.table_next_row()
                imgui.table_next_column()
                if title == "Mouse":
                    widgets.wrapped(keys)
                else:
                    _chords(keys.split("  "))
                imgui.table_next_column()
                widgets.wrapped(label, COLOURS.muted)
            imgui.end_table()
        imgui.dummy((0, px(10)))


def _chords(chords: list[str]) -> None:
    """Draw chords beside each other where the column has room, else below each other."""
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    for index, chord in enumerate(chords):
        after = imgui.get_item_rect_max().x + px(8)
        if index and after + widgets.width_of_caps(chord) <= edge:
            imgui.same_line(0, px(8))
        widgets.key_caps(chord)


def rows_of(session: "Session", menu: str) -> list[tuple[str, str]]:
    """Return keys and label of every action of a menu that has keys."""
    rows = []
    for action in ACTIONS:
        found = chords(session, action)
        if action.menu == menu and found:
            context = _CONTEXTS.get(action.context, "") if menu == "Run" else ""
            label = f"{action.label} {context}".strip()
            rows.append(("  ".join(chord_label(chord) for chord in found[:2]), label))
    return rows


def _driving(session: "Session") -> list[tuple[str, str]]:
    rows = []
    for channel in range(MOTOR_BINDINGS + THRUSTER_BINDINGS):
        caps = key_caps(channel, session.control_keys)
        thruster = channel >= MOTOR_BINDINGS
        number = channel - MOTOR_BINDINGS + 1 if thruster else channel + 1
        if caps:
            noun = "Thrusters" if thruster else "Motors"
            rows.append(("  ".join(caps), f"{noun} of group {number}"))
    return rows
