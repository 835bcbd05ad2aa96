"""The families of machines: each function makes one, of random measures, and its goal."""

from collections.abc import Callable
from typing import Final

from kinetix.environment.generators.machines.arms import batting, long_arm, reaching, swinging
from kinetix.environment.generators.machines.flyers import flying, towing
from kinetix.environment.generators.machines.mechanisms import guiding, rolling
from kinetix.environment.generators.machines.vehicles import (
    arm_on_wheels,
    balancing,
    driving,
    pushing,
)
from kinetix.environment.generators.machines.walkers import caterpillar, crawling, stepping
from kinetix.environment.generators.machines.workshop import Workshop

Family = Callable[[Workshop], None]

FAMILIES: Final[dict[Family, int]] = {
    driving: 3,
    pushing: 2,
    reaching: 3,
    flying: 3,
    batting: 3,
    balancing: 2,
    crawling: 2,
    stepping: 3,
    rolling: 2,
    guiding: 2,
    towing: 1,
    swinging: 1,
    arm_on_wheels: 2,
    long_arm: 1,
    caterpillar: 2,
}
"""Families of machines, and how often each is tried."""
