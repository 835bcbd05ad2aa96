"""The families of machines: each function makes one, of random measures, and its goal."""

from collections.abc import Callable
from typing import Final

from kinetix.environment.generators.machines.arms import (
    batting,
    catching,
    flipping,
    long_arm,
    reaching,
    swinging,
)
from kinetix.environment.generators.machines.flyers import (
    flying,
    meeting,
    nudging,
    sledding,
    steering,
    towing,
)
from kinetix.environment.generators.machines.mechanisms import (
    guiding,
    rolling,
    seesaw,
    tilting,
    wrecking,
)
from kinetix.environment.generators.machines.vehicles import (
    arm_on_wheels,
    balancing,
    balancing_act,
    driving,
    hauling,
    pushing,
    reversing,
    trundling,
)
from kinetix.environment.generators.machines.walkers import caterpillar, crawling, hopping, stepping
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
    balancing_act: 2,
    hauling: 2,
    reversing: 1,
    trundling: 1,
    catching: 2,
    flipping: 2,
    meeting: 2,
    steering: 1,
    nudging: 2,
    sledding: 2,
    hopping: 2,
    tilting: 2,
    seesaw: 1,
    wrecking: 2,
}
"""Families of machines, and how often each is tried."""
