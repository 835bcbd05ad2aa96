"""Rules that bind several parts of a level: the codes E008–E013 of reading."""

import math
from collections.abc import Iterator

from kinetix.level.faults import Fault
from kinetix.level.geometry import (
    CENTRE_TOLERANCE,
    centre_of_mass,
    polygon_fault,
    recentred,
)
from kinetix.level.model import (
    ARENA_NAMES,
    MAX_STEPS,
    Body,
    Circle,
    Entity,
    InertiaModel,
    Level,
    Polygon,
)
from kinetix.level.sizes import describe_capacity, needed_capacity, outgrown_capacity


def level_faults(level: Level) -> Iterator[Fault]:
    """Yield what makes a well-typed level unfit to be read.

    Equal tags and a solution that is too long come first, then E008–E013.
    """
    yield from own_faults(level)
    yield from _reference_faults(level)
    yield from _shape_faults(level)
    yield from _size_faults(level)


def own_faults(level: Level) -> Iterator[Fault]:
    """Yield equal tags, a solution that is too long (both E007), and ids that cannot be (E008)."""
    for k, tag in enumerate(level.tags):
        if tag in level.tags[:k]:
            message = f'expected each tag once, got "{tag}" again'
            yield Fault(code="E007", path=f"$.tags[{k}]", message=message)
    if level.solution is not None and level.solution.steps > MAX_STEPS:
        message = f"expected at most {MAX_STEPS} steps in all, got {level.solution.steps}"
        yield Fault(code="E007", path="$.solution.actions", message=message)
    yield from _id_faults(level)


def entity_paths(level: Level) -> Iterator[tuple[str, Entity]]:
    """The JSON path of every entity."""
    for kind, entities in (
        ("bodies", level.bodies),
        ("joints", level.joints),
        ("thrusters", level.thrusters),
    ):
        for k, entity in enumerate(entities):
            yield f"$.{kind}[{k}]", entity


def _id_faults(level: Level) -> Iterator[Fault]:
    owners: dict[int, str] = {}
    for path, entity in entity_paths(level):
        if entity.id in owners:
            message = f"expected an id of its own, got {entity.id}, which {owners[entity.id]} has"
            yield Fault(code="E008", path=f"{path}.id", message=message)
        elif entity.id >= level.next_id:
            message = f"expected x < next_id = {level.next_id}, got {entity.id}"
            yield Fault(code="E008", path=f"{path}.id", message=message)
        owners.setdefault(entity.id, path)


def _reference_faults(level: Level) -> Iterator[Fault]:
    bodies = {body.id for body in level.bodies}

    def missing(path: str, body_id: int) -> Fault:
        message = f"expected the id of a body, got {body_id}, which no body has"
        return Fault(code="E009", path=path, message=message)

    for k, joint in enumerate(level.joints):
        for end, reference in (("a", joint.a), ("b", joint.b)):
            if isinstance(reference, int) and reference not in bodies:
                yield missing(f"$.joints[{k}].{end}", reference)
        if joint.a == joint.b:
            message = f"expected another body than a, got {joint.b}"
            yield Fault(code="E010", path=f"$.joints[{k}].b", message=message)
    for k, thruster in enumerate(level.thrusters):
        if thruster.body not in bodies:
            yield missing(f"$.thrusters[{k}].body", thruster.body)


def _shape_faults(level: Level) -> Iterator[Fault]:
    for name in ARENA_NAMES:
        geometry = getattr(level.arena, name).geometry
        reason = polygon_fault(geometry.vertices) if geometry else None
        if reason:
            yield Fault(code="E011", path=f"$.arena.{name}.geometry.vertices", message=reason)
    for k, body in enumerate(level.bodies):
        if isinstance(body.shape, Circle):
            continue
        path = f"$.bodies[{k}].shape.vertices"
        reason = polygon_fault(body.shape.vertices)
        if reason:
            yield Fault(code="E011", path=path, message=reason)
            continue
        message = centre_fault(body, level.inertia_model)
        if message:
            yield Fault(code="E012", path=path, message=message)


def centre_fault(body: Body, inertia_model: InertiaModel) -> str | None:
    """Return why a free polygon is off its centre of mass, and the right place, or None."""
    if body.fixed or not isinstance(body.shape, Polygon):
        return None
    offset = centre_of_mass(body.shape, inertia_model)
    if math.hypot(*offset) <= CENTRE_TOLERANCE:
        return None
    better = recentred(body, inertia_model)
    if not isinstance(better.shape, Polygon):
        return None
    corners = ", ".join(_point(corner) for corner in better.shape.vertices)
    return (
        f"expected the centre of mass at the origin, got {_point(offset)}; the same body has "
        f"position {_point(better.position)} and vertices [{corners}]"
    )


def _point(point: tuple[float, float]) -> str:
    return f"[{point[0]:.7g}, {point[1]:.7g}]"


def _size_faults(level: Level) -> Iterator[Fault]:
    outgrown = outgrown_capacity(level)
    if outgrown:
        needed = describe_capacity(needed_capacity(level))
        message = (
            f"the level needs {needed} (polygons, circles, joints, thrusters), "
            f"which does not fit {describe_capacity(outgrown)}; "
            "without a size it gets the smallest that fits"
        )
        yield Fault(code="E013", path="$.size", message=message)
