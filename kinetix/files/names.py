"""Checks that names of files, and other strings, are text."""

import re
from pathlib import Path
from typing import Final

_HALVES: Final = re.compile("[\ud800-\udfff]")
"""Halves of surrogate pairs: Python keeps bytes in them that are no UTF-8."""


def is_text(words: str | Path) -> bool:
    """Return whether a string is Unicode text; names of files may hold any bytes on Linux."""
    return _HALVES.search(str(words)) is None
