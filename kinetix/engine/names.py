"""Names of the physics that can be chosen, known before JAX is (a test keeps them complete)."""

from typing import Final

PRESET_NAMES: Final = ("jax2d", "fast", "balanced", "accurate", "reference")
"""Presets of the engine, in the order of growing accuracy."""
DEFAULT_PHYSICS: Final = "balanced"
"""The physics that is used unless another is named."""
SOLVER_NAMES: Final = (
    "pgs_baumgarte",
    "pgs_soft",
    "soft_step",
    "xpbd",
    "jacobi",
    "direct+pgs",
    "direct+admm",
)
"""Solvers that can be chosen at their default settings."""
PHYSICS: Final = PRESET_NAMES + SOLVER_NAMES
