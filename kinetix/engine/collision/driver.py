"""Collision detection: a table of pairs of shapes, each with its kernels. Worlds on the last axis.

Two stages. The *approach* of every candidate pair is exact and cheap; it shows which pairs touch
(the reward and the observations ask for all of them) and which come near. Only the near ones get
*contact points*, in a fixed number of slots, so that the solver's work goes with what happens in a
scene and not with what it has room for.

Normals point from body a to body b.
Source: speculative contacts and feature ids after Catto, "Continuous Collision" (2013) and
"Contact Manifolds" (2007).
"""

import dataclasses
import functools
import itertools
from collections.abc import Callable, Sequence
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from kinetix.engine import constants
from kinetix.engine.active_rows import InUse
from kinetix.engine.collision import circle_circle, circle_polygon, polygon_polygon
from kinetix.engine.collision.compact import compact
from kinetix.engine.collision.points import Approach, Found, PointList, Slots, Spot
from kinetix.engine.collision.scene import MovingShapes, Pairs, Rules
from kinetix.engine.lookup import row, take
from kinetix.engine.pairs import candidate_pairs, pair_counts, pushing_candidates
from kinetix.engine.shapes import rows
from kinetix.engine.spec import SceneSpec
from kinetix.engine.store import Store
from kinetix.engine.types import Parameters, State, World


@dataclasses.dataclass(frozen=True, kw_only=True)
class Kind:
    """A pair of shapes: a row of the table."""

    name: str
    """As in `Slots`."""
    shape_a: str
    shape_b: str
    approach: Callable[[Any, Any, Array], Approach]
    points: Callable[[Any, Any, Approach, Array, Array, Store], list[Spot]]
    most_points: int
    """Most contact points of one pair."""


KINDS: Final = (
    Kind(
        name="polygon_polygon",
        shape_a="polygon",
        shape_b="polygon",
        approach=polygon_polygon.approach,
        points=polygon_polygon.points,
        most_points=2,
    ),
    Kind(
        name="circle_polygon",
        shape_a="circle",
        shape_b="polygon",
        approach=circle_polygon.approach,
        points=circle_polygon.points,
        most_points=1,
    ),
    Kind(
        name="circle_circle",
        shape_a="circle",
        shape_b="circle",
        approach=circle_circle.approach,
        points=circle_circle.points,
        most_points=1,
    ),
)
"""In the order of `pairs.pair_counts`."""

HALVINGS: Final = 12
"""Of the range of ranks, to find those that there is room for."""


def find_contacts(
    world: World,
    state: State,
    parameters: Parameters,
    spec: SceneSpec,
    slots: Slots,
    store: Store,
) -> Found:
    """Find all contacts of a step, from the poses and velocities at its start."""
    a, b = candidate_pairs(spec.capacity).T
    shapes = MovingShapes.of(world, state, store)
    rules = store(Rules.of(world, state, parameters, shapes, (a, b)))
    places = _places(spec)
    approaches = [
        store(
            kind.approach(
                shapes.listed(kind.shape_a, a[place]),
                shapes.listed(kind.shape_b, b[place]),
                parameters.dt,
            )
        )
        for kind, place in zip(KINDS, places, strict=True)
    ]
    separation = jnp.concatenate([coming.separation for coming in approaches], axis=0)
    reach = jnp.where(rules.pushes, constants.TOUCH_SLOP, 0)
    near, overflow = store(_near(rules, approaches, places, slots))
    points = PointList.empty(slots.points, state.rotation)
    for kind, place, listed, coming in zip(
        KINDS, places, pushing_candidates(spec.capacity, spec.features), approaches, strict=True
    ):
        if len(listed) == 0:
            continue
        index, valid = store(compact(rows(near[place], listed), getattr(slots, kind.name)))
        pairs = jnp.asarray(listed, jnp.int32)[index]
        gather = _Gatherer(
            kind=kind,
            shapes=shapes,
            bodies=(a[place], b[place]),
            first=place.start,
            coming=coming,
            rules=rules,
            parameters=parameters,
        )
        points = gather.points(pairs, valid, points)
    return Found(
        points=points.points,
        touching=rules.may_touch & (separation <= reach),
        overflow=overflow | (points.count > slots.points),
        polygons=shapes.polygons,
    )


