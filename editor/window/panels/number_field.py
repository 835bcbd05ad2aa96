"""A number to drag or to type.

A drag previews and becomes one history entry when it ends; a typed value commits on Enter, on Tab
or when the field is left. Values beyond the usual range are shown as unusual, never clamped; at the
format's own limits they stop, which is said.
"""

import dataclasses
import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from editor.base.arithmetic import Change, parse
from editor.documents.commands.base import Command
from editor.documents.commands.fields import alike, field_name
from editor.documents.document import Document
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS
from editor.window.panels.number_info import (
    FieldInfo,
    digits,
    format_of,
    shown_value,
    usual_range,
)

if TYPE_CHECKING:
    from editor.session import Session


@dataclasses.dataclass(frozen=True, kw_only=True)
class NumberField:
    """A number that can be edited: its values, and what an edit of it does."""

    name: str
    """Stable id, for the probe."""
    values: tuple[float, ...]
    """Stored values, of all that is edited; the last one is shown when they agree."""
    info: FieldInfo
    command: Callable[[Change], Command]
    """Makes the edit from a change of the stored value."""
    radians: bool = False
    """True if angles are shown in radians."""

    @property
    def mixed(self) -> bool:
        """True if the values differ."""
        return not all(alike(value, self.values[-1]) for value in self.values)

    @property
    def factor(self) -> float:
        """Shown value over stored value."""
        return self.info.shown_factor(self.radians)

    @property
    def unit(self) -> str:
        """Unit beside the number."""
        return self.info.shown_unit(self.radians)

    def stored(self, change: Change) -> Change:
        """Return a typed change in the stored unit."""
        return change.scaled(1.0 / self.factor)


@dataclasses.dataclass(kw_only=True)
class _Typing:
    """The field that is typed into. It edits what was selected when the typing began."""

    field: NumberField
    document: Document
    """The level in front when the typing began."""
    began: str
    text: str
    frame: int = 0
    """The frame in which it was drawn last; 0: not yet."""


@dataclasses.dataclass(kw_only=True)
class _Drag:
    """The field that is dragged."""

    name: str
    document: Document
    """The level in front when the drag began."""
    start: float
    """Value before the drag."""
    last: float
    frame: int
    """The frame in which it was drawn last."""


