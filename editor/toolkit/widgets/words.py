"""Words: lines, badges, tooltips, what an empty panel says."""

import contextlib
from pathlib import Path
from typing import Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.toolkit.appearance import COLOURS, FONTS, SMALL, TITLE, Icons, Rgba, alpha, u32
from editor.toolkit.widgets.base import font, px
from editor.toolkit.widgets.caps import key_caps

_LONGEST: Final = 30
"""Letters of a name among several things in a line."""

MIXED: Final = "—"
"""Text of a field when the selected things differ."""


def raw(words: str, colour: Rgba | None = None) -> None:
    """A line of text as it is, in no other language; percent signs mean themselves."""
    imgui.push_style_color(imgui.Col_.text, imgui.ImVec4(*(colour or COLOURS.text)))
    imgui.text_unformatted(words)
    imgui.pop_style_color()


def text(words: str, colour: Rgba | None = None) -> None:
    """A line of text in the language of the app."""
    raw(tr(words), colour)


def muted(words: str) -> None:
    """A quiet line of text."""
    text(words, COLOURS.muted)


def wrapped(words: str, colour: Rgba | None = None) -> None:
    """Text that breaks at the panel's edge."""
    imgui.push_text_wrap_pos(0.0)
    text(words, colour)
    imgui.pop_text_wrap_pos()


def own_words(words: str, colour: Rgba | None = None) -> None:
    """Text of a person's own, in no other language, that breaks at the panel's edge."""
    imgui.push_text_wrap_pos(0.0)
    raw(words, colour)
    imgui.pop_text_wrap_pos()


def small(words: str, colour: Rgba | None = None) -> None:
    """Write words in small print."""
    with font(None, SMALL):
        wrapped(words, colour or COLOURS.muted)


def tooltip(title: str, detail: str = "", keys: str = "", *, own: bool = False) -> None:
    """Explains the last widget while the mouse rests on it (or the keyboard is there).

    Args:
        title: The first line.
        detail: What stands below it.
        keys: Chord shown beside the title.
        own: True if both are as they are, in no other language: names and paths.
    """
    if not imgui.is_item_hovered(
        imgui.HoveredFlags_.for_tooltip.value | imgui.HoveredFlags_.allow_when_disabled.value
    ):
        return
    imgui.push_style_var(imgui.StyleVar_.window_padding, imgui.ImVec2(px(10), px(7)))
    if imgui.begin_tooltip():
        raw(title if own else tr(title))
        if keys:
            imgui.same_line(0, px(12))
            key_caps(keys)
        if detail:
            imgui.push_text_wrap_pos(px(320))
            with font(None, SMALL):
                raw(detail if own else tr(detail), COLOURS.muted)
            imgui.pop_text_wrap_pos()
        imgui.end_tooltip()
    imgui.pop_style_var()


def badge(words: str, colour: Rgba) -> None:
    """A word in a coloured lozenge."""
    words = tr(words)
    line = imgui.get_text_line_height()
    with font(FONTS.bold, SMALL - 1):
        size = imgui.calc_text_size(words)
        pad, height = px(7), size.y + px(4)
        at = imgui.get_cursor_screen_pos()
        low = (at.x, at.y + (line - height) / 2)
        high = (at.x + size.x + 2 * pad, low[1] + height)
        draw = imgui.get_window_draw_list()
        draw.add_rect_filled(low, high, u32(alpha(colour, 0.18)), px(5))
        draw.add_text((at.x + pad, low[1] + (height - size.y) / 2), u32(colour), words)
        imgui.dummy((size.x + 2 * pad, line))


def empty_state(icon: str, title: str, hint: str) -> None:
    """Draw the text of a panel that has nothing to show: its purpose and how to fill it."""
    space = imgui.get_content_region_avail()
    imgui.dummy((0, max(min(space.y * 0.18, px(40)), px(6))))
    for words, size, colour in (
        (icon, TITLE + 4, COLOURS.faint),
        (title, 0.0, COLOURS.text),
    ):
        with font(FONTS.bold if size == 0.0 else None, size):
            width = imgui.calc_text_size(tr(words)).x
            imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max((space.x - width) / 2, 0))
            text(words, colour)
    centred_lines(hint, min(space.x - px(12), px(280)))


def centred_lines(words: str, width: float) -> None:
    """Small text broken to a width, each line in the middle of the panel."""
    with font(None, SMALL):
        space = imgui.get_content_region_avail().x
        for line in broken(tr(words), width):
            offset = (space - imgui.calc_text_size(line).x) / 2
            imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(offset, 0))
            raw(line, COLOURS.muted)


def broken(words: str, width: float) -> list[str]:
    """Text broken at spaces so that no line is wider than `width` [px]; one that fits is kept."""
    lines: list[str] = []
    for paragraph in words.split("\n"):
        if imgui.calc_text_size(paragraph).x <= width:
            lines.append(paragraph)
            continue
        line = ""
        for word in paragraph.split(" "):
            longer = f"{line} {word}".strip()
            if line and imgui.calc_text_size(longer).x > width:
                lines.append(line)
                line = word
            else:
                line = longer
        lines.append(line)
    return lines


def shortened(name: str) -> str:
    """Return a name with an ellipsis where it is too long for a tab or a line of several things."""
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1].rstrip()}…"


def fitted(words: str, room: float) -> str:
    """Return a line cut to a width [px], with an ellipsis where something is missing."""
    if imgui.calc_text_size(words).x <= room:
        return words
    while words and imgui.calc_text_size(words + "…").x > room:
        words = words[:-1]
    return words.rstrip() + "…" if words else ""


def fitted_path(path: Path, room: float) -> str:
    """Return a path cut to a width [px]: its end, with `~` for the user's folder."""
    words = str(path)
    with contextlib.suppress(ValueError, RuntimeError):
        words = str("~" / path.relative_to(Path.home()))
    while imgui.calc_text_size(words).x > room and "/" in words[2:]:
        words = "…/" + words.lstrip("…/").split("/", 1)[-1]
    return words


def input_line(identity: str, hint: str, typed: str, flags: int = 0) -> tuple[bool, str]:
    """Draw a field for a line of text; an empty one shows as much of its hint as has room.

    Args:
        identity: Stable id.
        hint: What an empty field shows.
        typed: The text in it.
        flags: Of `imgui.InputTextFlags_`.

    Returns:
        What Dear ImGui says of the field, and its text now.
    """
    whole = tr(hint)
    shown = fitted(whole, imgui.calc_item_width() - 2 * imgui.get_style().frame_padding.x)
    told, now = imgui.input_text_with_hint(f"###{identity}", shown, typed, flags)
    if shown != whole and not now and not imgui.is_item_active():
        tooltip(hint)
    return told, now


def kind_colour(kind: str) -> Rgba:
    """Return the colour of a message of a kind."""
    c = COLOURS
    return {"info": c.info, "success": c.good, "warning": c.warn, "error": c.bad}[kind]


KIND_ICONS: Final[dict[str, str]] = {
    "info": Icons.info,
    "success": Icons.good,
    "warning": Icons.warning,
    "error": Icons.error,
}
