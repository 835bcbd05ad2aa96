"""Folders that commands write into, made where there are none."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from kinetix.errors import KinetixError
from kinetix.files.lock import locked_folder


def made_folder(folder: Path) -> Path:
    """Make a folder and those around it, where there are none yet.

    Args:
        folder: The folder.

    Returns:
        The same.

    Raises:
        KinetixError: A file stands in its place, or the folder cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        taken = (place for place in (folder, *folder.parents) if os.path.isfile(place))
        for file in taken:
            raise KinetixError(f"{file}: expected a folder, got a file") from None
        raise KinetixError(f"{folder}: cannot be made: {error.strerror or error}") from None
    return folder


@contextlib.contextmanager
def begun_folder(folder: Path, owner: str) -> Iterator[None]:
    """Make a folder and hold its lock; remove the folder if it was new and is still empty.

    Args:
        folder: The folder; one that is there stays.
        owner: Who else may hold the lock, for the sentence: "another recording".

    Raises:
        KinetixError: A file stands in its place, the folder cannot be made, or another process
            holds it.
    """
    is_new = not os.path.isdir(folder)
    made_folder(folder)
    with locked_folder(folder, owner):
        try:
            yield
        finally:
            if is_new:  # removed under the lock: nobody else has begun to write
                with contextlib.suppress(OSError):  # it holds something
                    folder.rmdir()
