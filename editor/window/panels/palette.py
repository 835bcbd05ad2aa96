"""The command palette: every action, setting, field, file, scene and agent by a few letters."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions
from editor.actions.files import examples, file
from editor.actions.watching import agents
from editor.base.language import tr
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, SMALL, Icons, u32
from editor.toolkit.keys import label as chord_label
from editor.toolkit.widgets import px
from editor.window.panels.found import (
    Entry,
    field_entries,
    score,
    settings_entries,
    template_entries,
)
from kinetix.paths import levels_dir

if TYPE_CHECKING:
    from editor.session import Session

_ROWS: Final = 12
_BELOW: Final = 40.0
"""Room below the list, for the status line [px at 100 %]."""
_REFUSED: Final = 3.0
"""Penalty of disabled entries: they stand below entries that match nearly as well."""

_GROUPS: Final = {
    **dict.fromkeys(("Setting", "chosen", "on", "off"), 0.2),
    "Level": 0.4,
    **dict.fromkeys(("Scene", "Agent A"), 0.6),
}
"""The same for what is no command: `wheel` means the part before an agent of that name."""

_ALSO: Final = {
    "Mirror Left–Right": "Flip Horizontally",
    "Mirror Up–Down": "Flip Vertically",
    "Duplicate": "Clone",
    "Delete": "Remove Erase",
    "Rectangle": "Box Square",
    "Circle": "Ball Disc",
    "Joint": "Hinge Pivot Axle Pin",
    "Weld": "Glue Rigid",
    "Thruster": "Rocket Jet Engine",
    "Bring Forward": "To Front",
    "Send Back": "To Back",
    "Fit Arena": "Zoom All",
    "Frame Selection": "Zoom Selection",
    "Actual Size": "Zoom 100 %",
    "Open…": "Load Import",
    "Record Film": "Video GIF",
    "Export Clip…": "Video GIF",
    "Save Screenshot": "Picture PNG",
    "Play": "Run Start Simulate",
    "Let the Agent Play": "Watch AI Bot",
    "Evaluate…": "Measure Test",
    "Train on This Level": "Learn",
    "Preferences…": "Settings Options",
    "Bounciness": "Restitution Elasticity",
    "Density": "Mass Weight",
}
"""Synonyms from other programs, by label."""
_OTHER_WORDS: Final = 0.5
"""Penalty of an entry that fits by what others call it."""


def _row_height() -> float:
    return imgui.get_text_line_height() + px(9)


def _rows_with_room() -> int:
    """Return how many rows fit below the cursor: fewer in a low window."""
    viewport = imgui.get_main_viewport()
    bottom = viewport.work_pos.y + viewport.work_size.y - px(_BELOW)
    step = _row_height() + imgui.get_style().item_spacing.y
    return min(_ROWS, max(1, int((bottom - imgui.get_cursor_screen_pos().y) / step)))


class CommandPalette:
    """A line to type into and the best matches under it."""

    def __init__(self) -> None:
        self._typed = ""
        self._index = 0
        self._was_open = False
        self._entries: list[Entry] = []

    def draw(self, session: "Session") -> None:
        """Draw it while `session.view.palette` is on."""
        if not session.view.palette:
            self._was_open = False
            return
        appearing = not self._was_open
        if appearing:
            self._typed, self._index, self._was_open = "", 0, True
            self._entries = entries(session)
        viewport = imgui.get_main_viewport()
        at = (viewport.work_pos.x + viewport.work_size.x / 2, viewport.work_pos.y + px(60))
        imgui.set_next_window_pos(at, 0, (0.5, 0.0))
        imgui.set_next_window_size((min(px(620), viewport.work_size.x * 0.9), 0))
        imgui.push_style_color(imgui.Col_.window_bg, imgui.ImVec4(*COLOURS.raised))
        imgui.push_style_var(imgui.StyleVar_.window_border_size, 1.0)
        flags = (
            imgui.WindowFlags_.no_decoration.value
            | imgui.WindowFlags_.no_move.value
            | imgui.WindowFlags_.no_saved_settings.value
            | imgui.WindowFlags_.no_docking.value
            | imgui.WindowFlags_.always_auto_resize.value
        )
        imgui.begin("###palette", None, flags)
        if appearing:
            imgui.set_window_focus()
            imgui.set_keyboard_focus_here()
        self._contents(session)
        focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows.value)
        if imgui.is_key_pressed(imgui.Key.escape) or (not focused and not appearing):
            session.view.palette = False
        imgui.end()
        imgui.pop_style_var()
        imgui.pop_style_color()

    def _contents(self, session: "Session") -> None:
        imgui.set_next_item_width(-1)
        changed, self._typed = widgets.input_line(
            "palette.text",
            f"{Icons.search}  Command, setting, field, level, scene or agent",
            self._typed,
        )
        widgets.probe(session, "palette.text")
        if changed:
            self._index = 0
        found = self._found(session)
        step = int(imgui.is_key_pressed(imgui.Key.down_arrow)) - int(
            imgui.is_key_pressed(imgui.Key.up_arrow)
        )
        self._index = min(max(self._index + step, 0), max(len(found) - 1, 0))
        entered = imgui.is_key_pressed(imgui.Key.enter) or imgui.is_key_pressed(
            imgui.Key.keypad_enter
        )
        if not found:
            widgets.muted("No results")
        rows = _rows_with_room()
        first = max(0, self._index - rows + 1)
        for index, entry in enumerate(found[first : first + rows], start=first):
            if self._row(session, entry, index) or (entered and index == self._index):
                session.view.palette = False
                _choose(session, entry)

    def _row(self, session: "Session", entry: Entry, index: int) -> bool:
        start = imgui.get_cursor_screen_pos()
        width = imgui.get_content_region_avail().x
        height = _row_height()
        pressed = imgui.selectable(f"###palette-{index}", index == self._index, 0, (0, height))[0]
        widgets.probe(session, f"palette.{index}")
        draw = imgui.get_window_draw_list()
        top = start.y + px(4)
        ink = COLOURS.faint if entry.refusal else COLOURS.text
        draw.add_text((start.x + px(8), top), u32(ink), tr(entry.label))
        with widgets.font(None, SMALL):
            words = tr(entry.refusal) or entry.keys or tr(entry.group)
            size = imgui.calc_text_size(words)
            colour = COLOURS.muted if entry.keys and not entry.refusal else COLOURS.faint
            draw.add_text((start.x + width - size.x - px(8), top + px(1)), u32(colour), words)
        return pressed

    def _found(self, session: "Session") -> list[Entry]:
        # Scenes are imported when they are looked for: opening the palette must not wait.
        offered = self._entries + (scene_entries(session) if self._typed else [])
        rated = [
            (rating + _behind(entry), number, entry)
            for number, entry in enumerate(offered)
            if (rating := _score(entry.label, self._typed)) is not None
        ]
        if self._typed:
            rated.sort(key=lambda row: row[:2])
        return [entry for _, _, entry in rated]


def _behind(entry: Entry) -> float:
    """Return how far an entry stands behind one that fits as well."""
    return _GROUPS.get(entry.group, 0.0) + (_REFUSED if entry.refusal else 0.0)


def _score(label: str, typed: str) -> float | None:
    """Rate a label by its words, by those that the person reads, and by what others call it."""
    ratings = [score(words, typed) for words in dict.fromkeys((label, tr(label)))]
    elsewhere = score(_ALSO.get(label, ""), typed)
    ratings.append(None if elsewhere is None else elsewhere + _OTHER_WORDS)
    return min((rating for rating in ratings if rating is not None), default=None)


def entries(session: "Session") -> list[Entry]:
    """Return everything that can be looked for: what can be done now first."""
    found = [*_actions(session), *settings_entries(session), *field_entries(session)]
    found += [*template_entries(session), *_files(session)]
    for path, name in agents.known_agents(session):
        found.append(
            Entry(
                label=name,
                group="Agent A",
                run=lambda path=path: agents.choose_agent(session, path),
            )
        )
    found.sort(key=lambda entry: bool(entry.refusal))
    return found


def _actions(session: "Session") -> list[Entry]:
    """Return the rows of the action table; disabled ones have the reason."""
    return [
        Entry(
            label=f"Gallery: {action.label}" if _in_gallery(action) else action.label,
            group=action.menu,
            keys=chord_label(chosen[0]) if (chosen := actions.chords(session, action)) else "",
            refusal=actions.refusal(session, action),
            run=lambda action=action: session.queue(action.id),
        )
        for action in actions.ACTIONS
        if action.menu and action.id != "app.palette"
    ]


def _in_gallery(action: actions.Action) -> bool:
    """Return whether an action has a namesake in Edit: both delete, rename, copy."""
    return action.context is actions.Context.GALLERY


def _files(session: "Session") -> list[Entry]:
    """Return the recent files and the levels that came with the app."""
    recents = [(Path(path).name, "Recent", path) for path in session.settings.recents]
    bundled = sorted(levels_dir().glob("[sml]/*.json"))
    levels = [(f"{path.parent.name}/{path.stem}", "Level", str(path)) for path in bundled]
    return [
        Entry(label=label, group=group, run=lambda path=path: _open(session, path))
        for label, group, path in (*recents, *levels)
    ]


def scene_entries(session: "Session") -> list[Entry]:
    """Return the scenes of the accuracy suite, by id and name."""
    from kinetix.scenes import SCENES

    return [
        Entry(
            label=f"{scene.id} {scene.name}",
            group="Scene",
            run=lambda scene_id=scene.id: examples.open_scene(session, scene_id),
        )
        for scene in SCENES.values()
    ]


def _choose(session: "Session", entry: Entry) -> None:
    if entry.refusal:
        session.complain(f"{entry.label}: {entry.refusal}")
    else:
        session.queue(entry.run)


def _open(session: "Session", path: str | Path) -> None:
    file.open_path(session, path)
