"""Random machines with a task: cars, arms, rockets, bats, walkers, … in ever new proportions.

The random levels of `generators.sample` are heaps of shapes; what people build are machines. Each
level here is one family of machine with random measures, motors and keys, a goal where it might
get, and hazards and obstacles in the way. No shapes overlap; nothing is checked by playing: some
levels are trivial and some cannot be won, as with the heaps. Documents only, no JAX.
"""

from kinetix.environment.generators.machines.draw import (
    numbered_machine,
    random_machine,
    random_machines,
)
from kinetix.environment.generators.machines.families import FAMILIES, Family

__all__ = ["FAMILIES", "Family", "numbered_machine", "random_machine", "random_machines"]
