"""The most that numbers of a level may be: the bounds in the model, and of what edits them."""

from typing import Final

LARGEST_REAL: Final = 3.4028234663852886e38
"""Most that a 32-bit number may be, to either side."""
FARTHEST: Final = 15.0
"""Most that a coordinate of a body may be, to either side [m]."""
FARTHEST_PART: Final = 10_000.0
"""Most that a coordinate in a body's own frame may be, to either side [m]: far above use."""
WIDEST_ANGLE: Final = 1e6
"""Most that an angle may be, to either side [rad]: far above what a long spin gathers."""
WIDEST_LIMIT: Final = 100.0
"""Most that a limit of a joint may be, to either side [rad]."""
FASTEST: Final = 100.0
"""Most that a component of a velocity may be, to either side [m/s]."""
FASTEST_SPIN: Final = 50.0
"""Most that an angular velocity may be, to either side [rad/s]."""
STRONGEST_GRAVITY: Final = 100.0
"""Most that a component of gravity may be, to either side [m/s²]."""
FASTEST_MOTOR: Final = 20.0
"""Most that the speed of a motor may be, to either side [6 rad/s]."""
STRONGEST_MOTOR: Final = 20.0
"""Most that the power of a motor may be [900 rad/s²]."""
STRONGEST_THRUSTER: Final = 100.0
"""Most that the power of a thruster may be [10 N]."""
