"""The in-app file browser: folders, level files with a thumbnail of the one chosen.

A system dialog is not used: on Linux it silently does nothing unless one of four helper programs
is installed.
"""

import functools
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.camera import PIXELS_PER_UNIT, Camera
from editor.base.language import tr
from editor.base.prompts import FileQuestion
from editor.base.wording import counts
from editor.drawing.vectors import Painter, Placement, paint_level, poses_of
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, Icons, u32
from editor.toolkit.widgets import px
from kinetix.errors import KinetixError
from kinetix.files.names import is_text
from kinetix.level.codec import load_level
from kinetix.level.geometry import ARENA_WIDTH
from kinetix.level.model import Level
from kinetix.paths import levels_dir, user_levels_dir, working_dir

if TYPE_CHECKING:
    from editor.session import Session

_PREVIEW: Final = 210.0
_LEVEL: Final = ".json"
_FOLDER_HINT: Final = "Go into the folder that you mean, or type its path"


@functools.lru_cache(maxsize=64)
def peek(path: str, modified_ns: int) -> Level | str:
    """The level in a file, or the sentence that says what is wrong with it."""
    del modified_ns
    try:
        return load_level(path)
    except KinetixError as error:
        return str(error)


def _modified(path: Path) -> int:
    """When a file was written last [ns]; 0 where a link leads nowhere or it has just gone."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


class FileBrowser:
    """One question's browser."""

    def __init__(self, question: FileQuestion) -> None:
        self._question = question
        self._folder = question.folder if self._can_show(question.folder) else Path.home()
        self._name = question.name
        self._filter = ""
        self._overwrite: Path | None = None
        self._error = ""
        self._hidden = ""
        """A line about the files that are not listed because their names are not text; or empty."""
        self._to_name = True
        """True if the keyboard goes to the name in the next frame."""

    @property
    def _saving(self) -> bool:
        return self._question.purpose == "save"

    @property
    def _folders_only(self) -> bool:
        return self._question.purpose == "folder"

    def draw(self, session: "Session") -> tuple[bool, Path | None]:
        """Draw it into the current window.

        Returns:
            Whether the user is done, and the path or None.
        """
        with widgets.font(FONTS.bold, 18):
            widgets.text(self._question.title)
        self._places(session)
        footer = imgui.get_frame_height() * 2 + px(22)
        space = imgui.get_content_region_avail()
        height = max(space.y - footer, px(80))
        wide = space.x > px(560)
        list_width = space.x - (px(_PREVIEW) + px(16) if wide else 0)
        chosen = self._list(session, (list_width, height))
        if wide:
            imgui.same_line(0, px(16))
            self._preview(height)
        return self._footer(session, chosen)

    def _places(self, session: "Session") -> None:
        for index, (label, folder) in enumerate(
            (
                (f"{Icons.up}", self._folder.parent),
                ("My levels", user_levels_dir()),
                ("Levels", levels_dir()),
                ("Home folder", Path.home()),
                ("Here", working_dir()),
            )
        ):
            if index:
                imgui.same_line(0, px(4))
            name = f"browser.place.{index}"
            if widgets.button(session, name, label):
                self._go(folder)
            widgets.tooltip(str(folder))
        imgui.same_line(0, px(10))
        imgui.align_text_to_frame_padding()
        words = str(self._folder)
        room = imgui.get_content_region_avail().x - px(6)
        while imgui.calc_text_size(words).x > room and "/" in words[2:]:
            words = "…/" + words.lstrip("…/").split("/", 1)[-1]
        widgets.muted(words)

    def _can_show(self, folder: Path) -> bool:
        """Return whether a folder is there; the user's own is made when something is saved."""
        return os.path.isdir(folder) or (not self._folders_only and folder == user_levels_dir())

    def _go(self, folder: Path) -> None:
        if self._can_show(folder):
            self._folder = folder
            self._filter, self._error = "", ""
            self._to_name = True

    def _entries(self) -> list[Path]:
        try:
            every = [path for path in self._folder.iterdir() if not path.name.startswith(".")]
        except OSError as error:
            if self._folder == user_levels_dir() and isinstance(error, FileNotFoundError):
                return []
            self._error = f"{self._folder}: {error.strerror or error}"
            return []
        found = [path for path in every if is_text(path.name)]
        hidden = len(every) - len(found)
        self._hidden = f"{hidden} here cannot be shown: no Unicode names." if hidden else ""
        kept = [
            path
            for path in found
            if os.path.isdir(path)
            or (path.suffix.lower() in self._question.suffixes and not self._question.as_folder)
        ]
        return sorted(kept, key=lambda path: (not os.path.isdir(path), path.name.lower()))

    def _list(self, session: "Session", size: tuple[float, float]) -> bool:
        """The folder's content; returns whether a file was chosen by a double click."""
        chosen = False
        imgui.push_style_color(imgui.Col_.child_bg, imgui.ImVec4(*COLOURS.surface))
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(6), px(6)))
        imgui.begin_child("files", size, imgui.ChildFlags_.always_use_window_padding.value)
        entries = self._entries()
        if not entries:
            widgets.muted(self._error or nothing_here(self._question))
        if self._hidden:
            widgets.muted(self._hidden)
        for path in entries:
            folder = os.path.isdir(path)
            if not self._row(session, path, folder=folder):
                continue
            twice = imgui.is_mouse_double_clicked(0)
            if folder:
                self._go(path)
            else:
                self._name, self._overwrite = path.name, None
                self._to_name, chosen = True, twice
        imgui.end_child()
        imgui.pop_style_var()
        imgui.pop_style_color()
        return chosen

    def _row(self, session: "Session", path: Path, *, folder: bool) -> bool:
        """One entry, level files with a small picture; returns whether it was clicked."""
        start = imgui.get_cursor_screen_pos()
        height = px(26 if folder else 44)
        chosen = not folder and path.name == self._name
        flags = imgui.SelectableFlags_.allow_double_click.value
        picked = imgui.selectable(f"###file-{path.name}", chosen, flags, (0, height))[0]
        widgets.probe(session, f"browser.{path.name}")
        if not imgui.is_item_visible():
            return picked
        draw = imgui.get_window_draw_list()
        middle = start.y + (height - imgui.get_text_line_height()) / 2
        if folder:
            describe = self._question.describe
            fits = describe is not None and bool(describe(path))
            icon, colour = (Icons.agent, COLOURS.good) if fits else (Icons.folder, COLOURS.info)
            draw.add_text((start.x + px(10), middle), u32(colour), icon)
            draw.add_text((start.x + px(38), middle), u32(COLOURS.text), path.name)
            return picked
        at = (start.x + px(4), start.y + px(3))
        spot = (start.x + px(16), middle)
        if path.suffix.lower() != _LEVEL or self._question.about is not None:
            icon = Icons.film if self._question.about is None else Icons.trophy
            draw.add_text(spot, u32(COLOURS.muted), icon)
        elif isinstance(level := peek(str(path), _modified(path)), str):
            draw.add_text(spot, u32(COLOURS.warn), Icons.warning)
        else:
            picture(draw, level, at, px(38))
        draw.add_text((start.x + px(54), middle), u32(COLOURS.text), path.name)
        return picked

    def _preview(self, height: float) -> None:
        imgui.begin_child("preview", (px(_PREVIEW), height))
        path = self._folder / self._name if self._name else None
        if self._folders_only:
            self._about_folder()
            imgui.end_child()
            return
        if path is None or not os.path.isfile(path):
            if _LEVEL in self._question.suffixes and self._question.about is None:
                widgets.small("Choose a level to see it here.")
            imgui.end_child()
            return
        if self._question.about is not None:
            widgets.wrapped(_told(self._question.about, path, _modified(path)))
            imgui.end_child()
            return
        if path.suffix.lower() != _LEVEL:
            widgets.small("No picture of this kind of file.")
            imgui.end_child()
            return
        level = peek(str(path), _modified(path))
        if isinstance(level, str):
            widgets.small(level, COLOURS.bad)
        else:
            thumbnail(level, px(_PREVIEW))
            with widgets.font(FONTS.bold, 0.0):
                widgets.own_words(level.name)
            if level.description:
                with widgets.font(None, SMALL):
                    widgets.own_words(level.description, COLOURS.muted)
            widgets.small(counts((*level.bodies, *level.joints, *level.thrusters)) or "Empty")
        imgui.end_child()

    def _about_folder(self) -> None:
        """Describe the folder on the screen, where a certain kind is asked for."""
        if self._question.describe is None:
            return
        told = self._question.describe(self._folder)
        if told:
            widgets.wrapped(told)
        else:
            widgets.small(f"Go into the folder of {self._question.wanted}.")

    def _footer(self, session: "Session", chosen: bool) -> tuple[bool, Path | None]:
        if self._folders_only:
            return self._folder_footer(session)
        accept = "Save" if self._saving else "Open"
        entered = self._name_field(session, "File name, or a path")
        if self._error or self._overwrite is not None:
            warning = self._error or f"{self._name} is there already. Press {accept} to replace it."
            self._warn(warning, imgui.get_content_region_avail().x - 2 * px(96) - px(40))
            imgui.same_line()
        width = px(96)
        gap = imgui.get_style().item_spacing.x
        room = imgui.get_content_region_avail().x - 2 * width - gap
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(room, 0.0))
        cancelled = widgets.button(session, "browser.cancel", "Cancel", width=width)
        imgui.same_line()
        pressed = widgets.primary_button(session, "browser.accept", accept, width=width)
        if cancelled:
            return True, None
        if (pressed or chosen or entered) and self._name:
            return self._accept()
        return False, None

    def _warn(self, words: str, room: float) -> None:
        """Say in one line what is wrong; what has no room is in the tooltip."""
        with widgets.font(None, SMALL):
            shown = widgets.fitted(tr(words), room)
            widgets.raw(shown, COLOURS.warn)
        if shown.endswith("…"):
            widgets.tooltip(words)

    def _name_field(self, session: "Session", hint: str) -> bool:
        """Draw the field that takes a typed name or path; whether Return was pressed in it."""
        imgui.set_next_item_width(-1)
        if self._to_name or imgui.is_window_appearing():
            imgui.set_keyboard_focus_here()
            self._to_name = False
        flags = imgui.InputTextFlags_.enter_returns_true.value
        before = self._name
        entered, self._name = widgets.input_line("browser.name", hint, self._name, flags)
        widgets.probe(session, "browser.name")
        if self._name != before:
            self._error, self._overwrite = "", None
        self._to_name = entered
        return entered

    def _folder_footer(self, session: "Session") -> tuple[bool, Path | None]:
        """The buttons when a folder is asked for: the one on show is meant."""
        fresh = self._question.fresh
        hint = "Go into a folder, or type the name of a new one" if fresh else _FOLDER_HINT
        entered = self._name_field(session, hint)
        if self._error:
            widgets.small(self._error, COLOURS.warn)
        named = self._fresh()
        if entered and named is not None:
            return True, named
        if entered and self._name:
            self._type_folder()
        width = px(150)
        gap = imgui.get_style().item_spacing.x
        room = imgui.get_content_region_avail().x - 2 * width - gap
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(room, 0.0))
        cancelled = widgets.button(session, "browser.cancel", "Cancel", width=width)
        imgui.same_line()
        describe = self._question.describe
        fits = describe is None or bool(describe(self._folder))
        words = "Use this folder" if named is None else "Make this folder"
        with widgets.disabled(not fits and named is None):
            pressed = widgets.primary_button(session, "browser.accept", words, width=width)
        if named is None and not fits:
            widgets.tooltip(words, f"It is not {self._question.wanted}.")
        if pressed and (fits or named is not None):
            return True, named or self._folder
        return cancelled, None

    def _fresh(self) -> Path | None:
        """Return the folder that is not there yet and was named, where that is allowed."""
        if not (self._question.fresh and self._name):
            return None
        path = self._typed()
        allowed = not os.path.exists(path) and os.path.isdir(path.parent)
        return path if allowed else None

    def _typed(self) -> Path:
        """Return the path that the name means, from the folder on show on."""
        try:
            return self._folder / Path(self._name).expanduser()
        except RuntimeError:  # ~ of a user that does not exist
            return self._folder / self._name

    def _type_folder(self) -> None:
        """Go to the folder whose name was typed."""
        path = self._typed()
        if os.path.isdir(path):
            self._go(path)
            self._name = ""
        else:
            self._error = f"There is no folder {path}."

    def _accept(self) -> tuple[bool, Path | None]:
        path = self._typed()
        as_folder = self._question.as_folder
        # Where a folder is saved its name means itself; with a slash, as in `sets/`, its inside.
        if os.path.isdir(path) and (not as_folder or self._name.endswith(("/", os.sep))):
            self._go(path)
            self._name = ""
            return False, None
        if self._saving:
            if path.name.lower() in self._question.suffixes:
                self._error = f"A name belongs before {path.name}."
                return False, None
            if as_folder:
                path = path.with_name(path.name.removesuffix(_LEVEL))
            elif path.suffix.lower() not in self._question.suffixes:
                path = path.with_name(f"{path.name}{self._question.suffixes[0]}")
            if os.path.isfile(path) and as_folder:
                self._error = f"{path.name} is a file: choose another name for the folder."
                return False, None
            if os.path.exists(path) and self._overwrite != path:
                self._overwrite = path
                return False, None
            return self._has(path.parent), path
        if not os.path.isfile(path):
            self._error = f"There is no file {path.name} here."
            return False, None
        return True, path

    def _has(self, folder: Path) -> bool:
        """Return whether a folder is there to save in; the user's own is made."""
        if folder != user_levels_dir():
            self._error = "" if os.path.isdir(folder) else f"There is no folder {folder}."
            return not self._error
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            self._error = f"{folder}: cannot be made: {error.strerror or error}"
            return False
        return True


