"""Fields that edit the selection: made from the model's metadata (unit, usual range, step).

A drag previews and becomes one history entry when it ends; a typed value commits on Enter, on Tab
or when the field is left. Values beyond the usual range are shown as unusual, never clamped; at the
format's own limits they stop, which is said.
"""

import contextlib
import dataclasses
import functools
import math
import typing
from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final

import msgspec
from imgui_bundle import imgui

from editor.base.arithmetic import Change, parse
from editor.base.language import tr
from editor.base.memory import remembers
from editor.documents.commands.base import Command, EntityId, Selection
from editor.documents.commands.fields import (
    AdjustField,
    ResetFields,
    SetField,
    SetLevelField,
    alike,
    field_name,
    field_types,
    read_field,
    selected_records,
    shared_value,
)
from editor.toolkit import widgets
from editor.toolkit.appearance import COLOURS, Icons
from kinetix.errors import CommandError
from kinetix.level.model import Level, Record

if TYPE_CHECKING:
    from editor.session import Session

DEGREES: Final = 180.0 / math.pi
SAVED: Final = object()
"""In the place of a default: what the level's file says."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class FieldInfo:
    """The model's facts about a number."""

    unit: str
    low: float
    high: float
    slider: tuple[float, float]
    step: float
    description: str
    integer: bool = False

    def shown_factor(self, radians: bool) -> float:
        """Shown value over stored value: angles are stored in radians, shown in degrees or not."""
        return DEGREES if self.unit in ("rad", "rad/s") and not radians else 1.0

    def shown_unit(self, radians: bool) -> str:
        """Unit beside the field."""
        return self.unit if radians else {"rad": "°", "rad/s": "°/s"}.get(self.unit, self.unit)


def _metas(hint: Any) -> list[msgspec.Meta]:
    found: list[msgspec.Meta] = []
    if typing.get_origin(hint) is Annotated:
        inner, *extras = typing.get_args(hint)
        found += [extra for extra in extras if isinstance(extra, msgspec.Meta)]
        found += _metas(inner)
    return found


def _stripped(hint: Any) -> Any:
    return typing.get_args(hint)[0] if typing.get_origin(hint) is Annotated else hint


def _inner_record(hint: Any, name: str) -> Any:
    """The record class among the alternatives of a hint that has the field."""
    hint = _stripped(hint)
    options = typing.get_args(hint) if typing.get_origin(hint) is not None else (hint,)
    for option in map(_stripped, options or (hint,)):
        record = isinstance(option, type) and issubclass(option, Record)
        if record and (name.isdigit() or name in option.__struct_fields__):
            return option
    return None


@functools.cache
def field_info(cls: type[Record], path: str) -> FieldInfo:
    """Return the model's facts about a dotted numeric field.

    Raises:
        KeyError: There is no such field.
    """
    head, *rest = path.split(".")
    hint = field_types(cls)[head]
    while rest:
        name = rest.pop(0)
        bare = _stripped(hint)
        if typing.get_origin(bare) is tuple:
            hint = typing.get_args(bare)[0]
            continue
        inner = _inner_record(hint, name)
        if inner is None:
            raise KeyError(path)
        hint = field_types(inner)[name]
    metas = _metas(hint)
    merged: dict[str, Any] = {"ge": None, "le": None, "description": "", "extra": {}}
    for meta in metas:
        for name in merged:
            value = getattr(meta, name)
            merged[name] = merged[name] or value
    extra = merged["extra"] or {}
    low = -math.inf if merged["ge"] is None else float(merged["ge"])
    high = math.inf if merged["le"] is None else float(merged["le"])
    integer = _stripped(hint) is int
    return FieldInfo(
        unit=extra.get("unit", ""),
        low=low,
        high=high,
        slider=extra.get("slider") or (low, high),
        step=extra.get("step", 1.0 if integer else 0.01),
        description=merged["description"],
        integer=integer,
    )


def _decimals(step: float) -> int:
    return max(0, min(4, math.ceil(-math.log10(step)))) if step > 0 else 3


