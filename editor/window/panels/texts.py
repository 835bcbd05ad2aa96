"""Lines of text in panels: each commits on Enter or when it is left."""

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.toolkit import widgets

if TYPE_CHECKING:
    from editor.session import Session


@dataclasses.dataclass(kw_only=True)
class _Typed:
    """A text that is being typed. It changes what was shown when the typing began."""

    began: str
    text: str
    commit: Callable[[str], None]
    frame: int
    """The frame in which it was drawn last."""

    def finish(self) -> None:
        """Commit what was typed, where it differs."""
        if self.text != self.began:
            self.commit(self.text)


class TextFields:
    """Text being typed into the fields of one panel."""

    def __init__(self) -> None:
        self._typed: dict[str, _Typed] = {}

    def begin(self) -> None:
        """Begin a frame: what was typed into a text that is gone is committed."""
        frame = imgui.get_frame_count()
        for name, typed in list(self._typed.items()):
            if typed.frame < frame - 1:
                self._typed.pop(name).finish()

    def line(
        self,
        session: "Session",
        name: str,
        value: str,
        commit: Callable[[str], None],
        *,
        hint: str = "",
        longest: int = 0,
    ) -> None:
        """Draw a text as wide as there is room.

        Args:
            session: Gets the probe.
            name: Stable id of the field.
            value: The stored text.
            commit: Takes the new text when it differs.
            hint: What an empty field shows.
            longest: Characters that are kept; 0: all.
        """
        value = value.replace("\n", " ")
        shown = self._shown(name, value)
        if session.view.field == name:
            session.view.field = ""
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(-1)
        changed, new = widgets.input_line(name, hint, shown)
        widgets.probe(session, name)
        if imgui.calc_text_size(shown).x > imgui.get_item_rect_size().x and shown == value:
            widgets.tooltip(value)
        commit = _within(session, longest, commit)
        self._follow(name, value, commit, new if changed else None)

    def area(
        self,
        session: "Session",
        name: str,
        value: str,
        commit: Callable[[str], None],
        *,
        lines: int = 4,
        longest: int = 0,
    ) -> None:
        """Draw a text of several lines that breaks at the edge."""
        height = imgui.get_text_line_height() * lines + 2 * imgui.get_style().frame_padding.y
        flags = imgui.InputTextFlags_.word_wrap.value
        changed, new = imgui.input_text_multiline(
            f"###{name}", self._shown(name, value), (-1, height), flags
        )
        widgets.probe(session, name)
        commit = _within(session, longest, commit)
        self._follow(name, value, commit, new if changed else None)

    def _shown(self, name: str, value: str) -> str:
        typed = self._typed.get(name)
        return value if typed is None else typed.text

    def _follow(
        self, name: str, value: str, commit: Callable[[str], None], new: str | None
    ) -> None:
        frame = imgui.get_frame_count()
        if new is not None:
            typed = self._typed.setdefault(
                name, _Typed(began=value, text=new, commit=commit, frame=frame)
            )
            typed.text = new
        if name in self._typed:
            self._typed[name].frame = frame
            if imgui.is_item_deactivated():
                self._typed.pop(name).finish()


def _within(
    session: "Session", longest: int, commit: Callable[[str], None]
) -> Callable[[str], None]:
    """Let a commit take no more characters than are kept; what is left out is said."""

    def cut(typed: str) -> None:
        if longest and len(typed) > longest:
            session.complain(
                f"{longest} characters are kept of {len(typed)}: there is no more room."
            )
            typed = typed[:longest].rstrip()
        commit(typed)

    return cut
