"""Make random levels and write them as native files."""

import dataclasses
import sys
from pathlib import Path
from typing import Annotated

import tyro
from tyro.conf import Positional

from kinetix.errors import KinetixError


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sample:
    """Make random levels and write them as native files; the same seed gives the same files."""

    target: Annotated[Positional[Path], tyro.conf.arg(name="outdir", metavar="OUTDIR")]
    """The folder to write to; it is made if it does not exist."""
    size: str
    """`s`, `m`, `l`, `locomotion`, or polygons with the arena, circles, joints and thrusters:
    `12,4,6,2`."""
    count: int
    """Number of levels."""
    seed: int
    """Any integer."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Sample) -> int:
    """Write the levels.

    Returns:
        0; errors are raised.

    Raises:
        KinetixError: The size or the count makes no sense.
    """
    from kinetix.environment.generators.documents import random_levels
    from kinetix.level.codec import save_level
    from kinetix.level.sizes import SIZES, parse_capacity

    if command.count < 1:
        raise KinetixError(f"count {command.count!r}: expected at least 1")
    size = command.size if command.size in SIZES else parse_capacity(command.size)
    label = command.size.replace(",", "_")
    command.target.mkdir(parents=True, exist_ok=True)
    width = max(4, len(str(command.count - 1)))
    for index, level in enumerate(random_levels(command.seed, size, command.count)):
        name = f"random_{label}_{command.seed}_{index:0{width}d}.json"
        save_level(level, command.target / name, format="kinetix-level")
    print(f"{command.target}: {command.count} levels", file=sys.stderr)
    return 0
