"""Processes that were forked from one in which JAX runs: there it would wait for ever."""

import os
from typing import Final

import jax

from kinetix.errors import KinetixError

_FORKED: Final[list[int]] = []
"""Grows in a process whose parent had started JAX, and so its threads."""


def _note() -> None:
    if _runs():
        _FORKED.append(os.getpid())


def _runs() -> bool:
    """Return whether JAX has started; True where this version does not tell."""
    bridge = getattr(getattr(jax, "_src", None), "xla_bridge", None)
    started = getattr(bridge, "backends_are_initialized", None)
    return started is None or bool(started())


if hasattr(os, "register_at_fork"):  # not on Windows, where nothing forks
    os.register_at_fork(after_in_child=_note)


def refuse_forked_process(instead: str) -> None:
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