class NumberEditor:
    """Draws numbers and turns what a person does to them into previews and commits."""

    def __init__(self) -> None:
        self._drag: _Drag | None = None
        self._typing: _Typing | None = None
        self._order: list[str] = []
        """Names of the fields of this frame so far, in the order of drawing."""
        self._frame = -1
        self._to_next = False
        """True if the next field that is drawn is to be typed into (Tab)."""
        self._wanted: str | None = None
        """The field that is to be typed into."""

    def begin(self, session: "Session") -> None:
        """Begin a frame: what was typed into a field that is gone is committed.

        The drag of a field that is gone, or of another level's, is dropped, as a gesture would be.
        """
        frame = imgui.get_frame_count()
        self._frame, self._order = frame, []
        if self._drag is not None and self._drag.document is not session.document:
            # A field of that name may be on the screen all the same: it is not being dragged.
            imgui.internal.clear_active_id()
            self._drag = None
        elif self._drag is not None and self._drag.frame < frame - 1:
            self._drag = None
        if self._typing is not None and 0 < self._typing.frame < frame - 1:
            self._finish(session, self._typing)

    def number(
        self, session: "Session", field: NumberField, *, width: float = -1.0, prefix: str = ""
    ) -> None:
        """A number to drag, or to type: a click, Enter or Tab makes it a text.

        Args:
            session: Gets previews and commits.
            field: What is edited. Values that differ are dragged together, each by as much.
            width: Width of the field [px]; -1: all there is.
            prefix: A word before the number (`x`).
        """
        name, info = field.name, field.info
        self._order.append(name)
        if self._to_next:
            self._to_next, self._wanted = False, name
        if session.view.field == name:
            session.view.field, self._wanted = "", name
        imgui.set_next_item_width(width)
        if self._typing is not None and self._typing.field.name == name:
            self._draw_text(session, self._typing)
            return
        value = field.values[-1]
        unusual = not info.slider[0] - 1e-6 <= value <= info.slider[1] + 1e-6
        low, high = info.low * field.factor, info.high * field.factor
        bounded = math.isfinite(low) and math.isfinite(high)
        colours = {"text": COLOURS.warn} if unusual and not field.mixed else {}
        form = widgets.MIXED if field.mixed else prefix + format_of(value, info, field.radians)
        with widgets.coloured(**colours):
            changed, new = imgui.drag_float(
                f"###{name}",
                value * field.factor,
                info.step * field.factor * (0.5 if not info.integer else 0.05),
                low if bounded else 0.0,
                high if bounded else 0.0,
                form,
                imgui.SliderFlags_.no_input.value,
            )
        widgets.probe(session, name)
        self._follow(session, field, changed, new / field.factor)
        if self._becomes_text(name):
            text = "" if field.mixed else digits(value, info, field.radians)
            document = session.document
            self._typing = _Typing(field=field, document=document, began=text, text=text)
        if not imgui.is_item_active():
            note = f"Unusual: most levels stay within {usual_range(info, field.radians)}."
            widgets.tooltip(info.description or name, note if unusual else "")

    def _becomes_text(self, name: str) -> bool:
        """Return whether the last item is to be typed into: clicked, Ctrl+clicked, Enter, Tab."""
        if self._wanted == name:
            self._wanted = None
            return True
        by_key = not imgui.is_mouse_down(0)
        if imgui.is_item_activated() and (imgui.get_io().key_ctrl or by_key):
            imgui.internal.clear_active_id()
            return True
        still = not imgui.internal.is_mouse_drag_past_threshold(0)
        return imgui.is_item_deactivated() and imgui.is_mouse_released(0) and still

    def _draw_text(self, session: "Session", typing_: _Typing) -> None:
        """Draw the field that is typed into; Enter, Tab or leaving it commits, Esc does not."""
        name, frame = typing_.field.name, imgui.get_frame_count()
        fresh, typing_.frame = typing_.frame == 0, frame
        if fresh:
            imgui.set_keyboard_focus_here()
        flags = (
            imgui.InputTextFlags_.auto_select_all.value
            | imgui.InputTextFlags_.enter_returns_true.value
        )
        entered, typing_.text = imgui.input_text(f"###{name}.text", typing_.text, flags)
        widgets.probe(session, name)
        tabbed = imgui.is_key_pressed(imgui.Key.tab, False) and not fresh
        if not (entered or tabbed or (imgui.is_item_deactivated() and not fresh)):
            return
        if tabbed:
            imgui.internal.nav_move_request_cancel()
            at = self._order.index(name)
            back = imgui.get_io().key_shift
            self._to_next = not back
            self._wanted = self._order[at - 1] if back and at else None
        self._finish(session, typing_)

    def _finish(self, session: "Session", typing_: _Typing) -> None:
        self._typing = None
        if typing_.text.strip() != typing_.began.strip():
            session.queue(functools.partial(_commit_typed, session, typing_))

    def _follow(self, session: "Session", field: NumberField, changed: bool, value: float) -> None:
        """Preview and commit a drag."""
        frame = imgui.get_frame_count()
        value = round(value) if field.info.integer else value
        drag = self._drag if self._drag is not None and self._drag.name == field.name else None
        if changed and drag is None:
            drag = self._drag = _Drag(
                name=field.name,
                document=session.document,
                start=field.values[-1],
                last=value,
                frame=frame,
            )
        if drag is None:
            return
        drag.frame = frame
        if changed:
            drag.last = value
            session.queue(functools.partial(_preview, session, _edit(field, drag)))
        if imgui.is_item_deactivated():
            self._drag = None
            if session.editing:
                session.queue(_edit(field, drag))


def _edit(field: NumberField, drag: _Drag) -> Command:
    """Make the edit of a drag; values that differ change by as much."""
    if field.mixed:
        return field.command(Change(amount=drag.last - drag.start, operator="+"))
    return field.command(Change(amount=drag.last))


def _commit_typed(session: "Session", typing_: _Typing) -> None:
    """Commit what was typed; a value beyond the format's limits stops there, which is said.

    Raises:
        CommandError: The text is not a number.
    """
    field, text = typing_.field, typing_.text
    change, info = field.stored(parse(text, field.unit)), field.info
    wanted = [change.of(value) for value in field.values]
    beyond = next((w for w in wanted if not info.low - 1e-9 <= w <= info.high + 1e-9), None)
    if beyond is not None:
        limit = info.low if beyond < info.low else info.high
        title = field_name(field.name.split(".", 1)[1])
        words = "at least" if beyond < info.low else "at most"
        stop = shown_value(limit, info, field.radians)
        typed = shown_value(beyond, info, field.radians) if change.relative else text.strip()
        session.complain(f"{title} is {words} {stop}: {typed} became {stop}.")
        if len(field.values) == 1 or not change.relative:
            # Changes of several values are cut by the edit itself, each where it gets beyond.
            change = Change(amount=limit)
    session.execute(field.command(change), on=typing_.document)


def _preview(session: "Session", command: Command) -> None:
    if session.editing and not session.driver.active:
        session.document.preview(command)
