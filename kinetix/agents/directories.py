"""The writer of checkpoint folders: one always holds the old or the new content."""

import contextlib
import glob
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

from kinetix.errors import CheckpointError

_OLD = ".old"
"""Ends the name of a checkpoint while another takes its place."""


@contextlib.contextmanager
def replacing_directory(directory: Path) -> Iterator[Path]:
    """Give a folder to fill that takes the place of `directory` when the block ends well.

    Args:
        directory: Made if need be; what is there is replaced.

    Yields:
        Path of a folder beside it.

    Raises:
        CheckpointError: The folder cannot be written, or is the current folder.
    """
    if not directory.name:
        raise CheckpointError(
            f"{directory}: a new folder takes the place of the old one, which this one cannot be; "
            "name a folder inside it"
        )
    temporary = directory.with_name(f".{directory.name}.{os.getpid()}.tmp")
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        bring_back(directory)
        shutil.rmtree(temporary, ignore_errors=True)
        temporary.mkdir()
        yield temporary
        _replace(temporary, directory)
    except OSError as error:
        # The system's message names the temporary folder, which the user does not know.
        why = error.strerror or error
        raise CheckpointError(f"{directory}: cannot be written: {why}") from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _replace(source: Path, target: Path) -> None:
    """Put a finished directory in its place and make that durable.

    Args:
        source: The finished directory, on the same file system.
        target: Its place; what is there is removed.
    """
    for path in source.rglob("*"):
        if os.path.isfile(path):
            _sync(path)
    if os.path.exists(target):
        # A directory cannot be replaced in one step; a process that dies in between leaves the old
        # one under this name, where `surviving` finds it.
        old = target.with_name(f".{target.name}.{os.getpid()}{_OLD}")
        target.rename(old)
        source.rename(target)
        shutil.rmtree(old, ignore_errors=True)
    else:
        source.rename(target)
    _sync(target.parent)


def surviving(directory: Path) -> Path:
    """Return the directory, or its former content where a kill came between the two renames.

    Args:
        directory: Where a checkpoint should be.
    """
    if os.path.exists(directory):
        return directory
    pattern = f".{glob.escape(directory.name)}.*{_OLD}"
    former = [path for path in sorted(directory.parent.glob(pattern)) if os.path.isdir(path)]
    return former[-1] if former else directory


def bring_back(directory: Path) -> None:
    """Give a checkpoint that a kill left under another name its own again.

    Args:
        directory: Where it should be.
    """
    former = surviving(directory)
    if former != directory:
        former.rename(directory)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
