"""Level documents: the model, its files, its problems, and the compiler. See README.md here.

Names are imported on first use; only `compile` knows JAX.
"""

import importlib
from typing import TYPE_CHECKING, Any

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


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in __all__:
        raise AttributeError(f"module 'kinetix.level' has no attribute {name!r}")
    return getattr(importlib.import_module("kinetix.level.model"), name)
