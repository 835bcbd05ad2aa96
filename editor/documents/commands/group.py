"""Edits of whole selections: moving, turning, scaling, mirroring, aligning, ordering, deleting."""

import dataclasses
import itertools
from collections.abc import Callable, Hashable, Mapping, Set
from typing import Literal

from editor.documents.commands.base import EntityId, Selection, count_label
from editor.documents.commands.rigid import (
    freed,
    reanchored,
    reanchored_each,
    reshaped,
    unwound,
    with_bodies,
    with_parts,
)
from kinetix.errors import CommandError
from kinetix.level.geometry import (
    bounds,
    centre_of_mass,
    polygon_fault,
    reverse_winding,
    rotate,
    signed_area,
)
from kinetix.level.limits import FARTHEST
from kinetix.level.mirror import BOTH, Axis, End, mirrored_body, mirrored_joint, mirrored_thruster
from kinetix.level.model import (
    Body,
    BodyReference,
    Circle,
    Joint,
    Level,
    Point,
    Polygon,
    Shape,
    Thruster,
)


def _chosen(level: Level, ids: Selection) -> list[Body]:
    bodies = [body for body in level.bodies if body.id in ids]
    if not bodies:
        raise CommandError("Select a shape first.")
    return bodies


@dataclasses.dataclass(frozen=True, kw_only=True)
class Move:
    """Shifts bodies as far as a level reaches; joints to bodies that stay follow the moved ones."""

    ids: Selection
    shift: Point
    """Displacement of every body [m]."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the number of items."""
        return count_label("Move", len(self.ids), "shape")

    def apply(self, level: Level) -> Level:
        """Shift the bodies.

        Raises:
            CommandError: No body is selected.
        """
        if self.shift == (0.0, 0.0):
            return level
        return reanchored(_shifted(level, self.ids, self.shift), self.ids)


def _shifted(level: Level, ids: Selection, shift: Point) -> Level:
    places = [body.position for body in _chosen(level, ids)]
    dx, dy = (_within(way, [place[k] for place in places]) for k, way in enumerate(shift))
    return with_bodies(
        level, ids, lambda b: b.replace(position=(b.position[0] + dx, b.position[1] + dy))
    )


def _within(way: float, places: list[float]) -> float:
    """Return a shift along one axis, cut where a body would leave what a level can hold [m]."""
    if way > 0:
        return min(way, max(FARTHEST - max(places), 0.0))
    return max(way, min(-FARTHEST - min(places), 0.0))


@dataclasses.dataclass(frozen=True, kw_only=True)
class MoveEach:
    """Shifts each piece by its own amount (align and distribute)."""

    shifts: tuple[tuple[Selection, Point], ...]
    """The bodies of a piece, and their shift [m]."""
    label: str
    merge_key: Hashable | None = None

    def apply(self, level: Level) -> Level:
        """Shift the pieces; joints follow, but for those within a piece."""
        for ids, shift in self.shifts:
            level = _shifted(level, ids, shift)
        moved = [each for ids, _ in self.shifts for each in ids]
        together = any(len(ids) > 1 for ids, _ in self.shifts)
        return (reanchored if together else reanchored_each)(level, moved)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rotate:
    """Turns bodies about a point, their motion at the start with them."""

    ids: Selection
    angle: float
    """Counter-clockwise [rad]."""
    pivot: Point | None = None
    """[m]; None: the centroid of the bodies' positions."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the number of items."""
        return count_label("Rotate", len(self.ids), "shape")

    def apply(self, level: Level) -> Level:
        """Turn the bodies; joints to bodies that stay follow, and whole turns are left out.

        Raises:
            CommandError: No body is selected.
        """
        if self.angle == 0.0:
            return level
        pivot = self.pivot or centroid(_chosen(level, self.ids))

        def turned(body: Body) -> Body:
            offset = (body.position[0] - pivot[0], body.position[1] - pivot[1])
            x, y = rotate(offset, self.angle)
            return body.replace(
                position=(pivot[0] + x, pivot[1] + y),
                angle=body.angle + self.angle,
                velocity=rotate(body.velocity, self.angle),
            )

        after = unwound(level, with_bodies(level, self.ids, turned), self.ids)
        return reanchored(after, self.ids)