def _decimals_of(shown: float, info: FieldInfo, radians: bool) -> int:
    """Return how many decimals show a value without noise and lose nothing that was typed."""
    if info.integer:
        return 0
    decimals = 1 if info.shown_factor(radians) != 1.0 else max(_decimals(info.step), 2)
    for extra in range(4):
        if abs(round(shown, decimals + extra) - shown) < 1e-5:
            return decimals + extra
    return decimals + 3


def _digits(value: float, info: FieldInfo, radians: bool) -> str:
    """Return a stored value as it is typed, without its unit."""
    shown = value * info.shown_factor(radians)
    return f"{shown:.{_decimals_of(shown, info, radians)}f}"


def _form(value: float, info: FieldInfo, radians: bool) -> str:
    """Return the format of a drag field, its unit included."""
    shown, unit = value * info.shown_factor(radians), info.shown_unit(radians)
    gap = " " if unit and unit[0] != "°" else ""
    return f"%.{_decimals_of(shown, info, radians)}f{gap}{unit}"


def shown_value(value: float, info: FieldInfo, radians: bool) -> str:
    """Return a stored value as fields show it, with its unit."""
    return _form(value, info, radians) % (value * info.shown_factor(radians))


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
    began: str
    text: str
    frame: int = 0
    """The frame in which it was drawn last; 0: not yet."""


class Editor:
    """Draws fields and turns what a person does to them into previews and commits."""

    def __init__(self) -> None:
        self._dragged: str | None = None
        """The field being dragged."""
        self._start = self._last = 0.0
        """Value of the dragged field before and now."""
        self._typing: _Typing | None = None
        self._order: list[str] = []
        """Names of the fields of this frame so far, in the order of drawing."""
        self._frame = -1
        self._to_next = False
        """True if the next field that is drawn is to be typed into (Tab)."""
        self._wanted: str | None = None
        """The field that is to be typed into."""
        self.ids: Selection = ()
        """Ids that the fields of the selection edit; a panel sets it before it draws them."""

    def begin(self, session: "Session") -> None:
        """Begin a frame: what was typed into a field that is gone is committed."""
        frame = imgui.get_frame_count()
        self._frame, self._order = frame, []
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
        form = widgets.MIXED if field.mixed else prefix + _form(value, info, field.radians)
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
            text = "" if field.mixed else _digits(value, info, field.radians)
            self._typing = _Typing(field=field, began=text, text=text)
        if not imgui.is_item_active():
            note = f"Unusual: most levels stay within {_range(info, field.radians)}."
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
            session.queue(functools.partial(_commit_typed, session, typing_.field, typing_.text))

    def _follow(self, session: "Session", field: NumberField, changed: bool, value: float) -> None:
        """Preview and commit a drag."""
        if changed:
            if self._dragged != field.name:
                self._dragged, self._start = field.name, field.values[-1]
            self._last = round(value) if field.info.integer else value
            session.queue(functools.partial(_preview, session, self._edit(field)))
        if imgui.is_item_deactivated():
            if self._dragged == field.name:
                session.queue(self._edit(field))
            self._dragged = None

    def _edit(self, field: NumberField) -> Command:
        """Make the edit of a drag; values that differ change by as much."""
        if field.mixed:
            return field.command(Change(amount=self._last - self._start, operator="+"))
        return field.command(Change(amount=self._last))

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
        self, session: "Session", paths: Sequence[str], default: Any = SAVED, *, name: str = ""
    ) -> Iterator[float]:
        """Leave room for an arrow that sets fields back, where they differ; yields what is left.

        Args:
            session: Gets the edit.
            paths: Dotted names of the fields that the arrow sets back together.
            default: What they go back to; `SAVED`: what the level's file says.
            name: Of the arrow, where several set the same field back.
        """
        rows = reset_rows(session, self.ids, paths, default)
        words = "Reset to what is saved" if default is SAVED else f"Reset to {_plain(default)}"
        command = ResetFields(rows=rows) if rows else None
        with self.arrow(session, name or paths[0], command, words) as room:
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
        yield room - (imgui.get_frame_height() + widgets.px(2) if command else 0.0)
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


