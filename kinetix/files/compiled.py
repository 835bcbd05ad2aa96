"""JAX's cache of compiled programs: JAX warns of an entry that is cut, and never replaces it."""

import contextlib
import re
import sys
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from kinetix.files.caches import cache_folder

_TROUBLE: Final = re.compile(
    r"Error (reading|writing) persistent compilation cache entry for '(.+?)': (.*)", re.DOTALL
)
"""JAX's warning: what it did, the program's name, and why it failed."""
_SENTENCES: Final = {
    "reading": "a compiled program in it was damaged; it is compiled again "
    "(`kinetix cache --clear` deletes all of them)",
    "writing": "compiled programs cannot be kept there ({why}); the next command compiles again",
}


@contextlib.contextmanager
def mended_programs() -> Iterator[None]:
    """Delete entries that JAX warns of within a block, and tell it in one sentence.

    Without the entry JAX writes the program anew. Caches that are not ours stay as they are.
    """
    told: set[str] = set()
    before = warnings.showwarning

    def show(message: Warning | str, *more: Any, **options: Any) -> None:
        trouble = _TROUBLE.match(str(message))
        folder = cache_folder("jax")
        if trouble is None or not _is_used(folder):
            before(message, *more, **options)
            return
        did, name, why = trouble.groups()
        entries = [path for path in folder.glob("*-cache") if path.name.startswith(f"{name}-")]
        cut = [path for path in entries if not _is_whole(path)]
        # The warning does not tell which one was read.
        for path in cut or (entries if did == "reading" else ()):
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)
        if did not in told:
            told.add(did)
            print(f"{folder}: {_SENTENCES[did].format(why=why)}", file=sys.stderr)  # noqa: T201

    with warnings.catch_warnings():  # what is changed here is as before afterwards
        # Python would show the same words only once, and two programs may have the same name.
        warnings.filterwarnings("always", message="Error .* persistent compilation cache")
        warnings.showwarning = show
        yield


def _is_used(folder: Path) -> bool:
    """Return whether JAX keeps its programs in a folder."""
    jax: Any = sys.modules.get("jax")
    return jax is not None and jax.config.jax_compilation_cache_dir == str(folder)


def _is_whole(path: Path) -> bool:
    try:
        zlib.decompress(path.read_bytes())
    except (OSError, zlib.error):
        return False
    return True
