"""Contacts between circles and convex polygons, with room ahead for fast bodies.

Two stages. The *separation* of every candidate pair is exact and cheap; it tells which pairs touch
(the reward and the observations ask for all of them) and which come near. Only the near ones get
*contact points*, in a fixed number of slots, so that the solver's work goes with what happens in a
scene and not with what it has room for.

Normals point from body a to body b. Worlds are on the last axis.
Source: speculative contacts and feature ids after Catto, "Continuous Collision" (2013) and
"Contact Manifolds" (2007).
"""

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine import constants, maths
from kinetix.engine.lookup import accumulate, row, take, take_pair
from kinetix.engine.maths import Vec, dot, length, nonzero, vec
from kinetix.engine.pairs import candidate_pairs, pair_counts, pushing_candidates
from kinetix.engine.shapes import (
    FAR,
    Polygons,
    rows,
    rows_vec,
    turn_polygons,
)
from kinetix.engine.spec import SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Parameters, State, World
from kinetix.pytree import pytree


@pytree
class Points:
    """Contact points, `c` slots in every world."""

    body_a: Int[Array, "c n"]
    body_b: Int[Array, "c n"]
    normal: Vec
    arm_a: Vec
    """From the centre of body a to the contact point [m]."""
    arm_b: Vec
    separation: Float[Array, "c n"]
    """Gap along the normal [m]; negative when overlapping; `FAR` in an empty slot."""
    key: Int[Array, "c n"]
    """Names the pair and the features; the same point keeps its key in the next step; −1: empty."""


