"""Turn a level file from one format into the other, and say what the other cannot hold."""

import dataclasses
import os
import sys
from pathlib import Path
from typing import Annotated, Final

import tyro
from tyro.conf import Positional

from kinetix.cli.shared.one_core import OneCore
from kinetix.errors import KinetixError
from kinetix.files.atomic import backup_of, write_with_backup
from kinetix.files.folders import made_folder
from kinetix.level.canonical import FORMAT
from kinetix.level.codec import LevelFormat, dumps, load_document
from kinetix.level.kinetix_env.document import lost_fields

_NO_LEVELS: Final = frozenset({".png", ".gif", ".mp4", ".html", ".jpg", ".jpeg", ".svg"})
"""Endings of pictures and films: who names one wants something else."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Convert(OneCore):
    """Turn a level file from one format into the other."""

    source: Annotated[Positional[str], tyro.conf.arg(name="in", metavar="IN")]
    """A level file of either format, or the name of a bundled level."""
    target: Annotated[Positional[Path], tyro.conf.arg(name="out", metavar="OUT")]
    """The file to write."""
    format: LevelFormat | None = None
    """Format to write; by default the one that the source is not in."""


def run(command: Convert) -> int:
    """Convert one file; a warning on stderr names what is lost.

    Returns:
        0; errors are raised.

    Raises:
        KinetixError: The level is bad, or would be replaced by its form in another format.
    """
    if command.target.suffix.lower() in _NO_LEVELS:
        raise KinetixError(
            f"{command.target}: a level is a file that ends in .json; "
            "`kinetix render` draws its picture"
        )
    if str(command.target) == "-":
        raise KinetixError("-: a level is written to a file: name one that ends in .json")
    loaded = load_document(command.source)
    other: LevelFormat = "kinetix-env" if loaded.format == FORMAT else FORMAT
    target = command.format or other
    if target != loaded.format and _same_file(loaded.path, command.target):
        raise KinetixError(
            f"{command.target}: this is the file that is read, and what {target} cannot say would "
            "be lost; choose another name"
        )
    text = dumps(loaded.level, format=target, source=loaded.source)
    made_folder(command.target.parent)
    if write_with_backup(command.target, text.encode(), keep_all=True):
        print(
            f"{backup_of(command.target)}: what {command.target.name} held before",
            file=sys.stderr,
        )
    if target == FORMAT:
        for warning in loaded.warnings:
            print(f"{command.source}: {warning}", file=sys.stderr)
    elif loaded.source is None and (lost := lost_fields(loaded.level, stem=command.target.stem)):
        print(
            f"{command.target}: kinetix-env cannot say, or its reader ignores: {', '.join(lost)}",
            file=sys.stderr,
        )
    print(f"{command.target}: {target}")
    return 0


def _same_file(source: Path | None, target: Path) -> bool:
    return source is not None and os.path.exists(target) and source.samefile(target)
