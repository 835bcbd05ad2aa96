"""Mutations of drafts, each applied to the worlds that are marked.

Every mutation takes the drafts, its own uniform numbers and the marks, and leaves the other worlds
as they are; so a batch in which every world gets another mutation runs each of them once. What they
have in common: where there is nothing to act on, nothing happens.
"""

from typing import Final

from kinetix.environment.generators.mutators.additions import (
    add_connected_shape,
    add_shape,
    add_thruster,
)
from kinetix.environment.generators.mutators.changes import (
    change_gravity,
    change_location,
    change_rotation,
    change_size,
    swap_role,
    toggle_fixture,
)
from kinetix.environment.generators.mutators.picking import NUMBERS, Mutation
from kinetix.environment.generators.mutators.removals import (
    remove_joint,
    remove_shape,
    remove_thruster,
)

__all__ = [
    "MUTATORS",
    "NUMBERS",
    "SETTLED",
    "Mutation",
    "add_connected_shape",
    "add_shape",
    "add_thruster",
]

MUTATORS: Final[dict[str, Mutation]] = {
    "add_shape": add_shape,
    "add_connected_shape": add_connected_shape,
    "remove_joint": remove_joint,
    "remove_shape": remove_shape,
    "swap_role": swap_role,
    "add_thruster": add_thruster,
    "remove_thruster": remove_thruster,
    "toggle_fixture": toggle_fixture,
    "change_size": change_size,
    "change_location": change_location,
    "change_rotation": change_rotation,
    "change_gravity": change_gravity,
}
"""All mutations by name."""
SETTLED: Final = frozenset({"change_size", "change_rotation"})
"""After these, jointed bodies are put together again."""
