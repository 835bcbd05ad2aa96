"""Compiled programs: made ready, kept, tailored to a level."""

import dataclasses

from kinetix.engine.names import DEFAULT_PHYSICS
from kinetix.level.model import Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class WarmUp:
    """Import JAX and compile the step for some sizes, so that Play starts at once.

    Sizes are names, or four numbers such as `12,4,6,2`.
    """

    sizes: tuple[str, ...] = ("s", "m", "l")
    physics: str = DEFAULT_PHYSICS


@dataclasses.dataclass(frozen=True, kw_only=True)
class GetReady:
    """Have a step that a level can be played in, soon. Gives the names of all presets and solvers.

    It is compiled quickly, unless there is a better one in memory or on disk.
    """

    level: Level
    physics: str


@dataclasses.dataclass(frozen=True, kw_only=True)
class KeepPrograms:
    """Write what was compiled to the cache on disk, which stops all threads for a moment.

    What nobody has used for long is thrown away there. Gives nothing.
    """


@dataclasses.dataclass(frozen=True, kw_only=True)
class Tailor:
    """Compile a step for what one level can ever do, which costs less than the one of its size.

    Episodes of the level that a person plays begin with it from then on, and so do those of every
    level that can do the same. Gives nothing.
    """

    level: Level
    physics: str
