"""Setting fields by their dotted names in the native format: inspector, replays, fixes."""

import contextlib
import dataclasses
import functools
import math
import typing
from collections.abc import Hashable, Mapping
from typing import Any, Final

import msgspec

from editor.base.arithmetic import Change
from editor.base.memoise import remembers
from editor.documents.commands.base import EntityId, Selection, count_label
from editor.documents.commands.rigid import freed, reanchored_each, with_parts
from kinetix.errors import CommandError
from kinetix.level.geometry import relative_angle
from kinetix.level.model import ARENA_NAMES, Body, Joint, Level, Limits, Motor, Record
from kinetix.wording import misfit

_ABSENT: Final[dict[str, Record]] = {"motor": Motor(on=False), "limits": Limits(on=False)}
"""Values of absent parts."""
_AXES: Final = {"x": 0, "y": 1}
_FIXED_FIELDS: Final = ("id", "next_id")
_MASS_FIELDS: Final = ("shape", "density")
_ANGLES: Final = ("angle", "angular_velocity", "reference_angle", "limits.min", "limits.max")
_SPOKEN: Final = {
    "max_timesteps": "Time limit",
    "gravity.0": "Gravity x",
    "gravity.1": "Gravity y",
    "restitution": "Bounciness",
    "collision": "Collides",
    "angular_velocity": "Spin",
    "shape.radius": "Radius",
    "binding": "Key",
    "motor.binding": "Motor key",
    "limits.min": "Min angle",
    "limits.max": "Max angle",
}
"""Fields that the panels call otherwise than the format does."""
_NOISE: Final = 2e-6
"""Values that differ by less, in all or in proportion, are shown as one."""


@functools.cache
def field_types(cls: type[Record]) -> dict[str, Any]:
    """Return the annotated types of a record's fields, limits and units included."""
    hints = typing.get_type_hints(cls, include_extras=True)
    return {name: hints[name] for name in cls.__struct_fields__}


def read_field(record: Record, path: str) -> Any:
    """Return the value of a dotted field; absent motors and limits count as off.

    `position.x` and `vertices.2` reach into tuples.

    Raises:
        CommandError: The record has no such field.
    """
    value: Any = record
    for part in path.split("."):
        if isinstance(value, tuple):
            value = value[_index(part, value, path)]
        elif isinstance(value, Record) and part in type(value).__struct_fields__:
            value = _present(value, part)
        else:
            raise _no_field(record, path)
    return value


def with_field(record: Record, path: str, value: Any) -> Record:
    """Return a copy with a dotted field changed.

    Raises:
        CommandError: The record has no such field, or the format does not allow the value.
    """
    return _changed(record, record, path.split("."), value, path)


def _changed(root: Record, record: Record, parts: list[str], value: Any, path: str) -> Record:
    name, rest = parts[0], parts[1:]
    if name not in type(record).__struct_fields__ or name in _FIXED_FIELDS:
        raise _no_field(root, path)
    if rest:
        inner = _present(record, name)
        if isinstance(inner, tuple):
            value = _with_item(inner, rest, value, path)
        elif isinstance(inner, Record):
            value = _changed(root, inner, rest, value, path)
        else:
            raise _no_field(root, path)
    value = _checked(record, name, value, path)
    if value == _ABSENT.get(name) and getattr(record, name) is None:
        value = None
    return record.replace(**{name: value})


def _with_item(items: tuple[Any, ...], parts: list[str], value: Any, path: str) -> tuple[Any, ...]:
    index = _index(parts[0], items, path)
    if len(parts) > 1:
        value = _with_item(items[index], parts[1:], value, path)
    return (*items[:index], value, *items[index + 1 :])


def _checked(record: Record, name: str, value: Any, path: str) -> Any:
    if isinstance(value, Record):
        return value
    try:
        return msgspec.convert(value, field_types(type(record))[name])
    except msgspec.ValidationError as error:
        raise CommandError(f"{path}: {misfit(error)} (got {value!r:.60}).") from None


def _present(record: Record, name: str) -> Any:
    value = getattr(record, name)
    return _ABSENT.get(name) if value is None else value


def _index(part: str, items: tuple[Any, ...], path: str) -> int:
    index = _AXES.get(part, int(part) if part.isdigit() else -1)
    if not 0 <= index < len(items):
        raise CommandError(f"{path}: there is no item {part!r}; there are {len(items)}.")
    return index


def _no_field(record: Record, path: str) -> CommandError:
    names = ", ".join(n for n in type(record).__struct_fields__ if n not in _FIXED_FIELDS)
    return CommandError(f"There is no field {path!r} here; there are {names}.")


