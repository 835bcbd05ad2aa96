"""Kernels as they are lowered, kept on disk: the next process need not trace and lower them.

JAX's own cache holds machine code and finds it by the lowered program, so that a step whose machine
code is there takes seconds of tracing and lowering nevertheless. The files are StableHLO, as
`jax.export` writes it: they lie in the user's cache folder, are never exchanged, and one that is
not whole is thrown away.
"""

import contextlib
import functools
import hashlib
import os
import zlib
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from pathlib import Path
from typing import Any, Final

import jax
import jaxlib.version
from jax import export
from jaxtyping import Array

from kinetix.errors import LevelError
from kinetix.files.atomic import write_atomically
from kinetix.files.caches import cache_folder
from kinetix.sources import digest

_PLATFORM: Final = "cpu"
_SETTINGS: Final = ("jax_enable_x64", "jax_default_matmul_precision")
"""JAX's options that change what is lowered; promotion is always the usual one."""
_INSIDE: Final = ContextVar("inside", default=False)
"""True while a kernel is lowered for the disk: kernels within it are part of it."""


def from_disk(
    words: str, run: Callable[..., list[Array]], leaves: Sequence[Any]
) -> list[Array] | None:
    """Apply a kernel by its lowered form, from disk where it is there.

    Args:
        words: All about the kernel; equal words mean equal programs for equal shapes.
        run: The kernel, jitted, to be lowered where there is no file.
        leaves: Its arguments, while a program for a processor is lowered.

    Returns:
        The results; None inside of another kernel that is lowered for the disk.
    """
    if _INSIDE.get():
        return None
    shapes = tuple((x.shape, x.dtype, bool(getattr(x, "weak_type", False))) for x in leaves)
    settings = tuple(getattr(jax.config, name) for name in _SETTINGS)
    return _lowered(f"{words} {settings}", run, shapes).call(*leaves)


@functools.lru_cache(maxsize=64)
def _lowered(words: str, run: Callable[..., list[Array]], shapes: tuple[Any, ...]) -> Any:
    path = _file(f"{words} {shapes}")
    kept = _load(path)
    if kept is not None:
        return kept
    token = _INSIDE.set(True)
    try:
        arguments = [jax.ShapeDtypeStruct(s, d, weak_type=weak) for s, d, weak in shapes]
        made = export.export(run, platforms=(_PLATFORM,))(*arguments)  # pyright: ignore[reportArgumentType]
    finally:
        _INSIDE.reset(token)
    _save(path, made)
    return made


def _file(words: str) -> Path:
    key = f"{words} {jax.__version__} {jaxlib.version.__version__} {digest()}"
    return cache_folder("lowered") / f"{hashlib.sha256(key.encode()).hexdigest()}.hlo"


def _declined() -> bool:
    return not jax.config.values["jax_enable_compilation_cache"]


def _load(path: Path) -> export.Exported | None:
    if _declined():
        return None
    try:
        kept = export.deserialize(bytearray(zlib.decompress(path.read_bytes())))
    except FileNotFoundError:
        return None
    except Exception:  # whatever is wrong with it, it is lowered anew
        with contextlib.suppress(OSError):  # the folder may be one that can only be read
            path.unlink(missing_ok=True)
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return kept


def _save(path: Path, made: export.Exported) -> None:
    if _declined():
        return
    with contextlib.suppress(OSError, LevelError):  # a cache that cannot be written to is none
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, zlib.compress(bytes(made.serialize()), 1))
