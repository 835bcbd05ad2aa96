"""Report how much lies in the caches, or clear them; everything in them is rebuilt when needed."""

import dataclasses
import sys

from kinetix.cli.shared.one_core import OneCore
from kinetix.files.caches import CACHES, cache_bytes, cache_folder, clear_cache
from kinetix.files.limits import MIB


@dataclasses.dataclass(frozen=True, kw_only=True)
class Cache(OneCore):
    """Compiled programs and thumbnails on disk."""

    clear: bool = False
    """Delete them all."""


def run(command: Cache) -> int:
    """Print a line per cache.

    Returns:
        0, or 1 where something could not be deleted.
    """
    status = 0
    for name, cache in CACHES.items():
        folder = cache_folder(name)
        size = clear_cache(name) if command.clear else cache_bytes(name)
        told = f"{size / MIB:.1f} MiB"
        bound = "cleared" if command.clear else f"of {cache.largest // MIB} MiB"
        print(f"{folder}: {told} {bound}, {cache.what}")
        if command.clear and (left := cache_bytes(name)):
            print(
                f"{folder}: {left / MIB:.1f} MiB could not be deleted, or were written meanwhile",
                file=sys.stderr,
            )
            status = 1
    return status