def centroid(bodies: list[Body]) -> Point:
    """Return the mean of the bodies' positions [m]."""
    count = len(bodies)
    return (
        sum(body.position[0] for body in bodies) / count,
        sum(body.position[1] for body in bodies) / count,
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Scale:
    """Scales a group uniformly about a point; anchors and thrusters on the bodies scale along."""

    ids: Selection
    factor: float
    pivot: Point
    """Point that stays in place [m]."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the number of items."""
        return count_label("Scale", len(self.ids), "shape")

    def apply(self, level: Level) -> Level:
        """Scale the bodies.

        Raises:
            CommandError: No body is selected, or the factor is not positive.
        """
        _chosen(level, self.ids)
        if not self.factor > 0:
            raise CommandError("The size must stay positive.")
        if self.factor == 1.0:
            return level
        px, py = self.pivot

        def place(position: Point) -> Point:
            return px + self.factor * (position[0] - px), py + self.factor * (position[1] - py)

        factors = (self.factor, self.factor)
        return _resized(level, self.ids, factors, lambda body: place(body.position))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Stretch:
    """Scales one body along its own axes, holding a point of its frame in place."""

    body: int
    factors: Point
    """Along the body's own x and y; a circle takes the first for both."""
    hold: Point = (0.0, 0.0)
    """The point of the frame that stays where it is in the world [m]."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Resize shape"

    def apply(self, level: Level) -> Level:
        """Scale the body.

        Raises:
            CommandError: The body does not exist, or a factor is not positive.
        """
        body = _chosen(level, (self.body,))[0]
        if not min(self.factors) > 0:
            raise CommandError("The size must stay positive.")
        if self.factors == (1.0, 1.0):
            return level
        fx, fy = self.factors
        if isinstance(body.shape, Circle):
            fy = fx
        x, y = rotate(((1 - fx) * self.hold[0], (1 - fy) * self.hold[1]), body.angle)
        place = (body.position[0] + x, body.position[1] + y)
        return _resized(level, (self.body,), (fx, fy), lambda _: place)


def _resized(level: Level, ids: Selection, factors: Point, place: Callable[[Body], Point]) -> Level:
    def scaled(point: Point) -> Point:
        return factors[0] * point[0], factors[1] * point[1]

    def shape(old: Shape) -> Shape:
        if isinstance(old, Circle):
            return Circle(radius=old.radius * factors[0])
        return Polygon(vertices=tuple(scaled(vertex) for vertex in old.vertices))

    resized = with_bodies(
        level,
        ids,
        lambda b: b.replace(shape=shape(b.shape), position=place(b), mass_properties=None),
    )
    after = reanchored(with_parts(resized, ids, scaled), ids)
    # A frame that is hardly off its centre of mass is further off in a larger shape.
    for body in _chosen(after, ids):
        after = freed(after, body.id)
    return after


@dataclasses.dataclass(frozen=True, kw_only=True)
class SetVertices:
    """Gives a polygon other corners; the frame's origin goes to the centre of mass."""

    body: int
    vertices: tuple[Point, ...]
    """In the world [m], in any turning sense."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label of the edit in menus and history."""
        return "Move vertex"

    def apply(self, level: Level) -> Level:
        """Reshape the polygon; anchors and thrusters stay where they are in the world.

        Raises:
            CommandError: The body does not exist, or would no longer be a convex polygon.
        """
        old = _chosen(level, (self.body,))[0]
        fault = polygon_fault(self.vertices)
        if fault is not None and "clockwise" not in fault:
            raise CommandError(f"This corner cannot go there: {fault}.")
        return reshaped(level, polygon_body(self.vertices, level, old))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mirror:
    """Mirrors bodies, their inner joints and their thrusters about the middle of the selection."""

    ids: Selection
    axis: Axis
    """`x`: left and right change places; `y`: up and down."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the direction."""
        return "Mirror left–right" if self.axis == "x" else "Mirror up–down"

    def apply(self, level: Level) -> Level:
        """Mirror the selection.

        A mirrored motor turns the other way for the same key, as a mirror image does.

        Raises:
            CommandError: No body is selected.
        """
        bodies = _chosen(level, self.ids)
        k = 0 if self.axis == "x" else 1
        boxes = [bounds(body) for body in bodies]
        middle = (min(box[k] for box in boxes) + max(box[k + 2] for box in boxes)) / 2

        ids = {body.id for body in bodies}  # the arena may be selected too, and stays
        # The angle of a body that stays keeps its sign; that of the arena is zero.
        resting: dict[BodyReference, float] = {
            body.id: body.angle for body in level.bodies if body.id not in ids
        }

        def thruster(old: Thruster) -> Thruster:
            return mirrored_thruster(old, self.axis) if old.body in ids else old

        mirrored = with_bodies(
            level, ids, lambda old: mirrored_body(old, self.axis, middle)
        ).replace(
            joints=tuple(_joint_image(old, self.axis, ids, resting) for old in level.joints),
            thrusters=tuple(thruster(old) for old in level.thrusters),
        )
        return reanchored(mirrored, ids)


def _joint_image(
    joint: Joint, axis: Axis, ids: Set[int], resting: Mapping[BodyReference, float]
) -> Joint:
    """Return the mirror image of a joint of mirrored bodies, as far from its limits as it was."""
    ends: list[End] = [end for end in BOTH if getattr(joint, end) in ids]
    if not ends:
        return joint
    image = mirrored_joint(joint, axis, ends)
    turn = resting.get(joint.b, 0.0) - resting.get(joint.a, 0.0)
    return image.replace(reference_angle=image.reference_angle + 2 * turn)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Reorder:
    """Brings bodies one place forward or back among their kind (drawing and slot order)."""

    ids: Selection
    step: Literal[1, -1]
    """1: later in the list, drawn above."""
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the direction."""
        return "Bring forward" if self.step == 1 else "Send back"

    def apply(self, level: Level) -> Level:
        """Swap each body with its neighbour of the same kind.

        Raises:
            CommandError: No body is selected.
        """
        _chosen(level, self.ids)
        bodies = list(level.bodies)
        for circles in (False, True):
            slots = [i for i, b in enumerate(bodies) if isinstance(b.shape, Circle) == circles]
            pairs = list(itertools.pairwise(slots))
            for low, high in reversed(pairs) if self.step == 1 else pairs:
                goes, stays = (low, high) if self.step == 1 else (high, low)
                if bodies[goes].id in self.ids and bodies[stays].id not in self.ids:
                    bodies[low], bodies[high] = bodies[high], bodies[low]
        return level.replace(bodies=tuple(bodies))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Remove:
    """Deletes entities; bodies go with their joints and thrusters."""

    ids: Selection
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the number of items."""
        return count_label("Delete", len(self.ids), "item")

    def apply(self, level: Level) -> Level:
        """Delete the entities; the arena stays."""
        gone = set(self.ids)
        return level.replace(
            bodies=tuple(b for b in level.bodies if b.id not in gone),
            joints=tuple(j for j in level.joints if not gone & {j.id, *_ids(j.a), *_ids(j.b)}),
            thrusters=tuple(t for t in level.thrusters if not gone & {t.id, t.body}),
        )


def _ids(reference: EntityId) -> tuple[int, ...]:
    return () if isinstance(reference, str) else (reference,)


def polygon_body(vertices: tuple[Point, ...], level: Level, like: Body | None = None) -> Body:
    """Return a polygon body with these world corners, turned counter-clockwise.

    Args:
        vertices: Corners in the world [m].
        level: Its inertia model says where the centre of mass is.
        like: A body to take angle and properties from.
    """
    if signed_area(vertices) < 0:
        vertices = reverse_winding(vertices)
    cx, cy = centre_of_mass(Polygon(vertices=vertices), level.inertia_model)
    angle = like.angle if like else 0.0
    local = tuple(rotate((x - cx, y - cy), -angle) for x, y in vertices)
    shape = Polygon(vertices=local)
    if like is None:
        return Body(id=level.next_id, shape=shape, position=(cx, cy))
    return like.replace(shape=shape, position=(cx, cy), mass_properties=None)
