"""Compiling C++ for a GPU, with NVIDIA's run-time compiler; what was compiled is kept on disk."""

import contextlib
import hashlib
import importlib
import importlib.util
import os
import re
from pathlib import Path
from typing import Any, Final

import jax

OPTIONS: Final = ("--std=c++17", "--prec-div=false", "--prec-sqrt=false")
"""Of the compiler, beside the architecture: quotients and roots to two units in the last place."""

PRELUDE: Final = (Path(__file__).parent / "prelude.h").read_text(encoding="utf-8")
"""Macros and functions that the generated C++ uses."""

_VERSION: Final = (8, 3)
"""Of the assembly: the oldest that has what is used, as drivers refuse what is newer than they."""

_OLD: Final = 90
"""Architectures up to this one are known to that version."""

_INSTALL: Final = "pip install --upgrade 'kinetix-editor[cuda12]' (or cuda13, as JAX's own)"


class CannotCompile(Exception):
    """The compiler is missing or fails; the message says what to do."""


def architecture() -> str | None:
    """Return the GPU's architecture, such as `sm_90`; None where there is no CUDA device."""
    try:
        device = jax.local_devices(backend="cuda")[0]
    except RuntimeError:
        return None
    return f"sm_{str(device.compute_capability).replace('.', '')}"


def compiled(source: str, target: str) -> str:
    """Compile a program.

    Args:
        source: C++.
        target: Architecture.

    Returns:
        The assembly (PTX), which the driver makes machine code of.

    Raises:
        CannotCompile: See there.
    """
    # Here: elsewhere JAX and numpy do.
    from kinetix.errors import LevelError
    from kinetix.files.atomic import write_atomically
    from kinetix.files.caches import cache_folder

    name = hashlib.sha256("\n".join([source, target, *OPTIONS]).encode()).hexdigest()
    file = cache_folder("kernels") / f"{name}.ptx"
    with contextlib.suppress(OSError):
        code = file.read_bytes()
        with contextlib.suppress(OSError):  # what can only be read is good too
            os.utime(file)
        return code.decode()
    code = _compiled(source, target)
    with contextlib.suppress(OSError, LevelError):  # a cache that cannot be written is not used
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(file, code)
    return code.decode()


def _compiled(source: str, target: str) -> bytes:
    if importlib.util.find_spec("cuda") is None:
        raise CannotCompile(f"NVIDIA's run-time compiler is missing: {_INSTALL}")
    try:
        nvrtc: Any = importlib.import_module("cuda.bindings.nvrtc")
        program = _checked(nvrtc.nvrtcCreateProgram(source.encode(), b"step.cu", 0, None, None))
    except (ImportError, RuntimeError) as error:
        raise CannotCompile(
            f"NVIDIA's run-time compiler cannot be used ({error}): {_INSTALL}"
        ) from error
    options = [option.encode() for option in (f"--gpu-architecture={target}", *OPTIONS)]
    (error,) = nvrtc.nvrtcCompileProgram(program, len(options), options)
    try:
        if int(error):
            log = b" " * _checked(nvrtc.nvrtcGetProgramLogSize(program))
            _checked(nvrtc.nvrtcGetProgramLog(program, log))
            first = log.decode(errors="replace").strip("\0 \n").split("\n")[0]
            raise CannotCompile(f"NVIDIA's run-time compiler refuses the kernel: {first}")
        code = b" " * _checked(nvrtc.nvrtcGetPTXSize(program))
        _checked(nvrtc.nvrtcGetPTX(program, code))
    finally:
        nvrtc.nvrtcDestroyProgram(program)
    return for_older_drivers(code.rstrip(b"\0"), target)


def for_older_drivers(code: bytes, target: str) -> bytes:
    """Have assembly claim no newer version of its language than it needs."""
    said = re.search(rb"(?m)^\.version (\d+)\.(\d+)", code)
    number = re.search(r"\d+", target)
    if said is None or number is None or int(number[0]) > _OLD:
        return code
    if (int(said[1]), int(said[2])) <= _VERSION:
        return code
    version = b".version %d.%d" % _VERSION
    return code[: said.start()] + version + code[said.end() :]


def _checked(result: tuple[Any, ...]) -> Any:
    """Return the value of a compiler call, or raise a RuntimeError if it failed."""
    error, *values = result
    if int(error):
        raise RuntimeError(str(error))
    return values[0] if values else None