def reset_rows(
    session: "Session", ids: Selection, paths: Sequence[str], default: Any
) -> tuple[tuple[EntityId, str, Any], ...]:
    """Return entity, field and value of everything that an arrow would set back.

    Args:
        session: The app.
        ids: What is selected.
        paths: Dotted names of the fields.
        default: What they go back to; `SAVED`: what the level's file says of each.
    """
    document = session.document
    known = _reset_rows_of(document.shown, document.saved)
    key = (ids, tuple(paths), default)
    if key not in known:
        known[key] = tuple(_reset_rows(document.shown, document.saved, *key))
    return known[key]


@remembers(2)
def _reset_rows_of(
    shown: Level, saved: Level | None
) -> dict[Hashable, tuple[tuple[EntityId, str, Any], ...]]:
    """Return the rows that were worked out for two levels; empty for new ones."""
    del shown, saved
    return {}


def _reset_rows(
    shown: Level, saved: Level | None, ids: Selection, paths: Sequence[str], default: Any
) -> Iterator[tuple[EntityId, str, Any]]:
    for entity in ids:
        now = selected_records(shown, (entity,))
        before = selected_records(saved, (entity,)) if saved else []
        for path in paths:
            with contextlib.suppress(CommandError, IndexError):
                value = read_field(before[0], path) if default is SAVED else default
                if not alike(read_field(now[0], path), value):
                    yield entity, path, value


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


def _range(info: FieldInfo, radians: bool) -> str:
    low, high = (bound * info.shown_factor(radians) for bound in info.slider)
    return f"{low:g} … {high:g} {info.shown_unit(radians)}".rstrip()


def _commit_typed(session: "Session", field: NumberField, text: str) -> None:
    """Commit what was typed; a value beyond the format's limits stops there, which is said.

    Raises:
        CommandError: It is not a number.
    """
    change, info = field.stored(parse(text, field.unit)), field.info
    wanted = [change.of(value) for value in field.values]
    beyond = next((w for w in wanted if not info.low - 1e-9 <= w <= info.high + 1e-9), None)
    if beyond is not None:
        limit = info.low if beyond < info.low else info.high
        title = field_name(field.name.split(".", 1)[1])
        words = "at least" if beyond < info.low else "at most"
        typed, stop = (shown_value(value, info, field.radians) for value in (beyond, limit))
        session.complain(f"{title} is {words} {stop}: {typed} became {stop}.")
        if not change.relative:
            change = Change(amount=limit)
    session.execute(field.command(change))


def _preview(session: "Session", command: Command) -> None:
    if session.editing and not session.driver.active:
        session.document.preview(command)


def segments(
    session: "Session",
    name: str,
    options: Sequence[tuple[Any, str]],
    current: Any,
    *,
    width: float = 0.0,
) -> tuple[Any] | None:
    """Draw a row of buttons of which one is down.

    Args:
        session: Gets the probes.
        name: Stable id.
        options: (value, label) in order.
        current: The value that is chosen.
        width: Of the whole row [px]; 0: all there is.

    Returns:
        The value that was picked in this frame, in a tuple, or None.
    """
    picked = None
    gap = widgets.px(2)
    width = width or imgui.get_content_region_avail().x
    width = (width - gap * (len(options) - 1)) / len(options)
    room = width - 2 * widgets.px(4)
    options = [(value, tr(label)) for value, label in options]
    cramped = any(imgui.calc_text_size(label).x > room for _, label in options)
    imgui.push_style_var(
        imgui.StyleVar_.frame_padding,
        imgui.ImVec2(widgets.px(4), imgui.get_style().frame_padding.y),
    )
    for index, (value, label) in enumerate(options):
        if index:
            imgui.same_line(0, gap)
        on = value == current
        if cramped and imgui.calc_text_size(label).x > room:
            # The sign alone, where there is one; the tooltip has the word.
            shown, full = label.split(" ")[0], label
        else:
            shown, full = label, ""
        c = COLOURS
        with widgets.coloured(
            button=c.accent_strong if on else c.field,
            button_hovered=c.accent if on else c.field_hover,
            text=(1.0, 1.0, 1.0, 1.0) if on else c.muted,
        ):
            if imgui.button(f"{shown}###{name}.{value}", (width, 0)):
                picked = (value,)
        widgets.probe(session, f"{name}.{value}")
        if full:
            widgets.tooltip(full)
    imgui.pop_style_var()
    return picked
