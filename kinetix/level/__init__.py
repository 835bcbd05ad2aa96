"""Level documents: the model, its files, its problems, and the compiler. See README.md here.

Names are imported on first use; only `compile` knows JAX.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.level.model import (
        Arena,
        ArenaBody,
        Body,
        Circle,
        Geometry,
        Joint,
        Level,
        Limits,
        MassProperties,
        Motor,
        Polygon,
        SizeHint,
        Solution,
        Thruster,
    )

__all__ = [
    "Arena",
    "ArenaBody",
    "Body",
    "Circle",
    "Geometry",
    "Joint",
    "Level",
    "Limits",
    "MassProperties",
    "Motor",
    "Polygon",
    "SizeHint",
    "Solution",
    "Thruster",
]

__getattr__, __dir__ = lazy_names(
    __name__, dict.fromkeys(__all__, "kinetix.level.model"), kinetix_env=False
)
