"""The scenes that take more than one recorded run: determinism, random levels, hand-made levels."""

from collections.abc import Callable

from kinetix.bench.metrics.base import Metric
from kinetix.engine.solvers.base import AbstractSolver
from kinetix.scenes.model import SuiteScene

Probe = Callable[[SuiteScene, AbstractSolver, str], list[Metric]]
"""Takes a scene, the solver and the name of the physics; returns what was measured."""

PROBES: dict[str, Probe] = {}
"""By the scene's id."""
