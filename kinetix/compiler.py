"""Options of the XLA compiler: all of them here. Everything is correct without them, only slower.

They are read when JAX starts, so they are set when `kinetix` is imported; whoever has started JAX
before does without.
"""

import os
from collections.abc import MutableMapping
from typing import Final

_OPTIONS: Final = {
    # A loop that moves fewer bytes than this becomes one machine routine, not a chain of kernels
    # that are called one by one. A step is many small loops: see docs/physics.md for what it gives.
    "xla_cpu_small_while_loop_byte_threshold": "1000000",
}
_FLAG: Final = "--xla_backend_extra_options="


def ask_for_options(variables: MutableMapping[str, str] = os.environ) -> None:
    """Add our options to `XLA_FLAGS`, unless somebody has set options of this kind already.

    Args:
        variables: The variables of the process.
    """
    flags = variables.get("XLA_FLAGS", "")
    if _FLAG in flags:
        return
    options = ",".join(f"{name}={value}" for name, value in _OPTIONS.items())
    variables["XLA_FLAGS"] = f"{flags} {_FLAG}{options}".strip()
