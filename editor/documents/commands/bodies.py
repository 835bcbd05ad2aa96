"""Edits of bodies: adding one, taking over a simulated pose."""

import dataclasses
from collections.abc import Hashable
from typing import Final, Protocol

import numpy as np

from kinetix.level.model import Body, Circle, Level, Polygon

SIZE_DECIMALS: Final = 5
"""Decimals of the sizes of what is drawn [m]: a hundredth of a millimetre."""
PLACE_DECIMALS: Final = 6
"""Decimals of its place: halves of sizes fit."""


class Poses(Protocol):
    """Poses of a level's bodies at some moment; rows in the order of `level.bodies`."""

    @property
    def position(self) -> np.ndarray:
        """Shape (b, 2) [m]."""
        ...

    @property
    def angle(self) -> np.ndarray:
        """Shape (b,) [rad]."""
        ...

    @property
    def velocity(self) -> np.ndarray:
        """Shape (b, 2) [m/s]."""
        ...

    @property
    def angular_velocity(self) -> np.ndarray:
        """Shape (b,) [rad/s]."""
        ...


def posed(level: Level, poses: Poses) -> Level:
    """Return the level with its bodies where a simulation has put them."""
    rows = zip(
        level.bodies,
        poses.position.tolist(),
        poses.angle.tolist(),
        poses.velocity.tolist(),
        poses.angular_velocity.tolist(),
        strict=True,
    )
    return level.replace(
        bodies=tuple(
            body.replace(
                position=tuple(position),
                angle=angle,
                velocity=tuple(velocity),
                angular_velocity=angular_velocity,
            )
            for body, position, angle, velocity, angular_velocity in rows
        )
    )


def tidied(body: Body) -> Body:
    """Return a body without the noise of the pointer: two shapes drawn alike are equal."""
    shape = body.shape
    if isinstance(shape, Circle):
        shape = Circle(radius=round(shape.radius, SIZE_DECIMALS))
    elif len(shape.vertices) == 4:
        # The corners of a triangle are as they are: its frame stands in its centre of mass.
        corners = ((round(x, SIZE_DECIMALS), round(y, SIZE_DECIMALS)) for x, y in shape.vertices)
        shape = Polygon(vertices=tuple(corners))
    x, y = body.position
    return body.replace(shape=shape, position=(round(x, PLACE_DECIMALS), round(y, PLACE_DECIMALS)))


@dataclasses.dataclass(frozen=True, kw_only=True)
class AddBody:
    """Puts a new body on top of those of its kind; its id is given when it is added."""

    body: Body
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Names the shape."""
        if isinstance(self.body.shape, Circle):
            return "Add circle"
        return "Add triangle" if len(self.body.shape.vertices) == 3 else "Add rectangle"

    def apply(self, level: Level) -> Level:
        """Append the body."""
        body = tidied(self.body).replace(id=level.next_id)
        return level.replace(bodies=(*level.bodies, body), next_id=level.next_id + 1)
