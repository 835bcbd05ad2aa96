"""Make random levels and write them as native files."""

import contextlib
import dataclasses
import os
import sys
from pathlib import Path
from typing import Annotated

import tyro
from tyro.conf import Positional

from kinetix.cli.shared.terminal import Terminal, counted
from kinetix.command_line.paths import NamedPath
from kinetix.errors import KinetixError
from kinetix.files.folders import made_folder
from kinetix.wording import plural


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sample:
    """Make random levels and write them as native files; the same seed gives the same files."""

    target: Annotated[Positional[NamedPath], tyro.conf.arg(name="outdir", metavar="OUTDIR")]
    """The folder to write to; it is made if it does not exist."""
    size: str
    """`s`, `m`, `l`, `locomotion`, or polygons with the arena, circles, joints and thrusters:
    `12,4,6,2`."""
    count: int
    """Number of levels."""
    seed: int
    """Any integer."""
    machines: bool = False
    """Machines with a task (cars, arms, rockets, …; sizes s, m, l) instead of heaps of shapes."""
    overwrite: bool = False
    """Replace files of these names that hold other levels; those stay beside them as NAME.bak,
    older ones as NAME.bak2 and so on."""
    cores: int | None = None
    """Processor cores to use (KINETIX_CORES, else all)."""


def run(command: Sample) -> int:
    """Write the levels.

    Returns:
        0; errors are raised.

    Raises:
        KinetixError: The size or the count makes no sense, or a file of such a name holds another
            level; what was written before it stays.
    """
    from kinetix.environment.generators.machines import random_machines
    from kinetix.level.codec import dumps
    from kinetix.level.sizes import SIZES, parse_capacity
    from kinetix.level.validate import has_errors, validate

    if command.count < 1:
        raise KinetixError(f"count {command.count!r}: expected at least 1")
    if command.machines:
        levels, kind = random_machines(command.seed, command.size, command.count), "machine"
    else:
        from kinetix.environment.generators.documents import random_levels

        size = command.size if command.size in SIZES else parse_capacity(command.size)
        levels, kind = random_levels(command.seed, size, command.count), "random"
    label = command.size.replace(",", "_")
    made_folder(command.target)
    width = max(4, len(str(command.count - 1)))
    decided = 0
    of_all = f"of {plural(command.count, 'level')}"
    with contextlib.closing(Terminal()) as terminal:
        made = counted(
            levels, "compiling the generator", lambda number: f"{number} {of_all}", terminal
        )
        for index, level in enumerate(made):
            name = f"{kind}_{label}_{command.seed}_{index:0{width}d}.json"
            _write(command.target / name, dumps(level).encode(), overwrite=command.overwrite)
            decided += has_errors(validate(level))
    told = f"{command.target}: {plural(command.count, 'level')}"
    if decided:
        told += f", {decided} of them over as they begin (`kinetix validate` names them)"
    print(told, file=sys.stderr)
    return 0


def _write(path: Path, data: bytes, *, overwrite: bool) -> None:
    """Write a level; one that a person has changed since is not lost."""
    from kinetix.files.atomic import write_with_backup
    from kinetix.files.regular import read_bytes

    if not overwrite and os.path.exists(path) and read_bytes(path, "level") != data:
        raise KinetixError(
            f"{path}: the file holds another level, perhaps this one with changes; choose another "
            "folder or --seed, or pass --overwrite, which keeps it as a .bak file"
        )
    write_with_backup(path, data, keep_all=True)
