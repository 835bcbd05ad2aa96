"""Names of files: whether they are text, short enough and free."""

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

LONGEST_NAME: Final = 255
"""Longest name that file systems take [bytes]."""
_HALVES: Final = re.compile("[\ud800-\udfff]")
"""Halves of surrogate pairs: Python keeps bytes in them that are no UTF-8."""


def is_text(words: str | Path) -> bool:
    """Return whether a string is Unicode text; names of files may hold any bytes on Linux."""
    return _HALVES.search(str(words)) is None


def shortened(stem: str, ending: str, *, room: int = 0) -> str:
    """Return the name `stem` + `ending`; the stem is cut where file systems would not take it.

    Args:
        stem: Beginning of the name.
        ending: End of the name, which stays whole.
        room: Bytes that the name has to leave, for an ending that will be added.
    """
    while stem and len(os.fsencode(f"{stem}{ending}")) + room > LONGEST_NAME:
        stem = stem[:-1]
    return f"{stem}{ending}"


def first_free(paths: Iterable[Path]) -> Path:
    """Return the first path where there is nothing yet, not even a link."""
    return next(path for path in paths if not os.path.lexists(path))
