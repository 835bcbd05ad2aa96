"""Processes for tests that start many and kill them: forked from one that has imported already.

The one they are forked from has never started JAX, whose threads no fork would survive.
"""

import multiprocessing
from collections.abc import Callable
from multiprocessing.process import BaseProcess
from typing import Any, Final

_IMPORTED: Final = [
    "tests.editor.core.endless_edits",
    "tests.training.silent_run",
    "kinetix.cli.train",
    "kinetix.training.run",
    "kinetix.training.ppo.train",
    "tyro",
]
"""Modules that every such process begins with."""


def start(work: Callable[..., Any], *arguments: Any) -> BaseProcess:
    """Start a process that does some work and ends; `kill` and `join` are up to the test.

    Args:
        work: A function of a module, not of a function.
        *arguments: What it gets.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(_IMPORTED)
    process = context.Process(target=work, args=arguments, daemon=True)
    process.start()
    return process
