"""Processes that do not outlive the tests, however those end."""

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

_TIED = """
import ctypes, os, signal, sys

PR_SET_PDEATHSIG, SIGKILL = 1, 9
libc = ctypes.CDLL(None)
if hasattr(libc, "prctl"):
    libc.prctl(PR_SET_PDEATHSIG, SIGKILL)
if os.getppid() != int(sys.argv[1]):
    sys.exit("the tests are gone")
# A shell that starts the tests in the background has them ignore Ctrl+C; the app must not.
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.execvp(sys.argv[2], sys.argv[2:])
"""


def tied(command: Sequence[str]) -> list[str]:
    """A command that is killed with the process that starts it (on Linux)."""
    return [sys.executable, "-c", _TIED, str(os.getpid()), *command]


def start(command: Sequence[str], **options: Any) -> subprocess.Popen[str]:
    """Start a tied command as the leader of a process group."""
    return subprocess.Popen(tied(command), start_new_session=True, text=True, **options)


def end(process: subprocess.Popen[str]) -> None:
    """Kill a process of `start` with all that it started, and wait for it."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait(10)
    if process.stderr is not None:
        process.stderr.close()
