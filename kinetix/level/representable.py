"""Arrays of a world that no level can represent."""

from typing import Any

import numpy as np

from kinetix.engine.spec import ARENA_BODIES
from kinetix.errors import LevelError
from kinetix.level.compile import Scene
from kinetix.level.model import ARENA_NAMES, COLLISIONS, ROLES


def check_sayable(scene: Scene) -> None:
    """Raise if a body cannot be represented exactly in a level file.

    Args:
        scene: Numpy's arrays of one world.

    Raises:
        LevelError: A body cannot; the message names it as `state.polygon` and `state.circle` do.
    """
    bodies = scene.world.bodies
    polygons = len(bodies.vertex_count)
    moves, turns = bodies.inverse_mass != 0, bodies.inverse_inertia != 0
    rules: tuple[tuple[Any, str], ...] = (
        (
            moves != turns,
            "expected both or none of inverse_mass and inverse_inertia to be 0: in a level a body "
            "is fixed or free",
        ),
        (_is_none_of(scene.labels.role, ROLES), f"expected a role from 0 to {len(ROLES) - 1}"),
        (
            _is_none_of(bodies.collision_mode, COLLISIONS),
            f"expected a collision_mode from 0 to {len(COLLISIONS) - 1}",
        ),
    )
    for slot in np.flatnonzero(~bodies.active[:ARENA_BODIES]).tolist():
        raise LevelError(
            f"polygon[{slot}]: expected it to be active, as a level always has its "
            f"{ARENA_NAMES[slot]}: with collision_mode 0 all but shapes of mode 2 pass through it"
        )
    for wrong, expected in rules:
        for slot in np.flatnonzero(bodies.active & wrong).tolist():
            name = f"polygon[{slot}]" if slot < polygons else f"circle[{slot - polygons}]"
            raise LevelError(f"{name}: {expected}")


def _is_none_of(number: Any, names: tuple[str, ...]) -> Any:
    return (number < 0) | (number >= len(names))
