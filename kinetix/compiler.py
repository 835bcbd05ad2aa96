"""Options of the XLA compiler: all of them here. Everything is correct without them, only slower.

They are read when JAX starts, so they are set when `kinetix` is imported; whoever has started JAX
before does without. They hold for the whole process and its children: JAX takes options of a single
program for the outermost `jit` alone, which is the user's. `KINETIX_COMPILER_OPTIONS=0` declines.
"""

import functools
import importlib.metadata
import importlib.util
import os
from collections.abc import Mapping, MutableMapping
from typing import Final

DECLINED: Final = "KINETIX_COMPILER_OPTIONS"
"""Variable that leaves XLA as it is if it is 0."""
_ON_PROCESSORS: Final = {
    # Worlds are lanes, so kernels are loops over 16 numbers at a time where the processor has room.
    "--xla_cpu_prefer_vector_width": "512",
    "--xla_backend_extra_options": ",".join(
        [
            # A loop that moves fewer bytes than this becomes one machine routine, not a chain of
            # kernels that are called one by one. A step is many small loops: see docs/physics.md
            # for what it gives.
            "xla_cpu_small_while_loop_byte_threshold=8000000",
            # Finds nothing in loops over worlds, and takes its time to compile.
            "xla_cpu_disable_slp_vectorizer=true",
        ]
    ),
}
_QUICKER: Final = {
    # An eighth less time to compile a step, which runs as fast.
    "--xla_backend_optimization_level": "1",
}
"""Flags for CPU-only machines; elsewhere this level would apply to GPU programs too."""
_PLUGINS: Final = ("jax_plugins", "libtpu")
"""Packages, one of which is there where JAX may find an accelerator."""


def ask_for_options(variables: MutableMapping[str, str] = os.environ) -> None:
    """Add our flags to `XLA_FLAGS`, but for those that somebody has set already.

    Args:
        variables: The variables of the process.
    """
    if variables.get(DECLINED, "").strip() == "0":
        return
    flags = dict(_ON_PROCESSORS)
    if not any(importlib.util.find_spec(name) for name in _PLUGINS):
        flags |= _QUICKER
    set_before = variables.get("XLA_FLAGS", "")
    ours = [f"{flag}={value}" for flag, value in flags.items() if flag not in set_before]
    variables["XLA_FLAGS"] = " ".join([set_before, *ours]).strip()


def _has_older_emitters() -> bool:
    """Return whether this JAX can still make kernels without the newer fusion emitters.

    XLA ends the process for a flag that it does not know.
    """
    try:
        version = importlib.metadata.version("jaxlib")
    except importlib.metadata.PackageNotFoundError:
        return False
    return version.startswith(("0.9.", "0.10."))


_LEFT_OUT: Final = (
    "reshape-mover",
    "while-loop-constant-sinking",
    "while-loop-invariant-code-motion",
)
"""Passes over a program that take an eighth of the time and gain nothing at level 0."""


@functools.cache
def quick_options() -> Mapping[str, int | bool | str]:
    """Options of a single program on a processor that somebody waits for.

    It compiles in a third of the time and runs up to four times slower: machine code as it comes,
    without LLVM's improvements, and kernels by the older emitters where JAX still has them.
    """
    options: dict[str, int | bool | str] = {
        "xla_backend_optimization_level": 0,
        "xla_disable_hlo_passes": ",".join(_LEFT_OUT),
    }
    if _has_older_emitters():
        options["xla_cpu_use_fusion_emitters"] = False
    return options
