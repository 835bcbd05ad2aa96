"""Problems of values by themselves: what no file could hold."""

import contextlib
import functools
from collections.abc import Iterator

from kinetix.level.canonical import record_tree
from kinetix.level.faults import EnoughFaults, FaultCollector
from kinetix.level.geometry import polygon_fault
from kinetix.level.integrity import centre_fault, entity_paths, own_faults
from kinetix.level.model import (
    ARENA_NAMES,
    MOTOR_BINDINGS,
    THRUSTER_BINDINGS,
    Arena,
    Body,
    Entity,
    Geometry,
    Joint,
    Level,
    Polygon,
    Record,
    Thruster,
)
from kinetix.level.schema import check_tree
from kinetix.level.validate.issue import Issue, capital, describe, issue


# Entities are immutable, so what is wrong with one by itself is found once.
@functools.lru_cache(maxsize=4096)
def _own_faults(entity: Record) -> tuple[tuple[str, str, str], ...]:
    """Faults of a record's own values as (code, path within it, sentence)."""
    found: list[tuple[str, str, str]] = []
    faults = FaultCollector()
    with contextlib.suppress(EnoughFaults):
        check_tree(record_tree(entity), type(entity), "", faults)
    for fault in faults.faults:
        # Bindings have E110; a wrong number of corners has E107.
        if not fault.path.endswith(("binding", ".vertices")):
            found.append(("E106", fault.path, f"{fault.path[1:]}: {fault.message}"))
    for name in ("shape", "geometry"):
        shape = getattr(entity, name, None)
        reason = isinstance(shape, (Polygon, Geometry)) and polygon_fault(shape.vertices)
        if reason and not found:
            found.append(("E107", f".{name}.vertices", reason))
    return tuple(found)


def value_issues(level: Level) -> Iterator[Issue]:
    """Yield the problems of values by themselves: what no file could hold."""
    frame = level.replace(bodies=(), joints=(), thrusters=(), arena=Arena(), next_id=1)
    for code, inner, message in _own_faults(frame):
        yield issue(code, f"Level: {message}.", path=f"${inner}")
    for arena_name in ARENA_NAMES:
        part = getattr(level.arena, arena_name)
        for code, inner, message in _own_faults(part):
            path = f"$.arena.{arena_name}{inner}"
            sentence = f"{capital(describe(arena_name))}: {message}."
            yield issue(code, sentence, path=path, ids=(arena_name,))
    for path, entity in entity_paths(level):
        name = capital(describe(entity.id, entity))
        for code, inner, message in _own_faults(entity):
            fix = "Fix order" if code == "E107" else ""
            yield issue(code, f"{name}: {message}.", path=path + inner, ids=(entity.id,), fix=fix)
        if isinstance(entity, Body) and not _own_faults(entity):
            off_centre = centre_fault(entity, level.inertia_model)
            if off_centre:
                where, message = f"{path}.shape.vertices", f"{name}: {off_centre}."
                yield issue("E107", message, path=where, ids=(entity.id,), fix="Recentre")
        if isinstance(entity, Joint) and entity.motor:
            yield from _binding_issues(
                entity, entity.motor.binding, MOTOR_BINDINGS, f"{path}.motor.binding"
            )
        if isinstance(entity, Thruster):
            yield from _binding_issues(entity, entity.binding, THRUSTER_BINDINGS, f"{path}.binding")


def identity_issues(level: Level) -> Iterator[Issue]:
    """Yield ids and tags that stand twice, ids from `next_id` on, too long a solution (E106)."""
    numbers = (level.next_id, *(entity.id for entity in level.entities()))
    if not all(type(number) is int for number in numbers):
        return  # what is no number has an issue of its own, and no order
    for fault in own_faults(level):
        yield issue("E106", f"Level: {fault.path[2:]}: {fault.message}.", path=fault.path)


def _binding_issues(entity: Entity, binding: int, count: int, path: str) -> Iterator[Issue]:
    if not 0 <= binding < count:
        name = describe(entity.id, entity)
        message = f"Binding {binding} of {name} is out of range 0–{count - 1}."
        yield issue("E110", message, path=path, ids=(entity.id,), fix="Use binding 0")
