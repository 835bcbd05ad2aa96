"""The direct soft step: joints by a direct solve, contacts by one of the `blocks`."""

from kinetix.engine.solvers.direct.solver import Direct

__all__ = ["Direct"]
