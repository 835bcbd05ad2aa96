"""All solvers by name: a new one is one file and one entry here."""

from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.blocks import BLOCKS
from kinetix.engine.solvers.direct import Direct
from kinetix.engine.solvers.jacobi import Jacobi
from kinetix.engine.solvers.pgs_baumgarte import PgsBaumgarte
from kinetix.engine.solvers.pgs_soft import PgsSoft
from kinetix.engine.solvers.soft_step import SoftStep
from kinetix.engine.solvers.xpbd import Xpbd

SOLVERS: dict[str, AbstractSolver] = {
    PgsBaumgarte.name: PgsBaumgarte(),
    PgsSoft.name: PgsSoft(),
    SoftStep.name: SoftStep(),
    Xpbd.name: Xpbd(),
    Jacobi.name: Jacobi(),
    **{f"{Direct.name}+{name}": Direct(block=block()) for name, block in BLOCKS.items()},
}

__all__ = [
    "SOLVERS",
    "AbstractSolver",
    "Direct",
    "Jacobi",
    "PgsBaumgarte",
    "PgsSoft",
    "SoftStep",
    "Xpbd",
]
