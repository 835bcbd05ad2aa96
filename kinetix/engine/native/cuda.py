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

from kinetix.paths import cache_dir

OPTIONS: Final = ("--std=c++17", "--prec-div=false", "--prec-sqrt=false")
"""Of the compiler, beside the architecture: quotients and roots to two units in the last place."""


_VERSION: Final = b"8.3"
"""Of the assembly: the oldest that has what it uses, as drivers refuse what is newer than they."""


class CannotCompile(Exception):
    """There is no compiler, or it refuses; the message says what to do."""


def architecture() -> str | None:
    """The GPU's architecture, such as `sm_90`; None where there is no CUDA device."""
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
    name = hashlib.sha256("\n".join([source, target, *OPTIONS]).encode()).hexdigest()
    file = cache_dir() / "kernels" / f"{name}.ptx"
    with contextlib.suppress(OSError):
        code = file.read_bytes()
        os.utime(file)
        return code.decode()
    code = _compiled(source, target)
    with contextlib.suppress(OSError):  # a cache that cannot be written to is none
        file.parent.mkdir(parents=True, exist_ok=True)
        own = file.with_suffix(f".{os.getpid()}")
        own.write_bytes(code)
        own.replace(file)
    return code.decode()


def _compiled(source: str, target: str) -> bytes:
    if importlib.util.find_spec("cuda") is None:
        raise CannotCompile(
            "NVIDIA's run-time compiler is missing: pip install 'kinetix-editor[cuda12]'"
        )
    try:
        nvrtc: Any = importlib.import_module("cuda.bindings.nvrtc")
        program = _checked(nvrtc.nvrtcCreateProgram(source.encode(), b"step.cu", 0, None, None))
    except (ImportError, RuntimeError) as error:
        raise CannotCompile(
            f"NVIDIA's run-time compiler cannot be used ({error}): "
            "pip install --upgrade 'kinetix-editor[cuda12]'"
        ) from error
    options = [option.encode() for option in (f"--gpu-architecture={target}", *OPTIONS)]
    result = nvrtc.nvrtcCompileProgram(program, len(options), options)
    try:
        if result[0] != nvrtc.nvrtcResult.NVRTC_SUCCESS:
            log = b" " * _checked(nvrtc.nvrtcGetProgramLogSize(program))
            _checked(nvrtc.nvrtcGetProgramLog(program, log))
            raise CannotCompile(log.decode(errors="replace").strip("\0 \n"))
        code = b" " * _checked(nvrtc.nvrtcGetPTXSize(program))
        _checked(nvrtc.nvrtcGetPTX(program, code))
    finally:
        nvrtc.nvrtcDestroyProgram(program)
    return re.sub(rb"(?m)^\.version .*$", b".version " + _VERSION, code.rstrip(b"\0"), count=1)


def _checked(result: tuple[Any, ...]) -> Any:
    """What a call of the compiler returns, beside its error."""
    error, *values = result
    if int(error):
        raise RuntimeError(str(error))
    return values[0] if values else None


PRELUDE: Final = (Path(__file__).parent / "prelude.h").read_text(encoding="utf-8")
"""What written programs are made of."""
