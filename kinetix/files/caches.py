"""Caches on disk, which can be rebuilt: one table of folders, each with a bound."""

import contextlib
import dataclasses
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from kinetix.files.limits import MIB
from kinetix.paths import cache_dir

_YOUNG_SECONDS: Final = 60.0
"""Files that another process may be writing just now."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class CacheBound:
    """One folder below the user's cache folder."""

    what: str
    """Content, in words."""
    largest: int
    """Of more bytes the files that were used longest ago are deleted."""


CACHES: Final[dict[str, CacheBound]] = {
    "jax": CacheBound(what="compiled programs of JAX", largest=1024 * MIB),
    "steps": CacheBound(what="compiled steps of the editor", largest=64 * MIB),
    "lowered": CacheBound(what="steps as they are given to the compiler", largest=64 * MIB),
    "kernels": CacheBound(what="compiled steps for GPUs", largest=64 * MIB),
    "gallery": CacheBound(what="the gallery's index and thumbnails", largest=256 * MIB),
    "peers": CacheBound(what="compiled programs of other engines", largest=1024 * MIB),
}
"""By name of the folder."""


def cache_folder(name: str) -> Path:
    """Return the folder of a cache; it need not exist."""
    return cache_dir() / name


def cache_bytes(name: str) -> int:
    """Return how much lies in a cache [bytes]."""
    return sum(size for _, size, _ in _contents(cache_folder(name)))


def tidy_caches() -> None:
    """Delete what was used longest ago wherever there is too much."""
    for name, cache in CACHES.items():
        bound(cache_folder(name), cache.largest)


def clear_cache(name: str) -> int:
    """Delete the content of a cache; programs that run now rebuild what they need.

    The folder itself stays, as JAX does not make it again.

    Args:
        name: Which.

    Returns:
        How much was deleted [bytes].
    """
    size = cache_bytes(name)
    for place, inner, names in os.walk(cache_folder(name), topdown=False):
        for path in (Path(place) / one for one in names + inner):
            with contextlib.suppress(OSError):
                path.rmdir() if _is_folder(path) else path.unlink()
    return size - cache_bytes(name)


def bound(folder: Path, largest: int) -> None:
    """Delete the files below a folder that were used longest ago, until the rest is small enough.

    Args:
        folder: Which; it need not exist.
        largest: How much may stay [bytes].
    """
    left = largest
    for used, size, path in sorted(_contents(folder), reverse=True):
        left -= size
        if left < 0 and used < time.time() - _YOUNG_SECONDS:
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)


def _contents(folder: Path) -> Iterator[tuple[float, int, Path]]:
    """Yield every file with when it was used [s] and its size [bytes]."""
    for place, _, names in os.walk(folder):
        for path in (Path(place) / name for name in names):
            try:
                about = path.lstat()
            except OSError:
                continue  # another process was faster
            yield max(about.st_atime, about.st_mtime), about.st_size, path


def _is_folder(path: Path) -> bool:
    return os.path.isdir(path) and not os.path.islink(path)
