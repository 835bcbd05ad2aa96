"""All settings in one window: appearance, editing, simulation, files and keys."""

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.playing import physics
from editor.base.language import languages
from editor.base.settings import ANGLE_STEPS, GRID_STEPS, TEXT_SCALES, Settings, settings_path
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, Icons
from editor.toolkit.widgets import px
from kinetix.engine.names import PHYSICS
from kinetix.paths import user_levels_dir
from kinetix.render.palette import PALETTES
from kinetix.wording import plural

if TYPE_CHECKING:
    from editor.session import Session

_SCALES: Final = (0.0, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
NUDGES: Final = (0.01, 0.02, 0.05, 0.1)
"""Choices of what an arrow key moves [m]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Row:
    """One setting: a box to tick, or a list where there are options."""

    name: str
    """Field of the settings."""
    label: str
    detail: str = ""
    options: tuple[tuple[Any, str], ...] = ()
    take: Callable[["Session", Any], None] | None = None
    """Effect of a choice besides writing the field."""


PAGES: Final[dict[str, tuple[Row, ...]]] = {
    "Appearance": (
        Row(name="language", label="Language", options=languages()),
        Row(name="theme", label="Theme", options=(("dark", "Dark"), ("light", "Light"))),
        Row(
            name="ui_scale",
            label="Size of the interface",
            options=tuple((s, f"{s:.0%}" if s else "As the display says") for s in _SCALES),
        ),
        Row(
            name="text_scale",
            label="Size of the text",
            options=tuple((s, f"{s:.0%}") for s in TEXT_SCALES),
        ),
        Row(
            name="palette",
            label="Colours of levels",
            options=tuple((name, palette.label) for name, palette in PALETTES.items()),
        ),
        Row(name="glyphs", label="Role marks on shapes"),
        Row(name="patterns", label="Role patterns on shapes"),
        Row(name="key_caps", label="Keys on joints and thrusters"),
        Row(name="names", label="Names of shapes, joints and thrusters"),
        Row(name="minimap", label="Map of the arena"),
        Row(name="reduced_motion", label="Reduced motion"),
    ),
    "Editing": (
        Row(name="snap_smart", label="Snap to other shapes", detail="Ctrl inverts it."),
        Row(name="snap_grid", label="Snap to the grid", detail="Ctrl inverts it."),
        Row(name="grid_visible", label="Show the grid"),
        Row(name="grid_step", label="Grid", options=tuple((s, f"{s:g} m") for s in GRID_STEPS)),
        Row(
            name="angle_step_deg",
            label="Angles snap to",
            options=tuple((s, f"{s:g}°") for s in ANGLE_STEPS),
        ),
        Row(name="radians", label="Show angles in radians"),
        Row(
            name="nudge_step",
            label="An arrow key moves by",
            options=tuple((s, f"{s:g} m") for s in NUDGES),
        ),
        Row(name="move_jointed", label="Jointed shapes move together"),
        Row(name="from_centre", label="Draw rectangles from their centre"),
        Row(name="keep_tool", label="A tool stays after it has drawn something"),
    ),
    "Mouse": (
        Row(
            name="wheel",
            label="Wheel and two fingers",
            options=(("zoom", "Zoom the view"), ("pan", "Move the view")),
            detail="With Ctrl they zoom.",
        ),
        Row(name="wheel_inverted", label="The wheel turns the other way"),
        Row(name="pinch", label="Two fingers that move apart zoom"),
    ),
    "Sound": (
        Row(name="sound", label="Sounds in Play"),
        Row(
            name="volume",
            label="Volume",
            options=tuple((v, f"{v:.0%}") for v in (0.2, 0.4, 0.6, 0.8, 1.0)),
        ),
        Row(name="win_effects", label="Show a win with confetti"),
    ),
    "Simulation": (
        Row(
            name="physics",
            label="Physics",
            options=tuple((name, name) for name in PHYSICS),
            take=physics.choose,
        ),
        Row(name="restart_automatically", label="Restart when an episode ends"),
    ),
}
"""Pages and their rows."""


_RESET: Final = 34.0
"""Width of the arrow that sets a row back [px at 100 %]."""


class PreferencesWindow:
    """A window over everything while `session.view.preferences` is on."""

    def __init__(self) -> None:
        self._page = next(iter(PAGES))

    def draw(self, session: "Session") -> None:
        """Draw the window of preferences."""
        if not session.view.preferences:
            return
        with widgets.raised_window("preferences-window", 640, 520):
            self._head(session)
            imgui.begin_child("rows")
            if self._page in PAGES:
                for row in PAGES[self._page]:
                    _row(session, row)
                if self._page == "Sound" and session.sound.fault:
                    widgets.small(session.sound.fault, COLOURS.warn)
            elif self._page == "Files":
                _files(session)
            else:
                _keys(session)
            imgui.end_child()

    def _head(self, session: "Session") -> None:
        with widgets.font(FONTS.bold, 22):
            widgets.text(f"{Icons.gear}  Preferences")
        imgui.same_line(imgui.get_window_width() - px(58))
        if widgets.icon_button(session, "preferences.close", Icons.close):
            session.view.preferences = False
        for index, page in enumerate((*PAGES, "Files", "Keys")):
            if index:
                widgets.beside_words(page, gap=4)
            name = f"preferences.{page}"
            chosen = page == self._page
            draw = widgets.primary_button if chosen else widgets.button
            if draw(session, name, page):
                self._page = page
        imgui.dummy((0, px(6)))


def choose(session: "Session", row: Row, value: Any) -> None:
    """Set a setting, with what that does besides."""
    if row.take is not None:
        row.take(session, value)
    else:
        setattr(session.settings, row.name, value)


def _row(session: "Session", row: Row) -> None:
    current = getattr(session.settings, row.name)
    name = f"preferences.{row.name}"
    if not row.options:
        changed, value = widgets.checkbox(session, name, row.label, current)
        if changed:
            session.queue(lambda: choose(session, row, value))
    else:
        imgui.align_text_to_frame_padding()
        widgets.text(row.label)
        space = imgui.get_window_width()
        imgui.same_line(min(px(250), 0.5 * space))
        room = imgui.get_content_region_avail().x
        imgui.set_next_item_width(min(px(220), room - px(_RESET + 8)))
        options = [(str(value), label) for value, label in row.options]
        known = dict(options).get(str(current), str(current))
        picked = widgets.choice(session, name, str(current), options, preview=known)
        if picked is not None:
            value = next(value for value, _ in row.options if str(value) == picked)
            session.queue(lambda: choose(session, row, value))
    default = getattr(_DEFAULTS, row.name)
    if current != default:
        widgets.beside(_RESET, gap=6)
        if widgets.icon_button(session, f"{name}.reset", Icons.reset, tint=COLOURS.faint):
            session.queue(lambda: choose(session, row, default))
        widgets.tooltip("Reset to default")
    if row.detail:
        widgets.beside_words(row.detail, gap=12)
        widgets.muted(row.detail)


def _files(session: "Session") -> None:
    """Draw the paths of files, and buttons that clear them."""
    for label, path in (
        ("Settings", settings_path()),
        ("Copies of unsaved levels", session.autosaves.folder.parent),
        ("Own levels", user_levels_dir()),
    ):
        widgets.text(label)
        widgets.small(str(path))
        imgui.dummy((0, px(2)))
    widgets.small("A level is copied two seconds after a change, and whenever play begins.")
    imgui.dummy((0, px(6)))
    recent = session.settings.recents
    with widgets.disabled(not recent):
        label = f"Forget {plural(len(recent), 'recent file')}" if recent else "No recent files"
        if widgets.button(session, "preferences.forget_recent", label):
            session.settings.recents = []


def _keys(session: "Session") -> None:
    widgets.wrapped("Every command and every control of a level can have another key.")
    imgui.dummy((0, px(4)))
    if widgets.button(session, "preferences.change_keys", "Change keys…"):
        session.view.preferences = False
        session.queue("app.keys")
    if widgets.button(session, "preferences.all_keys", "Show all keys"):
        session.view.preferences = False
        session.queue("app.help")
    widgets.small(f"{len(actions.ACTIONS)} commands; {len(session.settings.keys)} changed.")


_DEFAULTS: Final = Settings()