def _places(spec: SceneSpec) -> list[slice]:
    """Return the place of each kind of pair among all candidates."""
    ends = np.cumsum([0, *pair_counts(spec.capacity)]).tolist()
    return [slice(first, last) for first, last in itertools.pairwise(ends)]


def _near(
    rules: Rules,
    approaches: Sequence[Approach],
    places: Sequence[slice],
    slots: Slots,
) -> tuple[Bool[Array, "q n"], Bool[Array, " n"]]:
    """Choose the pairs that get contact points, and mark worlds without room for all of them.

    Where there is not room for all that are near, the most urgent ones count: those that touch,
    then those that will meet within the step, then the others, by the gap between them.
    """
    separation, meets = (
        jnp.concatenate([getattr(coming, name) for coming in approaches], axis=0)
        for name in ("separation", "meets")
    )
    near = rules.pushes & (separation <= rules.margin)
    counts = [place.stop - place.start for place in places]
    rooms = [getattr(slots, kind.name) for kind in KINDS]
    most = sum(kind.most_points * count for kind, count in zip(KINDS, counts, strict=True))
    if most <= slots.points and all(
        count <= room for count, room in zip(counts, rooms, strict=True)
    ):
        return near, jnp.zeros(near.shape[-1], bool)

    def crowded(near: Bool[Array, "q n"]) -> Bool[Array, " n"]:
        """Return whether there are too many pairs of a kind."""
        found = [
            jnp.sum(near[place], axis=0) > room for place, room in zip(places, rooms, strict=True)
        ]
        return functools.reduce(jnp.logical_or, found)

    def full(near: Bool[Array, "q n"]) -> Bool[Array, " n"]:
        """Return whether there are too many, or they may have too many points."""
        points = [
            kind.most_points * jnp.sum(near[place], axis=0)
            for kind, place in zip(KINDS, places, strict=True)
        ]
        return crowded(near) | (functools.reduce(jnp.add, points) > slots.points)

    def ranked() -> tuple[Bool[Array, "q n"], Bool[Array, " n"]]:
        share = jnp.clip(separation / rules.margin, 0, 1)
        touches = separation <= constants.TOUCH_SLOP
        rank = jnp.where(touches, 0, jnp.where(meets, 1, 2) + share)

        def halve(_: Int[Array, ""], bounds: tuple[Array, Array]) -> tuple[Array, Array]:
            fits, too_many = bounds
            middle = (fits + too_many) / 2
            over = full(near & (rank <= middle))
            return jnp.where(over, fits, middle), jnp.where(over, middle, too_many)

        everything = jnp.full(near.shape[-1], 3.0, separation.dtype)
        nothing = jnp.zeros_like(everything)
        last, _ = jax.lax.fori_loop(0, HALVINGS, halve, (nothing, everything))
        chosen = near & ((rank <= last) | ~full(near))
        return chosen, crowded(chosen)

    return jax.lax.cond(
        jnp.any(full(near)), ranked, lambda: (near, jnp.zeros(near.shape[-1], bool))
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Gatherer:
    """Adds the contact points of near pairs of one kind to a list, pair after pair."""

    kind: Kind
    shapes: MovingShapes
    bodies: Pairs
    first: int
    """The number of the kind's first pair."""
    coming: Approach
    rules: Rules
    parameters: Parameters

    def points(
        self, pairs: Int[Array, "k n"], valid: Bool[Array, "k n"], found: PointList
    ) -> PointList:
        """Return the list with the points of some pairs added; time goes with those in use."""
        store, kind = self.shapes.store, self.kind
        margin = self.rules.margin[self.first : self.first + len(self.bodies[0])]

        def visit(k: Int[Array, ""], found: PointList) -> PointList:
            pair, counts = row(pairs, k), row(valid, k)
            body_a, body_b = (jnp.asarray(bodies)[pair] for bodies in self.bodies)
            a, b = (
                self.shapes.chosen(kind.shape_a, body_a),
                self.shapes.chosen(kind.shape_b, body_b),
            )
            coming, ahead = store(take((self.coming, margin), pair))
            spots = store(kind.points(a, b, coming, ahead, self.parameters.dt, store))
            for spot in spots:
                found = found.with_spot(spot, (body_a, body_b), pair + self.first, counts)
            return found

        return InUse.of((valid, 1)).each(visit, found)
