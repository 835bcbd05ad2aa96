"""Kernels without a GPU: the text is compiled for the processor, where one lane does everything."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest

from kinetix.engine.backend import whole_batches
from kinetix.engine.native.cuda import PRELUDE
from kinetix.engine.native.elementwise import c_type
from kinetix.engine.native.from_jaxpr import program
from kinetix.engine.native.writer import written
from kinetix.engine.promotion import usual_promotion

needs_compiler = pytest.mark.skipif(shutil.which("g++") is None, reason="needs a C++ compiler")


class Emulated:
    """A function of arrays, translated and compiled."""

    def __init__(
        self,
        function: Callable[..., Any],
        arguments: Sequence[Any],
        folder: Path,
        *,
        largest: int = 1024,
        backwards: bool = False,
    ) -> None:
        """Compile.

        Args:
            function: From arrays to a list of arrays.
            arguments: Such as it takes.
            folder: For files.
            largest: Array of near memory [bytes].
            backwards: Whether the lanes' entries are done from the last to the first: the order
                must not matter.
        """
        shapes = [jax.ShapeDtypeStruct(np.shape(x), np.asarray(x).dtype) for x in arguments]
        with whole_batches(), usual_promotion():
            self.program = program(function, shapes)
        self.text = written(self.program).laid_out(largest)
        given, made = self.program.inputs, self.program.outputs
        parameters = [
            f"{c_type(x.dtype)}* in{k} = ({c_type(x.dtype)}*)arrays[{k}];"
            for k, x in enumerate(given)
        ] + [
            f"{c_type(x.dtype)}* out{k} = ({c_type(x.dtype)}*)arrays[{len(given) + k}];"
            for k, x in enumerate(made)
        ]
        head = 'extern "C" void step(void** arrays, unsigned char* near, unsigned char* far) {'
        lines = [PRELUDE, self.text.constants, head, *parameters, self.text.body, "}"]
        source, library = folder / "step.cpp", folder / "step.so"
        source.write_text("\n".join(lines), encoding="utf-8")
        flags = ["-DPROCESSOR", *(["-DBACKWARDS"] if backwards else [])]
        command = ["g++", "-w", "-O0", "-ffp-contract=off", "-shared", "-fPIC", *flags]
        command += [str(source), "-o", str(library), "-lm"]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[:2000]
        self._step = ctypes.CDLL(str(library)).step

    def __call__(self, *arguments: Any) -> list[np.ndarray]:
        """Run it, with memory that holds nonsense."""
        given = [
            np.ascontiguousarray(x, v.dtype)
            for x, v in zip(arguments, self.program.inputs, strict=True)
        ]
        made = [np.full(v.shape, 77, v.dtype) for v in self.program.outputs]
        memory = [np.full(size + 8, 255, np.uint8) for size in (self.text.near, self.text.far)]
        arrays = [*given, *made]
        pointers = (ctypes.c_void_p * len(arrays))(*[x.ctypes.data for x in arrays])
        self._step(pointers, *[ctypes.c_void_p(x.ctypes.data) for x in memory])
        return made
