"""Refuse levels with features that a specialised environment does not simulate."""

from typing import Final

from kinetix.engine.spec import Features
from kinetix.engine.types import World
from kinetix.errors import KinetixError
from kinetix.level.features import features_of

_PARTS: Final = {
    "pairs": "some of its contacts",
    "used": "some of its shapes, joints or thrusters",
    "restitution": "bouncing",
    "triangles": "triangles",
    "limits": "limits of joints",
    "welds": "welds",
    "motors": "motors",
    "thrusters": "thrusters",
}
"""Words for the fields of `Features`, for error messages."""


def check_features(world: World, features: Features, name: str = "the level") -> None:
    """Refuse a level of which a step for other levels would leave parts out.

    Args:
        world: The level's, or those of a batch.
        features: Those that the step computes.
        name: The level's name, for the sentence.

    Raises:
        KinetixError: The step leaves out something that the level has.
    """
    if features == Features():
        return
    lacking = features.lacks(features_of(world))
    if lacking:
        raise KinetixError(
            f"{name}: the environment was specialised for other levels and leaves out "
            f"{', '.join(_PARTS[part] for part in lacking)}; create it with this level included"
        )