def shared_value(level: Level, selection: Selection, path: str) -> tuple[Any, bool]:
    """The value of a field over a selection: of the last entity that has it, and whether all agree.

    Raises:
        CommandError: No selected entity has the field.
    """
    values = []
    missing = CommandError("Nothing is selected.")
    for record in selected_records(level, selection):
        try:
            values.append(read_field(record, path))
        except CommandError as error:
            missing = error
    if not values:
        raise missing
    return values[-1], all(alike(value, values[-1]) for value in values)


def alike(a: Any, b: Any) -> bool:
    """Return whether two values of a field are equal up to the rounding of 32-bit numbers."""
    if isinstance(a, float) and isinstance(b, float):
        return math.isclose(a, b, rel_tol=_NOISE, abs_tol=_NOISE)
    return a == b


def selected_records(level: Level, selection: Selection) -> list[Record]:
    """Return the selected entities and arena bodies."""
    by_id = _by_id(level)
    return [by_id[entity_id] for entity_id in selection if entity_id in by_id]


@remembers(8)
def _by_id(level: Level) -> Mapping[EntityId, Record]:
    by_id: dict[EntityId, Record] = {entity.id: entity for entity in level.entities()}
    return by_id | {name: getattr(level.arena, name) for name in ARENA_NAMES}


def field_name(field: str) -> str:
    """Return a dotted field in words, as the panels call it: `Limits min`, `Time limit`."""
    if field in _SPOKEN:
        return _SPOKEN[field]
    return field.replace(".", " ").replace("_", " ").capitalize()


def _worded(field: str, value: Any) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if not isinstance(value, float):
        return str(value)
    return f"{math.degrees(value):.4g}°" if field in _ANGLES else f"{value:.6g}"


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetField:
    """Sets one field of every selected entity that has it; entities without it are passed over."""

    ids: Selection
    field: str
    """Dotted name in the native format: `density`, `shape.radius`, `motor.speed`, `limits.min`."""
    value: Any
    shown: str = ""
    """The value as the user sees it, with its unit; empty: angles in degrees."""

    @property
    def label(self) -> str:
        """Label with field and value."""
        shown = self.shown or _worded(self.field, self.value)
        name = field_name(self.field)
        return f"{name} → {shown}" if len(shown) <= 24 else f"Change {name.lower()}"

    @property
    def merge_key(self) -> Hashable:
        """The same field of the same entities."""
        return "set", self.ids, self.field

    def apply(self, level: Level) -> Level:
        """Set the field.

        Raises:
            CommandError: No entity has the field, or the format does not allow the value.
        """
        return _with_values(level, self.field, dict.fromkeys(self.ids, self.value))


@dataclasses.dataclass(frozen=True, kw_only=True)
class AdjustField:
    """Changes one numeric field of every selected entity, starting from its own value."""

    ids: Selection
    field: str
    """Dotted name in the native format."""
    change: Change
    """In the unit that is stored."""
    low: float = -math.inf
    """Values stop at these limits."""
    high: float = math.inf
    shown: str = ""
    """The change as the user typed it."""

    @property
    def label(self) -> str:
        """Label with field and change."""
        return f"{field_name(self.field)} {self.shown or self.change}"

    @property
    def merge_key(self) -> Hashable:
        """Every change is an entry of its own."""
        return None

    def apply(self, level: Level) -> Level:
        """Change the field of each entity that has it.

        Raises:
            CommandError: No entity has the field, or the format does not allow the value.
        """
        values: dict[EntityId, Any] = {}
        for entity_id in self.ids:
            for record in selected_records(level, (entity_id,)):
                with contextlib.suppress(CommandError):
                    values[entity_id] = self._changed(read_field(record, self.field))
        if not values:
            raise CommandError(f"Nothing that is selected has a field {self.field!r}.")
        return _with_values(level, self.field, values)

    def _changed(self, before: float) -> float:
        value = min(max(self.change.of(before), self.low), self.high)
        return round(value) if isinstance(before, int) else value


@dataclasses.dataclass(frozen=True, kw_only=True)
class ResetFields:
    """Sets fields back, each entity's to a value of its own."""

    rows: tuple[tuple[EntityId, str, Any], ...]
    """Entity, dotted field, value."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Names the first field."""
        return f"Reset {field_name(self.rows[0][1]).lower()}"

    def apply(self, level: Level) -> Level:
        """Set them.

        Raises:
            CommandError: No entity has one of the fields, or the format does not allow the value.
        """
        values: dict[str, dict[EntityId, Any]] = {}
        for entity, field, value in self.rows:
            values.setdefault(field, {})[entity] = value
        for field, each in values.items():
            level = _with_values(level, field, each)
        return level


def _with_values(level: Level, field: str, values: Mapping[EntityId, Any]) -> Level:
    """Give a field a value for each entity; those without the field are passed over.

    Raises:
        CommandError: No entity has the field, or the format does not allow the value.
    """
    changed: dict[EntityId, Record] = {}
    missing = CommandError("Nothing is selected.")
    for entity_id, value in values.items():
        for record in selected_records(level, (entity_id,)):
            try:
                changed[entity_id] = _with_value(record, field, value)
            except CommandError as error:
                missing = error
                if not str(error).startswith("There is no field"):
                    raise
    if not changed:
        raise missing
    return _with_records(level, changed, field)


