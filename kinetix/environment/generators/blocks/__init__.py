"""The building blocks of random levels: a free shape, a jointed shape, a thruster.

A block draws `q` proposals for one new body at once, as rows of its own; who calls it chooses one
and writes it where there is room. Per-world facts carry a first axis of one, so that they broadcast
over the proposals.

Q1 … Q8 are the quirks of `UEDParams.kinetix_quirks`.
"""

from kinetix.environment.generators.blocks.jointed import connected_shape, joint_of
from kinetix.environment.generators.blocks.proposals import (
    Proposals,
    SizeLimit,
    Surroundings,
    look_around,
    size_limit,
)
from kinetix.environment.generators.blocks.shapes import draw_role, free_shape, new_dimensions
from kinetix.environment.generators.blocks.thrusters import thrusters_on

__all__ = [
    "Proposals",
    "SizeLimit",
    "Surroundings",
    "connected_shape",
    "draw_role",
    "free_shape",
    "joint_of",
    "look_around",
    "new_dimensions",
    "size_limit",
    "thrusters_on",
]
