"""The command palette: every action, recent file, level, scene and agent by a few letters."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor import actions, widgets
from editor.actions import agents, examples, file
from editor.keys import label as chord_label
from editor.look import COLOURS, SMALL, Icons, u32
from editor.widgets import px
from kinetix.paths import levels_dir

if TYPE_CHECKING:
    from editor.session import Session

_ROWS: Final = 12


@dataclasses.dataclass(frozen=True, kw_only=True)
class Entry:
    """Something that can be chosen."""

    label: str
    group: str
    keys: str = ""
    run: Callable[[], None]


def score(words: str, typed: str) -> float | None:
    """How well letters match in order; None when they do not. Less is better."""
    at, total, lower = -1, 0.0, words.lower()
    for letter in typed.lower().replace(" ", ""):
        following = lower.find(letter, at + 1)
        if following < 0:
            return None
        starts = following == 0 or lower[following - 1] in " -_/"
        total += (following - at - 1) * (0.3 if starts else 1.0)
        at = following
    return total + 0.01 * len(words)


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
        changed, self._typed = imgui.input_text_with_hint(
            "###palette.text", f"{Icons.search}  Command, level, scene or agent", self._typed
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
            widgets.muted("Nothing of that name.")
        first = max(0, self._index - _ROWS + 1)
        for index, entry in enumerate(found[first : first + _ROWS], start=first):
            if self._row(session, entry, index) or (entered and index == self._index):
                session.view.palette = False
                session.queue(entry.run)

    def _row(self, session: "Session", entry: Entry, index: int) -> bool:
        start = imgui.get_cursor_screen_pos()
        width = imgui.get_content_region_avail().x
        height = imgui.get_text_line_height() + px(9)
        pressed = imgui.selectable(f"###palette-{index}", index == self._index, 0, (0, height))[0]
        widgets.probe(session, f"palette.{index}")
        draw = imgui.get_window_draw_list()
        top = start.y + px(4)
        draw.add_text((start.x + px(8), top), u32(COLOURS.text), entry.label)
        with widgets.font(None, SMALL):
            words = entry.keys or entry.group
            size = imgui.calc_text_size(words)
            colour = COLOURS.muted if entry.keys else COLOURS.faint
            draw.add_text((start.x + width - size.x - px(8), top + px(1)), u32(colour), words)
        return pressed

    def _found(self, session: "Session") -> list[Entry]:
        # Scenes are imported when they are looked for: opening the palette must not wait.
        offered = self._entries + (scene_entries(session) if self._typed else [])
        rated = [
            (rating, number, entry)
            for number, entry in enumerate(offered)
            if (rating := score(entry.label, self._typed)) is not None
        ]
        if self._typed:
            rated.sort(key=lambda row: row[:2])
        return [entry for _, _, entry in rated]


def entries(session: "Session") -> list[Entry]:
    """Everything that can be chosen now."""
    found = [
        Entry(
            label=action.label,
            group=action.menu,
            keys=chord_label(chosen[0]) if (chosen := actions.chords(session, action)) else "",
            run=lambda action=action: session.queue(action.id),
        )
        for action in actions.ACTIONS
        if action.menu and actions.available(session, action) and action.id != "app.palette"
    ]
    for path in session.settings.recents:
        found.append(
            Entry(
                label=Path(path).name,
                group="Recent",
                run=lambda path=path: _open(session, path),
            )
        )
    for folder in sorted(levels_dir().glob("[sml]/*.json")):
        found.append(
            Entry(
                label=f"{folder.parent.name}/{folder.stem}",
                group="Level",
                run=lambda path=folder: _open(session, path),
            )
        )
    for path, name in agents.known_agents(session):
        found.append(
            Entry(
                label=name,
                group="Agent A",
                run=lambda path=path: agents.load_agent(session, path),
            )
        )
    return found


def scene_entries(session: "Session") -> list[Entry]:
    """The scenes of the accuracy suite, by id and name."""
    from kinetix.scenes import SCENES

    return [
        Entry(
            label=f"{scene.id} {scene.name}",
            group="Scene",
            run=lambda scene_id=scene.id: examples.open_scene(session, scene_id),
        )
        for scene in SCENES.values()
    ]


def _open(session: "Session", path: str | Path) -> None:
    file.open_path(session, path)
