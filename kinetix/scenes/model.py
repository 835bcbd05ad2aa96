"""Scenes of the accuracy suite: levels to run, their controls, and their duration."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Final, Literal

from kinetix.level.model import Level

SceneClass = Literal[
    "integrator", "impacts", "friction", "joints", "contacts", "robustness", "built"
]

SCENE_CLASSES: Final[tuple[SceneClass, ...]] = (
    "integrator",
    "impacts",
    "friction",
    "joints",
    "contacts",
    "robustness",
    "built",
)
"""In the order of reports and of the chart's facets."""

GRAVITY: Final = 9.81
"""Acceleration of gravity [m/s²]."""
STEP: Final = 1 / 60
"""Time step of every engine [s], whatever it does inside."""
PHASES: Final = 8
"""Number of places within a step at which an impact is tried."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Trial:
    """One run of a scene: a level under a constant action."""

    level: Level
    duration: float
    """Simulated time [s]."""
    name: str = ""
    """Name of the variant; trials of one name differ in their phase alone."""
    phase: int = 0
    """Place of the impact within the step, out of `PHASES`."""
    motor: float = 0.0
    """Action of every motor, −1 … 1."""
    thruster: float = 0.0
    """Action of every thruster, 0 … 1."""
    dt: float = STEP
    """Time step [s]."""
    values: Mapping[str, float] = dataclasses.field(default_factory=dict)
    """Values that the reference needs beyond the level, such as an angle or a speed."""
    inactive: bool = False
    """Every body, joint and thruster is switched off."""

    @property
    def steps(self) -> int:
        """Number of steps in the duration."""
        return math.ceil(self.duration / self.dt - 1e-6)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SuiteScene:
    """One scene of the suite: a known answer that engines are held to."""

    id: str
    """Letter of the class and a number, such as `B1`."""
    name: str
    group: SceneClass
    core: bool
    """True if it belongs to the published core."""
    make_trials: Callable[[], tuple[Trial, ...]]
    """All variants and phases."""
    note: str
    """Purpose, for people."""
    sized: bool = False
    """Run with the step of its size too, beside the one that is compiled for it alone."""
    precise: bool = False
    """Run in binary64: the scene asks for the method's order, which rounding would hide."""

    @property
    def counted(self) -> bool:
        """True if it counts for the class error: of a class without a core all do."""
        return self.core or self.group == "built"

    @property
    def duration(self) -> float:
        """Simulated time of the longest trial [s]."""
        return max(trial.duration for trial in self.make_trials())

    def build(self, variant: int = 0) -> Level:
        """Return the level of one trial, as a document to look at.

        Raises:
            IndexError: The scene has no such trial.
        """
        return self.make_trials()[variant].level
