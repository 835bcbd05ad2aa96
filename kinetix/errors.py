"""The errors that users meet: one sentence each, saying what is wrong and what was expected."""

import contextlib
from collections.abc import Iterator
from typing import Any, Final

LONGEST: Final = 1000
"""Characters of a sentence; what is longer loses its middle."""


def plain(text: str, longest: int = LONGEST) -> str:
    """Return a text as one bounded line that is safe to print, control characters escaped.

    Args:
        text: Any text, also out of files and names of files.
        longest: Characters that it may have; the middle of a longer one is left out.
    """
    if len(text) > longest:
        tail = longest // 4
        text = f"{text[: longest - tail - 3]} … {text[-tail:]}"
    if text.isprintable():
        return text
    # Control characters move a terminal's cursor, change its title or its colours; marks of
    # direction make a name read as another; what Unicode does not know may become anything.
    return "".join(one if one.isprintable() else _escaped(one) for one in text)


def _escaped(one: str) -> str:
    if one == "\n":
        return "\\n"
    return f"\\u{ord(one):04x}" if ord(one) < 0x10000 else f"\\U{ord(one):08x}"


class KinetixError(Exception):
    """Base of every error that this project raises on purpose; prints as one plain line."""

    def __str__(self) -> str:
        """Return the sentence, safe to print whatever the file contains."""
        return plain(super().__str__())


class LevelError(KinetixError):
    """A level or level-set file is bad: file, JSON path, what was expected, what was found."""

    def __init__(self, message: str, faults: tuple[Any, ...] = ()) -> None:
        """Keep the sentence, and each fault by itself where there are several.

        Args:
            message: The sentence that users read.
            faults: `kinetix.level.faults.Fault` values, when a file was read.
        """
        super().__init__(message)
        self.faults = faults


class CheckpointError(KinetixError):
    """An agent's directory is bad, or does not fit the level it is asked to play."""


class CommandError(KinetixError):
    """An edit cannot be done to this level; the sentence is meant for the status bar."""


@contextlib.contextmanager
def one_sentence() -> Iterator[None]:
    """End a script with status 1 and the sentence alone where an error of ours comes out of it.

    Raises:
        SystemExit: An error of ours was raised in the block.
    """
    try:
        yield
    except KinetixError as error:
        raise SystemExit(f"error: {error}") from None
