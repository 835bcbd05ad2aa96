"""Bodies and impulses that a step of kinetix-env's scheme changes."""

from jaxtyping import Array, Float

from kinetix.engine.maths import Vec
from kinetix.pytree import pytree


@pytree
class Impulses:
    """Accumulated impulses of one kind of contact."""

    normal: Float[Array, "q n"]
    tangent: Float[Array, "q n"]


@pytree
class PgsBaumgarteCache:
    """Impulses for the warm start: contacts by kind and slot, and the joints."""

    polygons: Impulses
    polygons_second: Impulses
    circle_polygons: Impulses
    circles: Impulses
    joint_x: Float[Array, "j n"]
    joint_y: Float[Array, "j n"]
    joint_angular: Float[Array, "j n"]


@pytree
class Moving:
    """The bodies while they are being solved."""

    position: Vec
    rotation: Float[Array, "b n"]
    velocity: Vec
    omega: Float[Array, "b n"]
