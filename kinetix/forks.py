"""Processes that were forked from one in which JAX runs: there it would wait for ever."""

import os
import sys
from typing import Final

from kinetix.errors import KinetixError

SPAWN: Final = 'start it again, as multiprocessing.get_context("spawn") does'
"""Advice for error messages: how to start the process without a fork."""
_FORKED: Final[list[int]] = []
"""Grows in a process whose parent had started JAX, and so its threads."""


def _note() -> None:
    if _runs():
        _FORKED.append(os.getpid())


def _runs() -> bool:
    """Return whether JAX has started; if this version cannot report it, whether it is imported."""
    if "jax" not in sys.modules:
        return False
    bridge = sys.modules.get("jax._src.xla_bridge")
    started = getattr(bridge, "backends_are_initialized", None)
    return started is None or bool(started())


def watch_forks() -> None:
    """Remember from now on whether a process is forked from one in which JAX runs."""
    if hasattr(os, "register_at_fork"):  # not on Windows, where nothing forks
        os.register_at_fork(after_in_child=_note)


def refuse_forked_process(instead: str = SPAWN) -> None:
    """Refuse to compute where JAX would wait for threads that a fork has left behind.

    Args:
        instead: What to do, for the sentence.

    Raises:
        KinetixError: This process was forked from one that had started JAX.
    """
    if _FORKED:
        raise KinetixError(
            f"this process was forked from one in which JAX runs, and would hang: {instead}"
        )
