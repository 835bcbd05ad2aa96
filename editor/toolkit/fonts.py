"""Letters that the app's own fonts lack, taken from the system's fonts where it has some.

Dear ImGui draws a letter when it first comes up, so that large fonts cost little. Pictures in
colour (most fonts of emoji) cannot be drawn: those with outlines can.
"""

import itertools
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import imgui_bundle
from imgui_bundle import imgui

FAMILIES: Final[dict[str, tuple[str, ...]]] = {
    "Chinese and Japanese": (
        *("wqy-microhei.ttc", "DroidSansFallbackFull.ttf", "DroidSansFallback.ttf"),
        *("wqy-zenhei.ttc", "NotoSansCJK-Regular.ttc", "NotoSansCJKsc-Regular.otf"),
        *("NotoSansSC-Regular.otf", "NotoSansJP-Regular.otf", "SourceHanSansSC-Regular.otf"),
        *("Hiragino Sans GB.ttc", "PingFang.ttc", "msyh.ttc", "YuGothR.ttc", "simsun.ttc"),
    ),
    "Korean": (
        *("NanumGothic.ttf", "UnDotum.ttf", "NotoSansCJK-Regular.ttc", "NotoSansKR-Regular.otf"),
        *("DroidSansFallback.ttf", "AppleSDGothicNeo.ttc", "malgun.ttf"),
    ),
    "other scripts and signs": (
        *("DejaVuSans.ttf", "Arial Unicode.ttf", "FreeSans.ttf", "seguisym.ttf"),
        *("NotoSans-Regular.ttf", "Apple Symbols.ttf"),
    ),
    "emoji": ("NotoEmoji-Regular.ttf", "Symbola_hint.ttf", "Symbola.ttf", "seguiemj.ttf"),
}
"""File names by what they are for, the one to prefer first: small ones, and those with outlines."""
_DEPTH: Final = 6
"""Folders within each other that are looked through."""
_OF_THE_TOOLKIT: Final = Path(imgui_bundle.__file__).parent / "demos_assets" / "fonts"
"""Folder of the font of emoji that comes with the toolkit, for systems that have none."""


def folders() -> tuple[Path, ...]:
    """Return where the system and the user have fonts."""
    home = Path(os.path.expanduser("~"))
    if sys.platform == "darwin":
        system = Path("/System/Library/Fonts")
        return system, Path("/Library/Fonts"), home / "Library" / "Fonts"
    if sys.platform == "win32":
        local = Path(os.environ.get("LOCALAPPDATA", home)) / "Microsoft" / "Windows" / "Fonts"
        return Path(os.environ.get("WINDIR", r"C:\Windows")) / "Fonts", local
    shared = os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share"
    own = os.environ.get("XDG_DATA_HOME") or home / ".local" / "share"
    return (
        Path(own) / "fonts",
        home / ".fonts",
        *(Path(each) / "fonts" for each in shared.split(":") if each),
    )


def found(places: Sequence[Path]) -> tuple[Path, ...]:
    """Return one font for each family that is there, in the order of the families.

    Args:
        places: Folders to look through.
    """
    wanted = set(itertools.chain.from_iterable(FAMILIES.values()))
    there: dict[str, Path] = {}
    for place in places:
        for folder, inner, names in os.walk(place):
            if len(Path(folder).parts) - len(place.parts) >= _DEPTH:
                inner.clear()
            for name in wanted.intersection(names):
                there.setdefault(name, Path(folder) / name)
    chosen = [
        next((there[name] for name in names if name in there), None) for names in FAMILIES.values()
    ]
    return tuple(dict.fromkeys(path for path in chosen if path is not None))


class Fallbacks:
    """Adds the system's fonts behind the app's, one in each frame, so that no frame waits."""

    def __init__(self, fonts: Sequence[imgui.ImFont], places: Sequence[Path] | None = None) -> None:
        """Prepare; nothing is read yet.

        Args:
            fonts: Fonts to add to.
            places: Folders to look through; by default the system's.
        """
        self._left = self._additions(fonts, places)
        self.loaded: list[Path] = []
        """Fonts that were added to every font."""

    def step(self) -> bool:
        """Add one font; call it between two frames. Returns whether there was one."""
        return next(self._left, False)

    def _additions(
        self, fonts: Sequence[imgui.ImFont], places: Sequence[Path] | None
    ) -> Iterator[bool]:
        for path in found((*folders(), _OF_THE_TOOLKIT) if places is None else places):
            for font in fonts:
                config = imgui.ImFontConfig()
                config.merge_mode = True
                config.dst_font = font
                if _readable(path):
                    imgui.get_io().fonts.add_font_from_file_ttf(str(path), 0.0, config)
                yield True
            self.loaded.append(path)


class DrawnLetters:
    """Has all letters drawn anew where the toolkit would draw further ones at a wrong size.

    Where its picture of letters is full, or a font is added, the toolkit lets go of sizes that are
    not needed and moves the others in its memory. FreeType's loader tells sizes apart by where they
    are, and would give one size the letters of another.
    """

    def __init__(self) -> None:
        self._sources = 0
        self._picture = 0
        self._anew = False

    def step(self) -> None:
        """Let go of all letters, if so; call it between two frames, after fonts were added."""
        fonts = imgui.get_io().fonts
        picture, sources = fonts.tex_data.unique_id if fonts.tex_data else 0, len(fonts.sources)
        # What the frame after such a step draws may need room too, and lets go of nothing.
        moved = picture != self._picture and not self._anew
        self._anew = moved or sources != self._sources
        self._picture, self._sources = picture, sources
        if self._anew:
            for font in fonts.fonts:
                imgui.internal.im_font_atlas_font_discard_bakes(fonts, font, 0)


def _readable(path: Path) -> bool:
    """Return whether a file begins as fonts do: the toolkit ends the app over anything else."""
    try:
        with path.open("rb") as file:
            return file.read(4) in (b"\0\1\0\0", b"OTTO", b"ttcf", b"true")
    except OSError:
        return False
