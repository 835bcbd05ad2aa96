"""Kernels as they are lowered, kept on disk: the next process need not trace and lower them.

JAX's own cache holds machine code and finds it by the lowered program, so that a step whose machine
code is there takes seconds of tracing and lowering nevertheless. The files are StableHLO, as
`jax.export` writes it: they lie in the user's cache folder, are never exchanged, and one that is
not whole is thrown away.
"""

import contextlib
import functools
import hashlib
import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextvars import ContextVar
from pathlib import Path
from types import CodeType
from typing import Any, Final

import jax
import jaxlib.version
from jax import export
from jaxtyping import Array

from kinetix.engine import constants
from kinetix.engine.batch.program import shaped
from kinetix.files.caches import CACHES, bound, cache_folder
from kinetix.files.kept import read_kept, write_kept
from kinetix.source_digest import digest

_ENGINE: Final = "kinetix.engine."
_SOURCES: Final = f"{Path(constants.__file__).parents[1]}{os.sep}"
_LIBRARY: Final = os.path.dirname(os.__file__)
"""Folder of Python's own modules, whose decorators the engine uses."""
_PLATFORM: Final = "cpu"
_CACHE: Final = "lowered"
_SETTINGS: Final = ("jax_enable_x64", "jax_default_matmul_precision", "jax_use_shardy_partitioner")
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
        The results; None where it is to be lowered as ever.
    """
    if _INSIDE.get() or _declined():
        return None
    settings = tuple(jax.config.values[name] for name in _SETTINGS)
    kept = _lowered(
        f"{words} {settings} {_constants()}", run, tuple(shaped(x.shape, x) for x in leaves)
    )
    return None if kept is None else list(kept.call(*leaves))


def _constants() -> dict[str, Any]:
    """Return the present values of the engine's constants; experiments may change them."""
    return {name: value for name, value in vars(constants).items() if name.isupper()}


def _declined() -> bool:
    """Return whether the disk cache cannot be used: it is off, or what runs is not the sources."""
    settings = jax.config.values
    return (
        not settings["jax_enable_compilation_cache"]
        or settings["jax_persistent_cache_min_compile_time_secs"] == math.inf
        or digest() is None
        or any(map(_is_foreign, _of_engine()))
    )


def _of_engine() -> Iterator[Any]:
    """Yield whatever has a name in a module of the engine."""
    for name, module in tuple(sys.modules.items()):
        if name.startswith(_ENGINE):
            yield from tuple(vars(module).values())


def _is_foreign(value: Any) -> bool:
    """Return whether a function is from elsewhere: an experiment has put it into the engine."""
    code = getattr(value, "__code__", None)
    if code is None:  # `jax.jit` made it of one
        code = getattr(getattr(value, "__wrapped__", None), "__code__", None)
    if not isinstance(code, CodeType):
        return False
    file = code.co_filename
    return not file.startswith(_SOURCES) and os.path.dirname(file) != _LIBRARY


@functools.lru_cache(maxsize=64)
def _lowered(
    words: str, run: Callable[..., list[Array]], leaves: tuple[jax.ShapeDtypeStruct, ...]
) -> export.Exported | None:
    path = _file(f"{words} {[(x.shape, str(x.dtype), x.weak_type) for x in leaves]}")
    kept = read_kept(path, lambda content: export.deserialize(bytearray(content)))
    if kept is None:
        kept = _exported(run, leaves)
        if kept is not None:
            with contextlib.suppress(Exception):  # what cannot be serialised is used nevertheless
                write_kept(path, bytes(kept.serialize()))
                _tidy()
    return kept


def _exported(
    run: Callable[..., list[Array]], leaves: Sequence[jax.ShapeDtypeStruct]
) -> export.Exported | None:
    token = _INSIDE.set(True)
    try:
        # Of no mesh that the caller has set: the next process may have another, or none.
        with jax.sharding.use_abstract_mesh(jax.sharding.AbstractMesh((), ())):
            made = export.export(run, platforms=(_PLATFORM,))(*leaves)  # pyright: ignore[reportArgumentType]
    except Exception:  # it has something that no file can hold; errors are raised without
        return None
    finally:
        _INSIDE.reset(token)
    return made if made.nr_devices == 1 else None


def _file(words: str) -> Path:
    key = f"{words} {jax.__version__} {jaxlib.version.__version__} {digest()}"
    return cache_folder(_CACHE) / f"{hashlib.sha256(key.encode()).hexdigest()}.hlo"


@functools.cache
def _tidy() -> None:
    """Keep the folder within its bound, once in a process."""
    bound(cache_folder(_CACHE), CACHES[_CACHE].largest)
