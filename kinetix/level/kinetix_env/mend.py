"""Repairs for kinetix-env levels that our format cannot represent as they are."""

import math

from kinetix.engine.spec import ARENA_BODIES
from kinetix.level.geometry import (
    CENTRE_TOLERANCE,
    body_mass,
    centre_of_corners,
    centre_of_mass,
    polygon_fault,
    recentred,
    reverse_winding,
    same_masses,
    shape_mass,
)
from kinetix.level.kinetix_env.document import KinetixEnvDocument
from kinetix.level.model import (
    Body,
    InertiaModel,
    Joint,
    Level,
    MassProperties,
    Point,
    Polygon,
    Thruster,
)


def frames_model(document: KinetixEnvDocument) -> InertiaModel:
    """The inertia model under which most frames of free polygons are at their centre of mass.

    kinetix-env turns a body about its frame's origin, wherever that is. Its editor puts the origin
    at the mean of the corners; what was a level of ours has it at the area's centroid.

    Returns:
        `"exact"` where that keeps more frames as they are, else `"kinetix"`.
    """
    shapes = [
        reverse_winding(row.vertices[: row.n_vertices])
        for row in document.polygons[ARENA_BODIES:]
        if row.active and row.inverse_mass > 0
    ]
    polygons = [corners for corners in shapes if not polygon_fault(corners)]

    def kept(model: InertiaModel) -> int:
        centres = (centre_of_corners(corners, model) for corners in polygons)
        return sum(math.hypot(*centre) <= CENTRE_TOLERANCE for centre in centres)

    return "exact" if kept("exact") > kept("kinetix") else "kinetix"


def with_centres(level: Level) -> tuple[Level, tuple[int, ...]]:
    """Return the level with every free polygon's frame at its centre of mass, and which changed.

    At the start nothing moves: corners, anchors and thrusters stay where they are in the world,
    and a body keeps the mass and the inertia that it has. It turns about another point then.

    Args:
        level: Corners make polygons (`geometry.polygon_fault`).
    """
    shifts: dict[int, Point] = {}
    bodies: list[Body] = []
    for body in level.bodies:
        shift = (0.0, 0.0)
        if isinstance(body.shape, Polygon) and not body.fixed:
            shift = centre_of_mass(body.shape, level.inertia_model)
        if math.hypot(*shift) > CENTRE_TOLERANCE:
            shifts[body.id] = shift
            bodies.append(_shifted(body, level))
        else:
            bodies.append(body)
    if not shifts:
        return level, ()
    return level.replace(
        bodies=tuple(bodies),
        joints=tuple(_joint(joint, shifts) for joint in level.joints),
        thrusters=tuple(_thruster(thruster, shifts) for thruster in level.thrusters),
    ), tuple(shifts)


def _shifted(body: Body, level: Level) -> Body:
    mass, inertia = body_mass(body, level.inertia_model)
    better = recentred(body, level.inertia_model)
    derived = shape_mass(better.shape, better.density, level.inertia_model)
    if same_masses((1 / mass, 1 / inertia), derived):
        return better.replace(mass_properties=None)
    return better.replace(mass_properties=MassProperties(mass=mass, inertia=inertia))


def _less(point: Point, shift: Point) -> Point:
    return point[0] - shift[0], point[1] - shift[1]


def _joint(joint: Joint, shifts: dict[int, Point]) -> Joint:
    changes: dict[str, Point] = {}
    if isinstance(joint.a, int) and joint.a in shifts:
        changes["anchor_a"] = _less(joint.anchor_a, shifts[joint.a])
    if isinstance(joint.b, int) and joint.b in shifts:
        changes["anchor_b"] = _less(joint.anchor_b, shifts[joint.b])
    return joint.replace(**changes) if changes else joint


def _thruster(thruster: Thruster, shifts: dict[int, Point]) -> Thruster:
    shift = shifts.get(thruster.body)
    return thruster if shift is None else thruster.replace(position=_less(thruster.position, shift))
