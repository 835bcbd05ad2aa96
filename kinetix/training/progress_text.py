"""Progress messages: permanent lines and a status line. Free of JAX."""

import re
import time
from collections.abc import Callable
from typing import Final

Say = Callable[[str], None]
"""Takes a sentence for the terminal."""


STATUS_INTERVAL: Final = 10.0
"""Least interval between two status lines of the same kind [s]."""


def say_nothing(text: str) -> None:
    """Ignore the message."""


def now_and_then(say: Say) -> Say:
    """Return what takes words for work under way and says some of them.

    Each new kind of work (the words before the first number tell) is said at once, then one line
    in a while, if it is another.

    Args:
        say: Takes a sentence.
    """
    kind, said, last = "", "", 0.0

    def status(text: str) -> None:
        nonlocal kind, said, last
        first, now = re.split(r"\d", text, maxsplit=1)[0], time.monotonic()
        if first != kind or (text != said and now - last >= STATUS_INTERVAL):
            kind, said, last = first, text, now
            say(text)

    return status
