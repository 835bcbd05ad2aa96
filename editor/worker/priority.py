"""Priority of a thread on the processor."""

import os
import sys
import threading


def step_back(niceness: int) -> None:
    """Let the window and what is played go before the calling thread, for good.

    Args:
        niceness: 1 … 19, as of a process; threads have one of their own on Linux alone.
    """
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), niceness)
