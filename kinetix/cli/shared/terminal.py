"""The terminal as a long command uses it: lines that stay, and a status line."""

import contextlib
import itertools
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Final, TypeVar

from kinetix.failures import mute
from kinetix.training.progress_text import Say, now_and_then

_T = TypeVar("_T")
_BACK_AND_CLEAR = "\r\x1b[K"
PATIENCE: Final = 3.0
"""Time after which somebody who waits wants to know for what [s]."""


@contextlib.contextmanager
def announced(text: str, *, after: float = PATIENCE, say: Say | None = None) -> Iterator[None]:
    """Show the status, if it takes long.

    Args:
        text: What is.
        after: How long it may take without a word [s].
        say: Takes the words; by default they are a line on stderr.
    """
    timer = threading.Timer(after, say or (lambda text: _write(f"{text}\n")), [text])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


class Terminal:
    """Writes to stderr; where that is no terminal, some of the passing words become lines.

    Once nobody reads it (`| head`, a terminal that was closed) the command goes on without a word.
    """

    def __init__(self) -> None:
        """Begin on an empty line."""
        self._shows_status = False
        self._overwrites = sys.stderr.isatty()
        self._now_and_then = now_and_then(self.say)

    def say(self, text: str) -> None:
        """Write a line that stays."""
        clear = _BACK_AND_CLEAR if self._shows_status else ""
        self._shows_status = False
        _write(f"{clear}{text}\n")

    def status(self, text: str) -> None:
        """Write what is under way; the next words take its place."""
        if not self._overwrites:
            self._now_and_then(text)
            return
        self._shows_status = True
        _write(f"{_BACK_AND_CLEAR}{text} …")

    def close(self) -> None:
        """Leave an empty line."""
        if self._shows_status:
            self._shows_status = False
            _write(_BACK_AND_CLEAR)


def _write(text: str) -> None:
    try:
        print(text, end="", file=sys.stderr, flush=True)
    except OSError:
        mute(sys.stderr)


def counted(
    items: Iterable[_T], first: str, told: Callable[[int], str], terminal: Terminal
) -> Iterator[_T]:
    """Yield things that take long to make; report the wait for the first one, then the count.

    Args:
        items: Made one by one as they are taken.
        first: Words for the wait for the first one.
        told: Words for a count.
        terminal: The terminal; its status line is empty after the last one.
    """
    making = iter(items)
    with announced(first, say=terminal.status):
        beginning = list(itertools.islice(making, 1))
    yield from beginning
    began = time.monotonic()
    for number, item in enumerate(making, start=2):
        if time.monotonic() - began > PATIENCE:
            terminal.status(told(number))
        yield item
    terminal.close()
