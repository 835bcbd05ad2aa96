"""Parts that can be dropped into a level: a wheel with its motor, an arm, a rope, a bridge."""

import functools
from collections.abc import Callable
from typing import Final

from editor.documents.commands.bodies import AddBody
from editor.documents.commands.clip import Clip, copied
from editor.documents.commands.fields import SetField
from editor.documents.commands.joints import AddJoint
from kinetix.level.model import Body, Circle, Level, Point, Polygon

_REACH: Final = 2.0
"""Furthest that the joints of an arm turn from how they are drawn [rad]."""


class _Workshop:
    """Builds a part with the edits that a person would do."""

    def __init__(self) -> None:
        self.level = Level(name="part")

    def box(self, at: Point, width: float, height: float, *, fixed: bool = False) -> int:
        """Add a rectangle; returns its id."""
        x, y = width / 2, height / 2
        shape = Polygon(vertices=((x, y), (-x, y), (-x, -y), (x, -y)))
        return self._body(Body(id=1, shape=shape, position=at, fixed=fixed))

    def ball(self, at: Point, radius: float) -> int:
        """Add a circle; returns its id."""
        return self._body(Body(id=1, shape=Circle(radius=radius), position=at))

    def _body(self, body: Body) -> int:
        self.level = AddBody(body=body).apply(self.level)
        return self.level.bodies[-1].id

    def hinge(self, a: int, b: int, at: Point, *, motor: bool, binding: int = 0) -> int:
        """Join two bodies by a hinge; returns its id."""
        self.level = AddJoint(bodies=(a, b), point=at, kind="revolute").apply(self.level)
        joint = self.level.joints[-1].id
        self.set(joint, "motor.on", motor)
        if binding:
            self.set(joint, "motor.binding", binding)
        return joint

    def set(self, entity: int, field: str, value: object) -> None:
        """Set a field."""
        self.level = SetField(ids=(entity,), field=field, value=value).apply(self.level)

    def part(self) -> Clip:
        """Return what was built."""
        return copied(self.level, tuple(body.id for body in self.level.bodies))


def wheel() -> Clip:
    """Return a driven wheel under a short board."""
    shop = _Workshop()
    board = shop.box((0.0, 0.15), 0.5, 0.12)
    shop.hinge(board, shop.ball((0.0, 0.0), 0.18), (0.0, 0.0), motor=True)
    return shop.part()


def arm() -> Clip:
    """Return an arm of two links on a fixed foot; each joint has a key and limits."""
    shop = _Workshop()
    foot = shop.box((0.0, 0.0), 0.3, 0.3, fixed=True)
    lower = shop.box((0.0, 0.35), 0.1, 0.6)
    upper = shop.box((0.2, 0.6), 0.5, 0.1)
    for number, (a, b, at) in enumerate(((foot, lower, (0.0, 0.1)), (lower, upper, (0.0, 0.6)))):
        joint = shop.hinge(a, b, at, motor=True, binding=number)
        for field, value in (("limits.on", True), ("limits.min", -_REACH), ("limits.max", _REACH)):
            shop.set(joint, field, value)
    return shop.part()


def _chain(count: int, length: float, thickness: float, *, posts: int) -> Clip:
    """Return links in a row, without motors, attached to one fixed post or to two.

    Args:
        count: How many links.
        length: From joint to joint [m].
        thickness: Of a link [m].
        posts: 1 hangs the first link up, 2 the last one too.
    """
    shop = _Workshop()
    overlap = thickness
    before = shop.box((-overlap, 0.0), 0.16, 0.16, fixed=True)
    for k in range(count):
        link = shop.box(((k + 0.5) * length, 0.0), length + overlap, thickness)
        shop.hinge(before, link, (k * length, 0.0), motor=False)
        before = link
    if posts == 2:
        end = shop.box((count * length + overlap, 0.0), 0.16, 0.16, fixed=True)
        shop.hinge(before, end, (count * length, 0.0), motor=False)
    return shop.part()


PARTS: Final[dict[str, tuple[str, str, Callable[[], Clip]]]] = {
    "wheel": ("Motor Wheel", "A driven wheel under a short board.", wheel),
    "arm": ("Arm", "Two links on a fixed foot, a key and limits for each joint.", arm),
    "rope": (
        "Rope",
        "Eight free links attached to a fixed point.",
        functools.partial(_chain, 8, 0.15, 0.05, posts=1),
    ),
    "bridge": (
        "Bridge",
        "Six planks between two fixed posts.",
        functools.partial(_chain, 6, 0.3, 0.08, posts=2),
    ),
}
"""Label, sentence and maker of each part, by id."""
