"""All solvers by name: a new one is one file and one entry here."""

from kinetix.engine.solvers.base import AbstractSolver
from kinetix.engine.solvers.direct import Direct
from kinetix.engine.solvers.direct.blocks import BLOCKS
from kinetix.engine.solvers.pgs_baumgarte import PgsBaumgarte
from kinetix.engine.solvers.soft import SOFT, Soft
from kinetix.engine.solvers.xpbd import Xpbd

SOLVERS: dict[str, AbstractSolver] = {
    "pgs_baumgarte": PgsBaumgarte(),
    "pgs_soft": SOFT["pgs_soft"],
    "soft_step": SOFT["soft_step"],
    "xpbd": Xpbd(),
    "jacobi": SOFT["jacobi"],
    **{f"direct+{name}": Direct(block=block()) for name, block in BLOCKS.items()},
}

__all__ = ["SOLVERS", "AbstractSolver", "Direct", "PgsBaumgarte", "Soft", "Xpbd"]
