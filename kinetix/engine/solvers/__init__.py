"""All solvers by name: a new one is one file and one entry here."""

from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.pgs_baumgarte import PgsBaumgarte

SOLVERS: dict[str, AbstractSolver] = {solver.name: solver for solver in (PgsBaumgarte(),)}

__all__ = ["SOLVERS", "AbstractSolver", "PgsBaumgarte"]
