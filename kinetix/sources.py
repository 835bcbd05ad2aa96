"""The package's own sources, as part of the key of what is made from them and kept on disk."""

import functools
import hashlib
import importlib.resources
from pathlib import Path


@functools.cache
def digest() -> str:
    """Return the SHA-256 of all Python files of the package, in hexadecimal digits."""
    sources = hashlib.sha256()
    for path in sorted(Path(str(importlib.resources.files("kinetix"))).rglob("*.py")):
        sources.update(path.read_bytes())
    return sources.hexdigest()
