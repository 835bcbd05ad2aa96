"""Contact points for debug drawing: plain geometry of a snapshot, no engine internals."""

import math

import numpy as np

from editor.documents.commands.bodies import posed
from editor.worker.snapshots import ContactPoint, Snapshot
from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.spec import Capacity
from kinetix.level.geometry import (
    arena_body,
    overlap_depth,
    segment_distance,
    signed_distance,
    world_vertices,
)
from kinetix.level.graph import components, may_push
from kinetix.level.model import ARENA_NAMES, Body, BodyReference, Circle, Level, Point
from kinetix.level.slots import body_slots

TOUCH: float = 0.02
"""Corners this near to the other body count as contact points [m]."""
Pair = tuple[BodyReference, BodyReference]


def pushing_pairs(level: Level) -> frozenset[Pair]:
    """Return the pairs of bodies that can push each other, both ways round."""
    component = components(level.joints)
    bodies: list[tuple[BodyReference, Body]] = [(body.id, body) for body in level.bodies]
    for name in ARENA_NAMES:
        bodies.append((name, arena_body(level.arena, name)))
    found: set[Pair] = set()
    for a in bodies:
        found |= {(a[0], b[0]) for b in bodies if a is not b and may_push(a, b, component)}
    return frozenset(found)


def touching_bodies(
    level: Level, capacity: Capacity, touching: np.ndarray, pushing: frozenset[Pair]
) -> tuple[Pair, ...]:
    """Return the pairs of bodies that touch and push each other, as ids and arena names.

    The engine also tells of parts of one machine that overlap: they lie in each other without
    any contact.
    """
    named: dict[int, BodyReference] = {
        slot: reference for reference, slot in body_slots(level, capacity).items()
    }
    pairs = candidate_pairs(capacity)[touching]
    found: list[Pair] = [
        (named[a], named[b]) for a, b in pairs.tolist() if a in named and b in named
    ]
    return tuple(pair for pair in found if pair in pushing)


def contact_points(
    level: Level, snapshot: Snapshot, pairs: tuple[Pair, ...]
) -> tuple[ContactPoint, ...]:
    """Contact points of the touching pairs, one or two each."""
    now = posed(level, snapshot)
    bodies: dict[BodyReference, Body] = {body.id: body for body in now.bodies}
    for name in ARENA_NAMES:
        bodies[name] = arena_body(level.arena, name)
    found: list[ContactPoint] = []
    for a, b in pairs:
        found += _between(a, b, bodies[a], bodies[b])
    return tuple(found)


def _between(a: BodyReference, b: BodyReference, body_a: Body, body_b: Body) -> list[ContactPoint]:
    separation = -overlap_depth(body_a, body_b)
    if isinstance(body_a.shape, Circle):
        points = [_nearest(body_b, body_a.position)]
    elif isinstance(body_b.shape, Circle):
        points = [_nearest(body_a, body_b.position)]
    else:
        points = [p for p in world_vertices(body_a) if signed_distance(body_b, p) <= TOUCH]
        points += [p for p in world_vertices(body_b) if signed_distance(body_a, p) <= TOUCH]
    return [
        ContactPoint(
            at=point,
            normal=_normal(body_a, body_b, point),
            separation=separation,
            body_a=a,
            body_b=b,
        )
        for point in points[:2]
    ]


def _nearest(body: Body, point: Point) -> Point:
    """Return the point of a body's outline nearest to a point."""
    if isinstance(body.shape, Circle):
        dx, dy = point[0] - body.position[0], point[1] - body.position[1]
        length = math.hypot(dx, dy) or 1.0
        r = body.shape.radius
        return body.position[0] + dx / length * r, body.position[1] + dy / length * r
    corners = world_vertices(body)
    edges = [(corners[k - 1], corners[k]) for k in range(len(corners))]
    p, q = min(edges, key=lambda edge: segment_distance(point, *edge))
    dx, dy = q[0] - p[0], q[1] - p[1]
    along = ((point[0] - p[0]) * dx + (point[1] - p[1]) * dy) / ((dx * dx + dy * dy) or 1.0)
    along = min(max(along, 0.0), 1.0)
    return p[0] + along * dx, p[1] + along * dy


def _normal(body_a: Body, body_b: Body, point: Point) -> Point:
    """Return the unit vector from a to b at a contact: out of the flatter of the two outlines."""
    if isinstance(body_a.shape, Circle):
        dx, dy = point[0] - body_a.position[0], point[1] - body_a.position[1]
    elif isinstance(body_b.shape, Circle):
        dx, dy = body_b.position[0] - point[0], body_b.position[1] - point[1]
    else:
        return _edge_normal(body_a, body_b, point)
    length = math.hypot(dx, dy) or 1.0
    return dx / length, dy / length


def _edge_normal(body_a: Body, body_b: Body, point: Point) -> Point:
    best: tuple[float, Point] = (math.inf, (0.0, 1.0))
    for body, sign in ((body_a, 1.0), (body_b, -1.0)):
        corners = world_vertices(body)
        other = body_b if sign > 0 else body_a
        for k in range(len(corners)):
            p, q = corners[k - 1], corners[k]
            length = math.dist(p, q) or 1.0
            normal = ((q[1] - p[1]) / length, (p[0] - q[0]) / length)
            # The edge that the other body has crossed the least is the one that it rests on.
            depth = -min(
                (x - p[0]) * normal[0] + (y - p[1]) * normal[1] for x, y in world_vertices(other)
            )
            if depth < best[0]:
                best = (depth, (sign * normal[0], sign * normal[1]))
    del point
    return best[1]


def deepest(contacts: tuple[ContactPoint, ...]) -> float:
    """Return the deepest overlap [m]; 0 when nothing overlaps."""
    return max((-contact.separation for contact in contacts), default=0.0) if contacts else 0.0
