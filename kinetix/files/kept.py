"""A compressed cache file; deleted if damaged, skipped if the folder is not writable."""

import contextlib
import os
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from kinetix.errors import KinetixError
from kinetix.files.atomic import write_atomically

_Kept = TypeVar("_Kept")


def read_kept(path: Path, use: Callable[[bytes], _Kept]) -> _Kept | None:
    """Return the content of a cache file; None if it is missing or damaged.

    Args:
        path: The file, as `write_kept` writes it.
        use: From its content; whatever it raises, the file is deleted.
    """
    try:
        kept = use(zlib.decompress(path.read_bytes()))
    except FileNotFoundError:
        return None
    except Exception:  # a damaged file is rebuilt
        with contextlib.suppress(OSError):  # the folder may be one that can only be read
            path.unlink(missing_ok=True)
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return kept


def write_kept(path: Path, content: bytes) -> None:
    """Write a file of a cache; where that cannot be done, it is made again another day.

    Args:
        path: The file; its folder is made if needed.
        content: What `read_kept` hands on.
    """
    with contextlib.suppress(KinetixError, OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, zlib.compress(content, 1))
