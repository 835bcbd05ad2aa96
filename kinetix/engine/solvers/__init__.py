"""All solvers by name: a new one is one file and one entry here."""

from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.blocks import BLOCKS
from kinetix.engine.solvers.direct import Direct
from kinetix.engine.solvers.pgs_baumgarte import PgsBaumgarte

SOLVERS: dict[str, AbstractSolver] = {
    PgsBaumgarte.name: PgsBaumgarte(),
    **{f"{Direct.name}+{name}": Direct(block=block()) for name, block in BLOCKS.items()},
}

__all__ = ["SOLVERS", "AbstractSolver", "Direct", "PgsBaumgarte"]
