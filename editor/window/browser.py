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
from editor.window.file_choice import LEVEL, FileChoice, nothing_here
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from kinetix.level.geometry import ARENA_WIDTH
from kinetix.level.model import Level
from kinetix.paths import levels_dir, user_levels_dir, working_dir

if TYPE_CHECKING:
    from editor.session import Session

_PREVIEW: Final = 210.0
_PATH: Final = 120.0
"""Room that the path of the folder needs beside the buttons [px at 100 %]."""
_FOLDER_HINT: Final = "Go into the folder that you mean, or type its path"


@functools.lru_cache(maxsize=64)
def peek(path: str, modified_ns: int) -> Level | str:
    """Return the level in a file, or the sentence that says what is wrong with it."""
    del modified_ns
    try:
        return load_level(path)
    except KinetixError as error:
        return str(error)


def _modified(path: Path) -> int:
    """Return when a file was last written [ns]; 0 for a broken link or a deleted file."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


class FileBrowser:
    """One question's browser."""

    def __init__(self, question: FileQuestion) -> None:
        self._question = question
        self._choice = FileChoice(question)

    def draw(self, session: "Session") -> tuple[bool, Path | None]:
        """Draw it into the current window.

        Returns:
            Whether the user is done, and the path or None.
        """
        with widgets.font(FONTS.bold, 18):
            widgets.wrapped(self._question.title)
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
        home, here = Path.home(), working_dir()
        places = [
            (f"{Icons.up}", self._choice.folder.parent),
            ("My levels", user_levels_dir()),
            ("Levels", levels_dir()),
            ("Home folder", home),
        ]
        if here not in (home, Path(here.anchor)):
            places.append(("Here", here))  # the app was started in a terminal
        for index, (label, folder) in enumerate(places):
            if index:
                widgets.beside_words(label, gap=4)
            name = f"browser.place.{index}"
            if widgets.button(session, name, label):
                self._choice.go(folder)
            widgets.tooltip(str(folder))
        widgets.beside(_PATH, gap=10)
        imgui.align_text_to_frame_padding()
        room = imgui.get_content_region_avail().x - px(6)
        widgets.raw(widgets.fitted_path(self._choice.folder, room), COLOURS.muted)

    def _list(self, session: "Session", size: tuple[float, float]) -> bool:
        """The folder's content; returns whether a file was chosen by a double click."""
        chosen = False
        imgui.push_style_color(imgui.Col_.child_bg, imgui.ImVec4(*COLOURS.surface))
        imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(6), px(6)))
        imgui.begin_child("files", size, imgui.ChildFlags_.always_use_window_padding.value)
        entries = self._choice.entries()
        if not entries:
            widgets.muted(self._choice.unreadable or nothing_here(self._question))
        if self._choice.hidden:
            widgets.muted(self._choice.hidden)
        for path in entries:
            folder = os.path.isdir(path)
            if not self._row(session, path, folder=folder):
                continue
            twice = imgui.is_mouse_double_clicked(0)
            if folder:
                self._choice.go(path)
            else:
                self._choice.pick(path)
                chosen = twice
        imgui.end_child()
        imgui.pop_style_var()
        imgui.pop_style_color()
        return chosen

    def _row(self, session: "Session", path: Path, *, folder: bool) -> bool:
        """One entry, level files with a small picture; returns whether it was clicked."""
        start = imgui.get_cursor_screen_pos()
        height = px(26 if folder else 44)
        chosen = not folder and path.name == self._choice.name
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
        if path.suffix.lower() != LEVEL or self._question.about is not None:
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
        path = self._choice.folder / self._choice.name if self._choice.name else None
        if self._choice.folders_only:
            self._about_folder()
            imgui.end_child()
            return
        if path is None or not os.path.isfile(path):
            if LEVEL in self._question.suffixes and self._question.about is None:
                widgets.small("Choose a level to see it here.")
            imgui.end_child()
            return
        if self._question.about is not None:
            widgets.wrapped(_told(self._question.about, path, _modified(path)))
            imgui.end_child()
            return
        if path.suffix.lower() != LEVEL:
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
        told = self._question.describe(self._choice.folder)
        if told:
            widgets.wrapped(told)
        else:
            widgets.small(f"Go into the folder of {self._question.wanted}.")

    def _footer(self, session: "Session", chosen: bool) -> tuple[bool, Path | None]:
        if self._choice.folders_only:
            return self._folder_footer(session)
        accept = "Save" if self._choice.saving else "Open"
        entered = self._name_field(session, "File name, or a path")
        warning = self._choice.told(accept)
        if warning:
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
        if (pressed or chosen or entered) and self._choice.name:
            return self._choice.accept()
        return False, None

    def _warn(self, words: str, room: float) -> None:
        """Report in one line what is wrong; what has no room is in the tooltip."""
        with widgets.font(None, SMALL):
            shown = widgets.fitted(tr(words), room)
            widgets.raw(shown, COLOURS.warn)
        if shown.endswith("…"):
            widgets.tooltip(words)

    def _name_field(self, session: "Session", hint: str) -> bool:
        """Draw the field that takes a typed name or path; whether Return was pressed in it."""
        imgui.set_next_item_width(-1)
        if self._choice.to_name or imgui.is_window_appearing():
            imgui.set_keyboard_focus_here()
            self._choice.to_name = False
        flags = imgui.InputTextFlags_.enter_returns_true.value
        entered, name = widgets.input_line("browser.name", hint, self._choice.name, flags)
        widgets.probe(session, "browser.name")
        self._choice.enter(name)
        self._choice.to_name = entered
        return entered

    def _folder_footer(self, session: "Session") -> tuple[bool, Path | None]:
        """Draw the buttons for choosing a folder: the one on show is meant."""
        fresh = self._question.fresh
        hint = "Go into a folder, or type the name of a new one" if fresh else _FOLDER_HINT
        entered = self._name_field(session, hint)
        if self._choice.error:
            widgets.small(self._choice.error, COLOURS.warn)
        named = self._choice.fresh()
        if entered and named is not None:
            return True, named
        typed = bool(self._choice.name)
        if entered and typed:
            self._choice.type_folder()
        width = px(150)
        gap = imgui.get_style().item_spacing.x
        room = imgui.get_content_region_avail().x - 2 * width - gap
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(room, 0.0))
        cancelled = widgets.button(session, "browser.cancel", "Cancel", width=width)
        imgui.same_line()
        describe = self._question.describe
        fits = describe is None or bool(describe(self._choice.folder))
        words = "Use this folder" if named is None else "Make this folder"
        with widgets.disabled(not fits and named is None):
            pressed = widgets.primary_button(session, "browser.accept", words, width=width)
        if named is None and not fits:
            widgets.tooltip(words, f"It is not {self._question.wanted}.")
        if (pressed or (entered and not typed)) and (fits or named is not None):
            return True, named or self._choice.folder
        return cancelled, None


@functools.lru_cache(maxsize=32)
def _told(about: Callable[[Path], str], path: Path, modified_ns: int) -> str:
    """Return what a file is; it is read once, and again when it has changed."""
    del modified_ns
    return about(path)


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
