"""The physics presets: names for a solver with settings, chosen by measurement."""

from kinetix.engine.solvers import SOLVERS, AbstractSolver, Direct, PgsBaumgarte
from kinetix.engine.solvers.direct.blocks import Pgs
from kinetix.errors import KinetixError

PRESETS: dict[str, AbstractSolver] = {
    "jax2d": PgsBaumgarte(),
    "fast": Direct(substeps=1, block=Pgs(iterations=24)),
    "balanced": Direct(substeps=2, block=Pgs(iterations=10)),
    "accurate": Direct(substeps=4, block=Pgs(iterations=16)),
    "reference": Direct(substeps=64, block=Pgs(iterations=60)),
}
"""`jax2d` is kinetix-env's engine; `reference` is meant for float64 (`JAX_ENABLE_X64=1`), never for
training."""


def solver_named(name: str | AbstractSolver) -> AbstractSolver:
    """Return the solver behind a preset's or a solver's name; a solver is its own.

    Raises:
        KinetixError: The name is neither; the message lists the valid ones.
    """
    if isinstance(name, AbstractSolver):
        return name
    if not isinstance(name, str):
        raise KinetixError(f"physics: expected a name or a solver, got {type(name).__name__}")
    solver = PRESETS.get(name) or SOLVERS.get(name)
    if solver is None:
        raise KinetixError(
            f"unknown physics {name!r}: expected one of {', '.join([*PRESETS, *SOLVERS])}"
        )
    return solver
