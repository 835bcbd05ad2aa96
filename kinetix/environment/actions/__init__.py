"""The kinds of action, one file each; `ACTIONS` is where a name becomes a class."""

from kinetix.environment.actions.base import AbstractAction
from kinetix.environment.actions.continuous import ContinuousActions
from kinetix.environment.actions.discrete import DiscreteActions
from kinetix.environment.actions.multi_discrete import MultiDiscreteActions

ACTIONS: dict[str, type[AbstractAction]] = {
    kind.name: kind for kind in (MultiDiscreteActions, DiscreteActions, ContinuousActions)
}

__all__ = [
    "ACTIONS",
    "AbstractAction",
    "ContinuousActions",
    "DiscreteActions",
    "MultiDiscreteActions",
]
