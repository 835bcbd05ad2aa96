"""All folders at and below some, each once, those that links lead to included."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from kinetix.errors import LevelError

MOST_LINKED: Final = 20_000
"""Most folders behind links: a bound against a link to the whole disk."""


def walked(folders: Sequence[Path]) -> Iterator[tuple[Path, list[str], list[str]]]:
    """Yield folders as `os.walk` does; those behind links come last, so that real paths win.

    Args:
        folders: Where to begin; what cannot be read is left out.

    Yields:
        A folder, the names of the folders in it, from which those to be left out may be taken, and
        the names of its files.

    Raises:
        LevelError: Links lead to too many folders; one sentence.
    """
    waiting = list(folders)
    seen: set[tuple[int, int] | str] = set()
    linked = 0
    for k, start in enumerate(waiting):  # grows meanwhile
        for place, inner, names in os.walk(start):
            identity = _identity(place)
            if identity is None or identity in seen:
                inner.clear()
                continue
            seen.add(identity)
            linked += k >= len(folders)
            if linked > MOST_LINKED:
                raise LevelError(
                    f"{start}: the link leads past {MOST_LINKED} folders; remove it, or name the "
                    "folders that are meant"
                )
            yield Path(place), inner, names
            paths = (Path(place) / name for name in inner)
            waiting += [path for path in paths if os.path.islink(path)]


def _identity(folder: str) -> tuple[int, int] | str | None:
    try:
        about = os.stat(folder)
    except OSError:  # it is gone by now
        return None
    # Some file systems give every folder the number 0.
    return (about.st_dev, about.st_ino) if about.st_ino else os.path.realpath(folder)
