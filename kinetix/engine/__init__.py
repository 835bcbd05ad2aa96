"""The physics engine: rigid bodies in the plane, many worlds at once. See README.md in this folder.

Names are imported on first use: `spec` and `pairs` are used by code that must not load JAX.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinetix.engine.pipeline import step
    from kinetix.engine.presets import PRESETS, solver_named
    from kinetix.engine.solvers import SOLVERS, AbstractSolver
    from kinetix.engine.spec import Capacity, Features, SceneSpec, Used
    from kinetix.engine.types import (
        Bodies,
        Control,
        Joints,
        Parameters,
        State,
        Thrusters,
        World,
        default_parameters,
    )

_HOME = {
    "PRESETS": "presets",
    "SOLVERS": "solvers",
    "AbstractSolver": "solvers",
    "Bodies": "types",
    "Capacity": "spec",
    "Control": "types",
    "Features": "spec",
    "Joints": "types",
    "Parameters": "types",
    "SceneSpec": "spec",
    "State": "types",
    "Thrusters": "types",
    "Used": "spec",
    "World": "types",
    "default_parameters": "types",
    "solver_named": "presets",
    "step": "pipeline",
}

__all__ = [
    "PRESETS",
    "SOLVERS",
    "AbstractSolver",
    "Bodies",
    "Capacity",
    "Control",
    "Features",
    "Joints",
    "Parameters",
    "SceneSpec",
    "State",
    "Thrusters",
    "Used",
    "World",
    "default_parameters",
    "solver_named",
    "step",
]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'kinetix.engine' has no attribute {name!r}")
    return getattr(importlib.import_module(f"kinetix.engine.{_HOME[name]}"), name)
