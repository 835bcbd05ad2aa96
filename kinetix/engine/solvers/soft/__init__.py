"""Soft constraints: one solver, and the three settings `SOFT` of it.

`solver` and `substep` have the order of the stages, `contacts` and `joints` what one row does to
its two bodies (`levers`), and how softly (`springs`).
"""

from kinetix.engine.solvers.soft.settings import SOFT
from kinetix.engine.solvers.soft.solver import Soft

__all__ = ["SOFT", "Soft"]
