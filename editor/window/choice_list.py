"""The rows of a pop-up list: one of them is lit, and that is the one that Return takes."""

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from imgui_bundle import imgui

from editor.base.language import tr
from editor.base.prompts import Choice
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, u32
from editor.toolkit.keys import label as chord_label
from editor.toolkit.widgets import px

if TYPE_CHECKING:
    from editor.session import Session

_WORD_SECONDS: Final = 1.0
"""A letter that comes later than so long after another begins a new word [s]."""
_APART: Final = 32.0
"""Between a row's words and what stands beside them [px at 100 %]."""
_STEPS: Final = {imgui.Key.down_arrow: 1, imgui.Key.up_arrow: -1}


class ChoiceList:
    """Remembers which row is lit: arrows, letters and a pointer that moves choose another."""

    def __init__(self, choices: Sequence[Choice]) -> None:
        """Light the first row.

        Args:
            choices: The rows, at least one.
        """
        self._choices = choices
        self._row = 0
        self._typed, self._typed_at = "", 0.0

    def draw(self, session: "Session", *, fresh: bool) -> str | None:
        """Draw the rows; return the id of the one that was taken.

        Args:
            session: The app.
            fresh: Whether the list has just come: the key that called it is not meant for a row.
        """
        before = self._row
        if not fresh:
            self._follow_keys()
        rows = [(tr(choice.label), _beside(choice)) for choice in self._choices]
        sizes = [[imgui.calc_text_size(text).x for text in row] for row in rows]
        wide = max(left + (px(_APART) + right if right else 0.0) for left, right in sizes)
        taken = None
        for number, choice in enumerate(self._choices):
            if choice.separated:
                imgui.separator()
            if self._draw_row(session, number, rows[number], wide):
                taken = choice.id
            if number == self._row != before:
                imgui.set_scroll_here_y()
        entered = any(
            imgui.is_key_pressed(key, False) for key in (imgui.Key.enter, imgui.Key.keypad_enter)
        )
        return self._choices[self._row].id if entered and not fresh else taken

    def _draw_row(
        self, session: "Session", number: int, texts: tuple[str, str], wide: float
    ) -> bool:
        choice, (label, beside) = self._choices[number], texts
        lit = number == self._row
        if not lit:
            imgui.push_style_color(imgui.Col_.header_hovered, (0.0, 0.0, 0.0, 0.0))
        pressed = imgui.selectable(widgets.labelled(label, choice.id), lit, 0, (wide, 0.0))[0]
        if not lit:
            imgui.pop_style_color()
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        if beside:
            size = imgui.calc_text_size(beside)
            place = (high.x - size.x - px(4), (low.y + high.y - size.y) / 2)
            imgui.get_window_draw_list().add_text(place, u32(COLOURS.muted), beside)
        widgets.probe(session, f"list.{choice.id}")
        moved = imgui.get_io().mouse_delta
        if imgui.is_item_hovered() and (moved.x or moved.y):
            self._row = number
        if lit and choice.ids:
            session.highlighted = tuple(choice.ids)
        return pressed

    def _follow_keys(self) -> None:
        for key, step in _STEPS.items():
            if imgui.is_key_pressed(key):
                self._row = (self._row + step) % len(self._choices)
        if imgui.is_key_pressed(imgui.Key.home, False):
            self._row = 0
        if imgui.is_key_pressed(imgui.Key.end, False):
            self._row = len(self._choices) - 1
        typed = "".join(chr(code) for code in imgui.get_io().input_queue_characters)
        if typed:
            now = time.monotonic()
            word = self._typed if now - self._typed_at < _WORD_SECONDS else ""
            self._typed, self._typed_at = word + typed.casefold(), now
            self._row = matching(self._typed, [tr(each.label) for each in self._choices], self._row)


def matching(word: str, labels: Sequence[str], row: int) -> int:
    """Return the row that typed letters mean.

    Args:
        word: What was typed, in small letters.
        labels: Those of all rows.
        row: The present one, which stays where none fits.
    """
    names = [label.casefold() for label in labels]
    for fits in (str.startswith, str.__contains__):
        for number, name in enumerate(names):
            if fits(name, word):
                return number
    return row


def _beside(choice: Choice) -> str:
    beside = chord_label(choice.chord) if choice.chord else choice.detail
    return tr(beside) if beside else ""