def _with_value(record: Record, field: str, value: Any) -> Record:
    changed = with_field(record, field, value)
    if isinstance(changed, Body) and field.split(".")[0] in _MASS_FIELDS:
        changed = changed.replace(mass_properties=None)
    if isinstance(changed, Joint) and changed.a == changed.b:
        raise CommandError("A joint needs two different bodies.")
    return changed


def _with_records(level: Level, changed: dict[EntityId, Record], field: str) -> Level:
    replaced: dict[str, Any] = {
        kind: tuple(changed.get(entity.id, entity) for entity in getattr(level, kind))
        for kind in ("bodies", "joints", "thrusters")
    }
    arena = {name: record for name, record in changed.items() if isinstance(name, str)}
    after = level.replace(**replaced, arena=level.arena.replace(**arena))
    bodies = tuple(body.id for body in level.bodies if body.id in changed)
    head = field.split(".")[0]
    if head in ("position", "angle"):
        after = reanchored_each(after, bodies)
    if field == "shape.radius":
        for body_id in bodies:
            after = _with_scaled_parts(after, level.body(body_id))
        after = reanchored_each(after, bodies)
    if head in ("fixed", "shape"):
        for body_id in bodies:
            after = freed(after, body_id)
    return after.replace(
        joints=tuple(
            _holding_as_drawn(after, old, new) if new.id in changed else new
            for old, new in zip(level.joints, after.joints, strict=True)
        )
    )


def _with_scaled_parts(level: Level, old: Body) -> Level:
    """Keep anchors and thrusters where they are on a circle that got another radius."""
    before, now = (read_field(body, "shape.radius") for body in (old, level.body(old.id)))
    factor = now / before if before > 0 else 1.0
    return with_parts(level, (old.id,), lambda at: (factor * at[0], factor * at[1]))


def _holding_as_drawn(level: Level, old: Joint, new: Joint) -> Joint:
    """Let the drawn angle count as zero where a joint would turn it from now on.

    So nothing jumps when the level is played. Limits that are switched off and on again stay.
    """
    try:
        drawn = relative_angle(level, new)
    except KeyError:  # A body is missing; the problems panel reports it.
        return new
    if new.kind == "fixed":
        begins = old.kind != "fixed"
    else:
        begins = _limited(new) and not _limited(old)
        if begins and old.limits is not None and new.limits is not None:
            begins = not new.limits.min <= drawn - new.reference_angle <= new.limits.max
    return new.replace(reference_angle=drawn) if begins else new


def _limited(joint: Joint) -> bool:
    return joint.limits is not None and joint.limits.on


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetLevelField:
    """Sets a field of the level itself: name, description, tags, gravity, size and so on."""

    field: str
    value: Any

    @property
    def label(self) -> str:
        """Label with the name of the field."""
        return f"Change {self.field.split('.')[0].replace('_', ' ')}"

    @property
    def merge_key(self) -> Hashable:
        """The same field."""
        return "level", self.field

    def apply(self, level: Level) -> Level:
        """Set the field.

        Raises:
            CommandError: The entity has no such field, or the format does not allow the value.
        """
        head = self.field.split(".")[0]
        if head in ("bodies", "joints", "thrusters", "solution"):
            raise _no_field(level, self.field)
        changed = with_field(level, self.field, self.value)
        assert isinstance(changed, Level)
        return changed


@dataclasses.dataclass(frozen=True, kw_only=True)
class PasteProperties:
    """Gives the selected entities the properties of another of their kind."""

    ids: Selection
    source: Body | Joint | Any
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the number of items."""
        return count_label("Paste properties on", len(self.ids), "item")

    def apply(self, level: Level) -> Level:
        """Copy the properties, not the place, the shape or the bodies.

        Raises:
            CommandError: Nothing of the source's kind is selected.
        """
        names = PROPERTIES[type(self.source).__name__]
        values = {name: getattr(self.source, name) for name in names}
        changed: dict[EntityId, Record] = {}
        for entity_id in self.ids:
            for record in selected_records(level, (entity_id,)):
                if type(record) is type(self.source):
                    extra = {"mass_properties": None} if isinstance(record, Body) else {}
                    changed[entity_id] = record.replace(**values, **extra)
        if not changed:
            raise CommandError("Nothing of the copied kind is selected.")
        return _with_records(level, changed, "fixed")


PROPERTIES: Final = {
    "Body": ("density", "friction", "restitution", "role", "fixed", "collision"),
    "Joint": ("kind", "motor", "limits"),
    "Thruster": ("power", "binding"),
}
"""Properties that pasting copies."""
