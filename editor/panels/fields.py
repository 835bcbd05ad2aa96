"""Fields that edit the selection: made from the model's metadata (unit, usual range, step).

A drag previews and becomes one history entry when it ends; a typed value commits on Enter or when
the field is left. Values beyond the usual range are shown as unusual, never clamped; only the
format's own limits hold.
"""

import dataclasses
import functools
import math
import typing
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final

import msgspec
from imgui_bundle import imgui

from editor import widgets
from editor.commands.base import Command, Selection
from editor.commands.fields import (
    SetField,
    SetLevelField,
    field_types,
    selected_records,
    shared_value,
)
from editor.look import COLOURS, Icons
from kinetix.errors import CommandError
from kinetix.level.model import Level, Record

if TYPE_CHECKING:
    from editor.session import Session

DEGREES: Final = 180.0 / math.pi


@dataclasses.dataclass(frozen=True, kw_only=True)
class FieldInfo:
    """What the model says about a number."""

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
    """What the model says about a dotted numeric field.

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


def _text_of(value: float, info: FieldInfo, radians: bool) -> str:
    """A format that shows the value without noise but loses nothing a person would type."""
    if info.integer:
        return "%.0f"
    decimals = 1 if info.shown_factor(radians) != 1.0 else max(_decimals(info.step), 2)
    for extra in range(4):
        if abs(round(value, decimals + extra) - value) < 1e-5:
            return f"%.{decimals + extra}f"
    return f"%.{decimals + 3}f"


class Editor:
    """Draws fields and turns what a person does to them into previews and commits."""

    def __init__(self) -> None:
        self._open: str | None = None
        """The field being dragged or typed into."""
        self.ids: Selection = ()
        """What the fields of the selection edit; a panel sets it before it draws them."""

    def number(  # noqa: PLR0913 - one field has that many sides
        self,
        session: "Session",
        name: str,
        value: float,
        info: FieldInfo,
        command: Callable[[float], Command],
        *,
        mixed: bool = False,
        width: float = -1.0,
        prefix: str = "",
    ) -> None:
        """A number to drag or to type.

        Args:
            session: Gets previews and commits.
            name: Stable id of the field, for the probe.
            value: Stored value.
            info: What the model says about it.
            command: Makes the edit from a stored value.
            mixed: Whether the selected things differ.
            width: Width of the field [px]; -1: all there is.
            prefix: A word before the number (`x`).
        """
        radians = session.settings.radians
        factor, unit = info.shown_factor(radians), info.shown_unit(radians)
        shown = value * factor
        unusual = not info.slider[0] - 1e-6 <= value <= info.slider[1] + 1e-6
        form = "—" if mixed else prefix + _text_of(shown, info, radians)
        if unit and not mixed:
            form += (" " if unit[0] not in "°" else "") + unit
        low, high = info.low * factor, info.high * factor
        bounded = math.isfinite(low) and math.isfinite(high)
        imgui.set_next_item_width(width)
        colours = {"text": COLOURS.warn} if unusual and not mixed else {}
        with widgets.coloured(**colours):
            changed, new = imgui.drag_float(
                f"###{name}",
                shown,
                info.step * factor * (0.5 if not info.integer else 0.05),
                low if bounded else 0.0,
                high if bounded else 0.0,
                form,
                imgui.SliderFlags_.clamp_on_input.value if bounded else 0,
            )
        widgets.probe(session, name)
        self._follow(session, name, changed, new / factor, command, info.integer)
        note = info.description
        if unusual:
            note += f"\nUnusual: most levels stay within {_range(info, radians)}."
        if not imgui.is_item_active():
            widgets.tooltip(note.split("\n")[0] or name, "\n".join(note.split("\n")[1:]))

    def _follow(
        self,
        session: "Session",
        name: str,
        changed: bool,
        value: float,
        command: Callable[[float], Command],
        integer: bool,
    ) -> None:
        edit = command(round(value)) if integer else command(value)
        if changed:
            self._open = name
            session.queue(functools.partial(_preview, session, edit))
        if imgui.is_item_deactivated():
            if imgui.is_item_deactivated_after_edit():
                session.queue(edit)
            elif self._open == name:
                session.queue(session.document.discard_preview)
            self._open = None

    def field(
        self, session: "Session", path: str, *, width: float = -1.0, prefix: str = ""
    ) -> None:
        """A numeric field of the selection, by its dotted name."""
        level, ids = session.document.shown, self.ids
        value, agrees = shared_value(level, ids, path)
        record = next(r for r in selected_records(level, ids) if _has(r, path))
        self.number(
            session,
            f"inspector.{path}",
            float(value),
            field_info(type(record), path),
            lambda new: SetField(ids=ids, field=path, value=new),
            mixed=not agrees,
            width=width,
            prefix=prefix,
        )

    def pair(self, session: "Session", path: str) -> None:
        """The two components of a vector side by side."""
        width = (imgui.get_content_region_avail().x - imgui.get_style().item_spacing.x) / 2
        self.field(session, f"{path}.x", width=width, prefix="x  ")
        imgui.same_line()
        self.field(session, f"{path}.y", width=width, prefix="y  ")

    def switch(self, session: "Session", path: str, label: str = "") -> None:
        """A yes-or-no field of the selection."""
        ids = self.ids
        value, agrees = shared_value(session.document.shown, ids, path)
        changed, _ = widgets.checkbox(
            session, f"inspector.{path}", label, bool(value), mixed=not agrees
        )
        if changed:
            new = not value if agrees else True
            session.queue(SetField(ids=ids, field=path, value=new))

    def options(self, session: "Session", path: str, options: Sequence[tuple[Any, str]]) -> None:
        """A field of the selection that takes one of a few values, as a row of buttons."""
        ids = self.ids
        value, agrees = shared_value(session.document.shown, ids, path)
        picked = segments(session, f"inspector.{path}", options, value if agrees else None)
        if picked is not None:
            session.queue(SetField(ids=ids, field=path, value=picked[0]))

    def level_field(self, session: "Session", path: str, *, width: float = -1.0) -> None:
        """A numeric field of the level itself."""
        level = session.document.shown
        value: Any = level
        for part in path.split("."):
            value = value[int(part)] if part.isdigit() else getattr(value, part)
        self.number(
            session,
            f"level.{path}",
            float(value),
            field_info(Level, path),
            lambda new: SetLevelField(field=path, value=new),
            width=width,
        )

    def reset(self, session: "Session", path: str, default: Any) -> None:
        """A small arrow that sets a field back; only there when it differs."""
        ids = self.ids
        try:
            value, agrees = shared_value(session.document.shown, ids, path)
        except CommandError:
            return
        if agrees and value == default:
            return
        imgui.same_line(0, widgets.px(2))
        if widgets.icon_button(session, f"reset.{path}", Icons.reset, tint=COLOURS.faint):
            session.queue(SetField(ids=ids, field=path, value=default))
        widgets.tooltip(f"Back to {_plain(default)}")


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _range(info: FieldInfo, radians: bool) -> str:
    low, high = (bound * info.shown_factor(radians) for bound in info.slider)
    return f"{low:g} … {high:g} {info.shown_unit(radians)}".rstrip()


def _preview(session: "Session", command: Command) -> None:
    if session.editing and not session.driver.active:
        session.document.preview(command)


def _has(record: Record, path: str) -> bool:
    try:
        field_info(type(record), path)
    except KeyError:
        return False
    return True


def segments(
    session: "Session", name: str, options: Sequence[tuple[Any, str]], current: Any
) -> tuple[Any] | None:
    """A row of buttons of which one is down.

    Returns:
        The value that was picked in this frame, in a tuple, or None.
    """
    picked = None
    gap = widgets.px(2)
    width = (imgui.get_content_region_avail().x - gap * (len(options) - 1)) / len(options)
    room = width - 2 * widgets.px(4)
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
