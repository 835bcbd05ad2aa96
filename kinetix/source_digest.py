"""The package's own sources, as part of the key of what is made from them and kept on disk."""

import functools
import hashlib
import importlib.resources
import time
from pathlib import Path
from typing import Final

_BEGAN: Final = time.time()


@functools.cache
def digest() -> str | None:
    """Return the SHA-256 of all Python files of the package, in hexadecimal digits.

    None where one was written after this process began: what runs may not be what lies there.
    """
    return digest_of(Path(str(importlib.resources.files("kinetix"))), _BEGAN)


def digest_of(package: Path, began: float) -> str | None:
    """Return the same of any folder.

    Args:
        package: The folder.
        began: Time after which a file counts as changed [s].
    """
    sources = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        if path.stat().st_mtime > began:
            return None
        sources.update(path.read_bytes())
    return sources.hexdigest()
