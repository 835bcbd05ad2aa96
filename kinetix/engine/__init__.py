"""The physics engine: rigid bodies in the plane, many worlds at once. See README.md in this folder.

Names are imported on first use: `spec` and `pairs` are used by code that must not load JAX.
"""

from typing import TYPE_CHECKING

from kinetix.lazy import lazy_names

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
    "PRESETS": "kinetix.engine.presets",
    "SOLVERS": "kinetix.engine.solvers",
    "AbstractSolver": "kinetix.engine.solvers",
    "Bodies": "kinetix.engine.types",
    "Capacity": "kinetix.engine.spec",
    "Control": "kinetix.engine.types",
    "Features": "kinetix.engine.spec",
    "Joints": "kinetix.engine.types",
    "Parameters": "kinetix.engine.types",
    "SceneSpec": "kinetix.engine.spec",
    "State": "kinetix.engine.types",
    "Thrusters": "kinetix.engine.types",
    "Used": "kinetix.engine.spec",
    "World": "kinetix.engine.types",
    "default_parameters": "kinetix.engine.types",
    "solver_named": "kinetix.engine.presets",
    "step": "kinetix.engine.pipeline",
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

__getattr__, __dir__ = lazy_names(__name__, _HOME, kinetix_env=False)
