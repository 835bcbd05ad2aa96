"""Fields that edit the selection: made from the model's metadata (unit, usual range, step)."""

import contextlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from imgui_bundle import imgui

from editor.base.arithmetic import Change
from editor.documents.commands.base import Command, Selection
from editor.documents.commands.fields import (
    AdjustField,
    ResetFields,
    SetField,
    SetLevelField,
    alike,
    read_field,
    selected_records,
    shared_value,
)
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons
from editor.toolkit.segments import segments
from editor.window.panels.number_field import NumberEditor, NumberField
from editor.window.panels.number_info import field_info, shown_value
from editor.window.panels.resets import SAVED, reset_rows
from kinetix.errors import CommandError
from kinetix.level.model import Level

if TYPE_CHECKING:
    from editor.session import Session


class Editor(NumberEditor):
    """Draws the fields of the selection and of the level."""

    def __init__(self) -> None:
        super().__init__()
        self.ids: Selection = ()
        """Ids that the fields of the selection edit; a panel sets it before it draws them."""

    def field(
        self, session: "Session", path: str, *, width: float = -1.0, prefix: str = ""
    ) -> None:
        """A numeric field of the selection, by its dotted name."""
        self.number(session, self.selected(session, path), width=width, prefix=prefix)

    def selected(self, session: "Session", path: str) -> NumberField:
        """Return a numeric field of the selection.

        Raises:
            CommandError: No selected entity has the field.
        """
        ids, radians = self.ids, session.settings.radians
        values, info = [], None
        for record in selected_records(session.document.shown, ids):
            # A polygon is a body, but has no radius.
            with contextlib.suppress(CommandError, KeyError):
                values.append(float(read_field(record, path)))
                info = field_info(type(record), path)
        if info is None:
            raise CommandError(f"Nothing that is selected has a field {path!r}.")
        known = info

        def command(change: Change) -> Command:
            if change.relative:
                shown = str(change.scaled(known.shown_factor(radians)))
                low, high = known.low, known.high
                return AdjustField(
                    ids=ids, field=path, change=change, low=low, high=high, shown=shown
                )
            value = round(change.amount) if known.integer else change.amount
            shown = shown_value(change.amount, known, radians)
            return SetField(ids=ids, field=path, value=value, shown=shown)

        return NumberField(
            name=f"inspector.{path}",
            values=tuple(values),
            info=known,
            command=command,
            radians=radians,
        )

    def pair(self, session: "Session", path: str, *, default: Any = SAVED) -> None:
        """Draw the two components of a vector side by side, and an arrow back."""
        gap = imgui.get_style().item_spacing.x
        with self.resettable(session, (path,), default) as room:
            width = (room - gap) / 2
            self.field(session, f"{path}.x", width=width, prefix="x  ")
            imgui.same_line()
            self.field(session, f"{path}.y", width=width, prefix="y  ")

    @contextlib.contextmanager
    def resettable(
        self, session: "Session", paths: Sequence[str], default: Any = SAVED
    ) -> Iterator[float]:
        """Leave room for an arrow that sets fields back, where they differ; yields what is left.

        Args:
            session: Gets the edit.
            paths: Dotted names of the fields that the arrow sets back together.
            default: What they go back to; `SAVED`: what the level's file says.
        """
        rows = reset_rows(session, self.ids, paths, default)
        words = "Reset to what is saved" if default is SAVED else f"Reset to {_plain(default)}"
        command = ResetFields(rows=rows) if rows else None
        with self.arrow(session, paths[0], command, words) as room:
            yield room

    @contextlib.contextmanager
    def arrow(
        self, session: "Session", name: str, command: Command | None, words: str
    ) -> Iterator[float]:
        """Leave room for a small arrow that does a command; yields what is left of the row [px].

        Args:
            session: Gets the command.
            name: Of the arrow.
            command: What it does; None: there is no arrow.
            words: What it says.
        """
        room = imgui.get_content_region_avail().x
        yield room - (widgets.icon_width(Icons.reset) + widgets.px(2) if command else 0.0)
        if command is None:
            return
        imgui.same_line(0, widgets.px(2))
        if widgets.icon_button(session, f"reset.{name}", Icons.reset, tint=COLOURS.faint):
            session.queue(command)
        widgets.tooltip(words)

    def switch(self, session: "Session", path: str, *, default: Any) -> None:
        """Draw a yes-or-no field of the selection, and an arrow back."""
        ids = self.ids
        value, agrees = shared_value(session.document.shown, ids, path)
        with self.resettable(session, (path,), default):
            changed, _ = widgets.checkbox(
                session, f"inspector.{path}", "", bool(value), mixed=not agrees
            )
        if changed:
            new = not value if agrees else True
            session.queue(SetField(ids=ids, field=path, value=new))

    def options(
        self,
        session: "Session",
        path: str,
        options: Sequence[tuple[Any, str]],
        *,
        default: Any = SAVED,
    ) -> None:
        """Draw a field that takes one of a few values as a row of buttons, and an arrow back."""
        ids = self.ids
        value, agrees = shared_value(session.document.shown, ids, path)
        with self.resettable(session, (path,), default) as room:
            current = value if agrees else None
            picked = segments(session, f"inspector.{path}", options, current, width=room)
        if picked is not None:
            session.queue(SetField(ids=ids, field=path, value=picked[0]))

    def level_field(self, session: "Session", path: str, *, width: float = -1.0) -> None:
        """A numeric field of the level itself."""
        level = session.document.shown
        value: Any = level
        for part in path.split("."):
            value = value[int(part)] if part.isdigit() else getattr(value, part)
        stored, info = float(value), field_info(Level, path)

        def command(change: Change) -> Command:
            new = min(max(change.of(stored), info.low), info.high)
            return SetLevelField(field=path, value=round(new) if info.integer else new)

        field = NumberField(name=f"level.{path}", values=(stored,), info=info, command=command)
        self.number(session, field, width=width)

    @contextlib.contextmanager
    def level_resettable(self, session: "Session", field: str, default: Any) -> Iterator[float]:
        """Leave room for an arrow that sets a field of the level back; yields what is left [px]."""
        differs = not alike(getattr(session.document.shown, field), default)
        command = SetLevelField(field=field, value=default) if differs else None
        words = f"Reset to {_plain(default)}"
        with self.arrow(session, f"level.{field}", command, words) as room:
            yield room


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if value is None:
        return "Automatic"
    if isinstance(value, str):
        return value.capitalize()
    if isinstance(value, tuple):
        return ", ".join(f"{each:g}" for each in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