@pytree
class Found:
    """What collision detection tells."""

    points: Points
    touching: Bool[Array, "q n"]
    overflow: Bool[Array, " n"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Slots:
    """How many near pairs of each kind, and how many points in all, a world has room for."""

    polygon_polygon: int
    circle_polygon: int
    circle_circle: int
    points: int


FEATURES = 16
"""Feature ids per pair: 4·(corner of a) + (corner of b)."""


def find_contacts(
    world: World,
    state: State,
    parameters: Parameters,
    spec: SceneSpec,
    slots: Slots,
    store: Store,
) -> Found:
    """All contacts of a step, from the poses and velocities at its start."""
    scene = _Scene.of(world, state, parameters, spec, store)
    kinds = []
    touching = []
    overflow = jnp.zeros(state.rotation.shape[-1], bool)
    first = 0
    for (separation, faces), maker, room, count, listed in zip(
        store((scene.polygon_polygon(), scene.circle_polygon(), scene.circle_circle())),
        (scene.polygon_points, scene.circle_polygon_points, scene.circle_points),
        (slots.polygon_polygon, slots.circle_polygon, slots.circle_circle),
        pair_counts(spec.capacity),
        pushing_candidates(spec.capacity, spec.features),
        strict=True,
    ):
        pairs = slice(first, first + count)
        first += count
        if count == 0:
            continue
        pushes = scene.pushes[pairs]
        reach = jnp.where(pushes, constants.TOUCH_SLOP, 0)
        touching.append(scene.may_touch[pairs] & (separation <= reach))
        if len(listed) == 0:
            continue
        near = store(pushes & (separation <= scene.margin[pairs]))
        index, valid, full = store(compact(rows(near, listed), room))
        overflow |= full
        kinds += store(maker(jnp.asarray(listed, jnp.int32)[index], valid, faces))
    if not kinds:
        return Found(
            points=_no_points(state.rotation),
            touching=jnp.concatenate(touching, axis=0),
            overflow=overflow,
        )
    points = jax.tree.map(lambda *x: jnp.concatenate(x, axis=0), *kinds)
    points, full = store(_tightest(points, slots.points, store))
    return Found(
        points=points, touching=jnp.concatenate(touching, axis=0), overflow=overflow | full
    )


def _no_points(rotation: Float[Array, "b n"]) -> Points:
    """Of a scene in which nothing can push anything."""
    none = rotation[:0]
    nowhere, nothing = Vec(x=none, y=none), none.astype(jnp.int32)
    return Points(
        body_a=nothing,
        body_b=nothing,
        normal=nowhere,
        arm_a=nowhere,
        arm_b=nowhere,
        separation=none,
        key=nothing,
    )


def compact(
    mask: Bool[Array, "q n"], room: int
) -> tuple[Int[Array, "k n"], Bool[Array, "k n"], Bool[Array, " n"]]:
    """Rows where the mask holds, in order, in `room` slots; whether a slot is used; overflow."""
    count, worlds = mask.shape
    numbers = np.arange(1, room + 1, dtype=np.int32)[:, None]

    def pass_row(k: Int[Array, ""], carry: tuple[Array, Array]) -> tuple[Array, Array]:
        seen, index = carry
        seen += row(mask, k)
        return seen, index + (seen < numbers)

    start = jnp.zeros((1, worlds), jnp.int32), jnp.zeros((room, worlds), jnp.int32)
    seen, index = accumulate(count, pass_row, start)
    return jnp.minimum(index, count - 1), index < count, seen[0] > room


def _tightest(points: Points, room: int, store: Store) -> tuple[Points, Bool[Array, " n"]]:
    """Squeeze the used slots together; of too many, those that are still open are left out."""
    if points.key.shape[0] <= room:
        return points, jnp.zeros(points.key.shape[-1], bool)
    used = points.key >= 0
    full = jnp.sum(used, axis=0) > room
    used &= ~full | (points.separation <= constants.TOUCH_SLOP)
    index, valid, full = store(compact(used, room))
    chosen = take(points, index)
    return dataclasses.replace(
        chosen,
        separation=jnp.where(valid, chosen.separation, FAR),
        key=jnp.where(valid, chosen.key, -1),
    ), full


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Scene:
    """One step's geometry, shared by the kinds of pairs."""

    world: World
    polygons: Polygons
    centre: Vec
    velocity: Vec
    pairs: Int[np.ndarray, "q 2"]
    counts: tuple[int, int, int]
    polygon_count: int
    may_touch: Bool[Array, "q n"]
    pushes: Bool[Array, "q n"]
    margin: Float[Array, "q n"]
    dt: Float[Array, " n"]
    store: Store

    @staticmethod
    def of(
        world: World, state: State, parameters: Parameters, spec: SceneSpec, store: Store
    ) -> "_Scene":
        pairs = candidate_pairs(spec.capacity)
        bodies = world.bodies
        a, b = pairs[:, 0], pairs[:, 1]
        mode_a, mode_b = bodies.collision_mode[a], bodies.collision_mode[b]
        may_touch = (
            bodies.active[a]
            & bodies.active[b]
            & ((mode_a == 2) | (mode_b == 2) | (mode_a * mode_b > 0))
        )
        movable = (bodies.inverse_mass[a] > 0) | (bodies.inverse_mass[b] > 0)
        polygons = store(turn_polygons(bodies, state.rotation))
        velocity = vec(state.velocity)
        # A corner covers ω·R·dt on top of what its centre covers; a circle's turning moves nothing.
        radius = jnp.concatenate([polygons.radius, jnp.zeros_like(bodies.radius)], axis=0)
        sweep = jnp.abs(state.angular_velocity) * jnp.where(bodies.active, radius, 0)
        closing = length(velocity[b] - velocity[a]) + sweep[a] + sweep[b]
        margin = jnp.maximum(
            constants.SPECULATIVE_DISTANCE, parameters.dt * closing + constants.ACCELERATION_MARGIN
        )
        pushes = may_touch & movable & world.collides[a, b]
        centre = vec(state.position)
        may_touch, pushes, margin, centre, velocity = store(
            (may_touch, pushes, margin, centre, velocity)
        )
        return _Scene(
            world=world,
            polygons=polygons,
            centre=centre,
            velocity=velocity,
            pairs=pairs,
            counts=pair_counts(spec.capacity),
            polygon_count=spec.capacity.polygons,
            may_touch=may_touch,
            pushes=pushes,
            margin=margin,
            dt=parameters.dt,
            store=store,
        )

    def _kind(self, kind: int) -> tuple[Int[np.ndarray, " q"], Int[np.ndarray, " q"], int]:
        start = sum(self.counts[:kind])
        rows = self.pairs[start : start + self.counts[kind]]
        return rows[:, 0], rows[:, 1], start

    # Separations of all pairs of a kind, and what the points need to know beside them.

    def polygon_polygon(self) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
        """Largest separation over all edge normals; and which edge has it (0–3 of a, 4–7 of b)."""
        a, b, _ = self._kind(0)
        apart = self.centre[b] - self.centre[a]
        gap_a, edge_a = self._face_separation(a, b, apart)
        gap_b, edge_b = self._face_separation(b, a, -apart)
        swap = gap_b > gap_a + constants.LINEAR_SLOP
        return jnp.maximum(gap_a, gap_b), jnp.where(swap, edge_b + 4, edge_a)

    def _face_separation(
        self, a: Int[np.ndarray, " q"], b: Int[np.ndarray, " q"], apart: Vec
    ) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
        polygons = self.polygons
        normals, corners, offsets = self.store(
            (
                rows_vec(polygons.normals, a),
                rows_vec(polygons.corners, b),
                rows(polygons.offsets, a),
            )
        )
        nearest = functools.reduce(
            jnp.minimum, [dot(normals, corner) for corner in _corners(corners)]
        )
        return _largest(dot(normals, apart[:, None]) + nearest - offsets)

    def circle_polygon(self) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
        """Signed distance of the surfaces; and the edge with the largest face distance."""
        a, b, _ = self._kind(1)
        polygons = self.polygons
        offset = self.centre[a] - self.centre[b]
        face, edge = _largest(
            dot(rows_vec(polygons.normals, b), offset[:, None]) - rows(polygons.offsets, b)
        )
        corners, normals = rows_vec(polygons.corners, b), rows_vec(polygons.normals, b)
        distance = self._beyond_face(offset, face, *_edge_ends(corners, normals, edge))[0]
        return distance - self._radius(a), edge

    @staticmethod
    def _beyond_face(
        offset: Vec, face: Float[Array, "q n"], start: Vec, end: Vec, normal: Vec
    ) -> tuple[Float[Array, "q n"], Vec, Bool[Array, "q n"], Bool[Array, "q n"]]:
        """Distance of a point from a polygon whose nearest face is known.

        Returns:
            Signed distance, the nearest corner, whether a corner is nearest, whether it is the end.
        """
        along = Vec(x=normal.y, y=-normal.x)
        before = dot(along, offset - start) < 0
        after = dot(along, offset - end) > 0
        corner = maths.where(after, end, start)
        at_corner = (before | after) & (face > 0)
        return jnp.where(at_corner, length(offset - corner), face), corner, at_corner, after

    def _radius(self, circle: Int[Array, "k n"] | Int[np.ndarray, " k"]) -> Float[Array, "k n"]:
        radius = self.world.bodies.radius
        slot = circle - self.polygon_count
        return radius[slot] if slot.ndim == 1 else take(radius, jnp.asarray(slot))

    def circle_circle(self) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
        """Distance of the surfaces; circles have one face."""
        a, b, _ = self._kind(2)
        distance = length(self.centre[b] - self.centre[a])
        gap = distance - self._radius(a) - self._radius(b)
        return gap, jnp.zeros(gap.shape, jnp.int32)

    # Contact points of the near pairs of a kind.

    def _bodies(
        self, kind: int, index: Int[Array, "k n"]
    ) -> tuple[Int[Array, "k n"], Int[Array, "k n"], Int[Array, "k n"]]:
        """Body a, body b and pair number of each slot."""
        a, b, start = self._kind(kind)
        return jnp.asarray(a)[index], jnp.asarray(b)[index], index + start

    def _points(
        self,
        a: Int[Array, "k n"],
        b: Int[Array, "k n"],
        normal: Vec,
        arms: tuple[Vec, Vec],
        separation: Float[Array, "k n"],
        key: Int[Array, "k n"],
        valid: Bool[Array, "k n"],
    ) -> Points:
        return Points(
            body_a=a,
            body_b=b,
            normal=normal,
            arm_a=arms[0],
            arm_b=arms[1],
            separation=jnp.where(valid, separation, FAR),
            key=jnp.where(valid, key, -1),
        )

    def _at(self, a: Int[Array, "k n"], b: Int[Array, "k n"], place: Vec) -> tuple[Vec, Vec]:
        """Arms of both bodies to a place that is relative to body b's centre."""
        of_a, of_b = take_pair(self.centre, a, b)
        return place + of_b - of_a, place

    def circle_points(
        self,
        index: Int[Array, "k n"],
        valid: Bool[Array, "k n"],
        faces: Int[Array, "q n"],
    ) -> list[Points]:
        """One point for two circles; the normal is that of the moment when they will touch."""
        del faces
        a, b, pair = self._bodies(2, index)
        of_a, of_b = take_pair(self.centre, a, b)
        apart = of_b - of_a
        radius_a, radius_b = self._radius(a), self._radius(b)
        normal, gap = self._round_contact(apart, a, b, radius_a + radius_b)
        arms = normal * radius_a, normal * -radius_b
        return [self._points(a, b, normal, arms, gap, pair * FEATURES, valid)]

    def _round_contact(
        self, apart: Vec, a: Int[Array, "k n"], b: Int[Array, "k n"], radius: Float[Array, "k n"]
    ) -> tuple[Vec, Float[Array, "k n"]]:
        """Normal and gap of a round surface, at the time of impact if one lies ahead in the step.

        With them, gap + time·closing speed is zero exactly, so an oblique hit found a step early
        still gets the right normal.
        """
        of_a, of_b = take_pair(self.velocity, a, b)
        motion = of_b - of_a
        squared = dot(motion, motion)
        half = dot(apart, motion)
        root = half**2 - squared * (dot(apart, apart) - radius**2)
        time = (-half - jnp.sqrt(jnp.maximum(root, 0))) / nonzero(squared)
        ahead = (root > 0) & (squared > 0) & (time > 0) & (time < self.dt)
        then = apart + motion * jnp.where(ahead, time, 0)
        distance = length(then)
        fallback = Vec(x=jnp.zeros_like(distance), y=jnp.ones_like(distance))
        normal = maths.where(distance > 1e-9, then / nonzero(distance), fallback)
        return normal, dot(normal, apart) - radius

    def circle_polygon_points(
        self,
        index: Int[Array, "k n"],
        valid: Bool[Array, "k n"],
        edges: Int[Array, "q n"],
    ) -> list[Points]:
        """One point: on the nearest face, or at the nearest corner."""
        a, b, pair = self._bodies(1, index)
        edge = take(edges, index)
        polygons = self.polygons
        corners, normals = self.store(take((polygons.corners, polygons.normals), b))
        start, end, outward = _edge_ends(corners, normals, edge)
        of_a, of_b = take_pair(self.centre, a, b)
        offset = of_a - of_b
        radius = self._radius(a)
        face = dot(outward, offset - start)
        _, corner, at_corner, at_end = self._beyond_face(offset, face, start, end, outward)
        round_normal, round_gap = self._round_contact(corner - offset, a, b, radius)
        gap = jnp.where(at_corner, round_gap, face - radius)
        normal = maths.where(at_corner, round_normal, -outward)
        on_face = offset + normal * (radius + gap)
        arms = normal * radius, maths.where(at_corner, corner, on_face)
        corner_count = self.polygons.offsets.shape[1]
        feature = jnp.where(at_corner, (edge + at_end) % corner_count, edge)
        return [self._points(a, b, normal, arms, gap, pair * FEATURES + feature, valid)]

    def polygon_points(
        self,
        index: Int[Array, "k n"],
        valid: Bool[Array, "k n"],
        faces: Int[Array, "q n"],
    ) -> list[Points]:
        """Two clipped points on the reference face, or one where two corners are nearest."""
        a, b, pair = self._bodies(0, index)
        face = take(faces, index)
        swap = face >= 4
        reference, incident = jnp.where(swap, b, a), jnp.where(swap, a, b)
        edge = face % 4
        polygons = self.polygons
        own, others = self.store(
            take_pair((polygons.corners, polygons.normals), reference, incident)
        )
        start, end, normal = self.store(_edge_ends(*own, edge))
        of_reference, of_incident = take_pair(self.centre, reference, incident)
        apart = of_incident - of_reference
        other = self.store(_most_opposed(others[1], normal))
        first, last, _ = _edge_ends(*others, other)
        first, last = self.store((first + apart, last + apart))
        clipped = self.store(_clip(start, end, normal, first, last))
        (low, high), (gap_low, gap_high), survives = clipped
        corner_gap, corner_normal, corner_point, which, use_corner = self.store(
            _corner_pair(start, end, first, last, survives, gap_low, gap_high)
        )

        # From here on in terms of a and b, relative to the centre of b.
        to_b = maths.where(swap, Vec(x=jnp.zeros_like(apart.x), y=jnp.zeros_like(apart.y)), -apart)
        sign = jnp.where(swap, -1.0, 1.0).astype(apart.x.dtype)
        margin = take(self.margin, pair)
        own_corner, other_corner = (edge, (edge + 1) % 4), (other, (other + 1) % 4)

        def key(ref: Int[Array, "k n"], inc: Int[Array, "k n"]) -> Int[Array, "k n"]:
            return pair * FEATURES + jnp.where(swap, 4 * inc + ref, 4 * ref + inc)

        corner_key = key(
            jnp.where(which % 2 == 1, own_corner[1], own_corner[0]),
            jnp.where(which >= 2, other_corner[1], other_corner[0]),
        )
        gap_first = jnp.where(use_corner, corner_gap, gap_low)
        first_point = self._points(
            a,
            b,
            maths.where(use_corner, corner_normal, normal) * sign,
            self._at(
                a, b, maths.where(use_corner, corner_point, low - normal * (0.5 * gap_low)) + to_b
            ),
            gap_first,
            jnp.where(use_corner, corner_key, key(own_corner[0], other_corner[1])),
            valid & (survives | use_corner) & (gap_first <= margin),
        )
        second_point = self._points(
            a,
            b,
            normal * sign,
            self._at(a, b, high - normal * (0.5 * gap_high) + to_b),
            gap_high,
            key(own_corner[1], other_corner[0]),
            valid & survives & ~use_corner & (gap_high <= margin),
        )
        return [first_point, second_point]


def _edge_ends(corners: Vec, normals: Vec, edge: Int[Array, "k n"]) -> tuple[Vec, Vec, Vec]:
    """Start, end and normal of an edge of each of `k` polygons."""
    ends = _corners(corners)
    following = [*ends[1:], ends[0]]
    start, end, normal = (
        functools.reduce(
            lambda found, option: maths.where(edge == option[0], option[1], found),
            enumerate((corner[:, 0] for corner in options[1:]), start=1),
            options[0][:, 0],
        )
        for options in (ends, following, _corners(normals))
    )
    return start, end, normal


def _most_opposed(normals: Vec, normal: Vec) -> Int[Array, "k n"]:
    """The edge of each of `k` polygons whose outward normal points most against the given one."""
    best = jnp.full(normal.x.shape, FAR, normal.x.dtype)
    edge = jnp.zeros(normal.x.shape, jnp.int32)
    for i, column in enumerate(_corners(normals)):
        candidate = column[:, 0]
        exists = (candidate.x != 0) | (candidate.y != 0)
        against = jnp.where(exists, dot(candidate, normal), FAR)
        edge = jnp.where(against < best, i, edge)
        best = jnp.minimum(best, against)
    return edge


def _corners(corners: Vec) -> list[Vec]:
    """One after the other, each with an axis of length 1 in place of the corners'."""
    count = corners.x.shape[1]
    columns = [jnp.split(values, count, axis=1) for values in (corners.x, corners.y)]
    return [Vec(x=x, y=y) for x, y in zip(*columns, strict=True)]


def _largest(gaps: Float[Array, "q v n"]) -> tuple[Float[Array, "q n"], Int[Array, "q n"]]:
    """The largest along the middle axis, and where it is first."""
    count = gaps.shape[1]
    best, *others = (part[:, 0] for part in jnp.split(gaps, count, axis=1))
    edge = jnp.zeros(best.shape, jnp.int32)
    for i, gap in enumerate(others, start=1):
        edge = jnp.where(gap > best, i, edge)
        best = jnp.maximum(best, gap)
    return best, edge


def _clip(
    start: Vec, end: Vec, normal: Vec, first: Vec, last: Vec
) -> tuple[tuple[Vec, Vec], tuple[Array, Array], Bool[Array, "k n"]]:
    """Cut the incident edge (first → last) to the width of the reference edge (start → end).

    Returns:
        The points near the start and near the end of the reference edge, their gaps, and whether
        anything of the incident edge lies within that width.
    """
    along = Vec(x=normal.y, y=-normal.x)
    width = dot(along, end - start)
    t_first, t_last = dot(along, first - start), dot(along, last - start)
    span = t_first - t_last
    steep = jnp.abs(span) < 1e-9
    inverse = 1 / jnp.where(steep, 1.0, span)
    low_share = jnp.where(steep, 0.0, jnp.clip(-t_last * inverse, 0, 1))
    high_share = jnp.where(steep, 1.0, jnp.clip((width - t_last) * inverse, 0, 1))
    edge = first - last
    low, high = last + edge * low_share, last + edge * high_share
    survives = (jnp.maximum(t_first, t_last) >= 0) & (jnp.minimum(t_first, t_last) <= width)
    return (low, high), (dot(normal, low - start), dot(normal, high - start)), survives


def _corner_pair(
    start: Vec,
    end: Vec,
    first: Vec,
    last: Vec,
    survives: Bool[Array, "k n"],
    gap_low: Float[Array, "k n"],
    gap_high: Float[Array, "k n"],
) -> tuple[Float[Array, "k n"], Vec, Vec, Int[Array, "k n"], Bool[Array, "k n"]]:
    """The nearest pair of corners of two edges, and whether it rules the contact.

    Without it a contact prepared ahead of time would catch on corners that pass each other.

    Returns:
        Distance, direction from the reference to the incident corner, the point between them, which
        corners (bit 0: end of the reference edge, bit 1: last of the incident one), the verdict.
    """
    best = jnp.full(start.x.shape, FAR, start.x.dtype)
    which = jnp.zeros(start.x.shape, jnp.int32)
    mine, theirs = start, first
    for number, (own, other) in enumerate(
        ((start, first), (end, first), (start, last), (end, last))
    ):
        offset = other - own
        squared = dot(offset, offset)
        nearer = squared < best
        best = jnp.minimum(best, squared)
        which = jnp.where(nearer, number, which)
        mine, theirs = maths.where(nearer, own, mine), maths.where(nearer, other, theirs)
    distance = jnp.sqrt(best)
    direction = (theirs - mine) / nonzero(distance)
    # Both corners are the nearest points of their edges when each edge leads away from the other.
    own_edge = maths.where(which % 2 == 1, start - end, end - start)
    other_edge = maths.where(which >= 2, first - last, last - first)
    outside = (dot(own_edge, theirs - mine) <= 0) & (dot(other_edge, mine - theirs) <= 0)
    smallest = jnp.where(survives, jnp.minimum(gap_low, gap_high), FAR)
    apart = jnp.where(survives, smallest > constants.LINEAR_SLOP, True)
    closer = (distance + constants.LINEAR_SLOP < smallest) | ~survives
    middle = mine + (theirs - mine) * 0.5
    return distance, direction, middle, which, outside & apart & closer & (distance > 1e-9)
