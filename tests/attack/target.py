"""A reader of files that others wrote, and how it is attacked."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

from tests.attack.mutate import Mutator


@dataclasses.dataclass(frozen=True, kw_only=True)
class Target:
    """A reader."""

    samples: Callable[[], tuple[bytes, ...]]
    """Good content, to be damaged."""
    read: Callable[[bytes, Path], object]
    """Reads damaged content by way of a folder of its own; raises only `KinetixError`."""
    damage: Callable[[Mutator, bytes], bytes] = Mutator.damaged
    """Does the damage."""
    weight: int = 100
    """Number of attacks in a round; slow readers get fewer."""
