"""Compiled steps on disk: on the second day nothing is traced, lowered or compiled.

JAX's own cache saves the compiling alone, and it is tracing and lowering that take the time then.
The files are machine code of this computer, like those of JAX's cache beside them: they lie in the
user's cache folder, are never exchanged, and a file that is not whole is thrown away.
"""

import contextlib
import functools
import hashlib
import os
import platform
import secrets
from pathlib import Path
from typing import Any, Final

import jax
import jaxlib.version
from jax.experimental import serialize_executable

from kinetix.files.caches import cache_folder
from kinetix.files.kept import read_kept, write_kept
from kinetix.source_digest import digest

_SUFFIX: Final = ".step"


def folder() -> Path:
    """Return the folder of the steps."""
    return cache_folder("steps")


def _file(key: object) -> Path:
    words = f"{key!r} {_stamp()}"
    return folder() / (hashlib.sha256(words.encode()).hexdigest() + _SUFFIX)


@functools.cache
def _stamp() -> str:
    """Return the dependencies of a compiled step besides its parameters."""
    parts = (
        jax.__version__,
        jaxlib.version.__version__,
        digest() or secrets.token_hex(),  # nobody finds what edited sources made
        Path(__file__).with_name("stepping.py").read_bytes(),
        os.environ.get("XLA_FLAGS", ""),
        len(jax.devices()),
        _processor(),
    )
    return repr(parts)


def _processor() -> str:
    """Return the processor's name and features."""
    listed = Path("/proc/cpuinfo")
    if os.path.isfile(listed):
        told = listed.read_text(encoding="utf-8", errors="replace").splitlines()
        kinds = ("model name", "flags", "Features")
        return "\n".join(sorted({line for line in told if line.startswith(kinds)}))
    return f"{platform.machine()} {platform.processor()}"


def has(key: object) -> bool:
    """Return whether a step lies on disk."""
    return os.path.isfile(_file(key))


def load(key: object, arguments: Any, results: Any) -> Any | None:
    """Return a step from disk, or None.

    Args:
        key: Its parameters; their `repr` must identify them.
        arguments: Positional arguments, to try it with.
        results: A tree like the results.
    """
    takes = jax.tree.structure((arguments, {}))

    def loaded(code: bytes) -> Any:
        program = serialize_executable.deserialize_and_load(
            code, takes, jax.tree.structure(results), execution_devices=jax.devices()[:1]
        )
        # What came from JAX's cache was written without some of its code: only a run shows it.
        jax.block_until_ready(program(*arguments))
        return program

    return read_kept(_file(key), loaded)


def save(key: object, program: Any) -> None:
    """Write a step; where that cannot be done, it is compiled again another day.

    All threads stand for a tenth of a second.
    """
    with contextlib.suppress(ValueError, RuntimeError):
        code, _, _ = serialize_executable.serialize(program)
        write_kept(_file(key), code)