@functools.lru_cache(maxsize=32)
def _told(about: Callable[[Path], str], path: Path, modified_ns: int) -> str:
    """Return what a file is; it is read once, and again when it has changed."""
    del modified_ns
    return about(path)


def nothing_here(question: FileQuestion) -> str:
    """Return what an empty folder is said to lack."""
    if question.purpose == "folder" or question.as_folder:
        return "No folders here."
    if question.suffixes == (_LEVEL,) and question.about is None:
        return "No folders and no level files here."
    return f"No folders and no {' or '.join(question.suffixes)} files here."


def thumbnail(level: Level, side: float) -> None:
    """A small picture of a level, drawn as vectors.

    Args:
        level: The level.
        side: Width and height [px].
    """
    at = imgui.get_cursor_screen_pos()
    picture(imgui.get_window_draw_list(), level, (at.x, at.y), side)
    imgui.dummy((side, side + px(4)))


def picture(draw: imgui.ImDrawList, level: Level, low: tuple[float, float], side: float) -> None:
    """A level at a place of the screen [px]."""
    high = (low[0] + side, low[1] + side)
    draw.push_clip_rect(low, high, True)
    camera = Camera(origin=low, size=(side, side), zoom=side / (PIXELS_PER_UNIT * ARENA_WIDTH))
    painter = Painter(draw=draw, camera=camera)
    painter.paper(grid=None)
    paint_level(painter, Placement(level=level, poses=poses_of(level)))
    draw.pop_clip_rect()
    draw.add_rect(low, high, u32(COLOURS.line), px(2))
