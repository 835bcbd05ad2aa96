"""The system's clipboard, and one for where there is none."""

from typing import Protocol


class Clipboard(Protocol):
    """The system's clipboard, text only."""

    def get(self) -> str:
        """Return the text it holds, or nothing."""
        ...

    def set(self, text: str) -> None:
        """Put a text there."""
        ...


class MemoryClipboard:
    """A clipboard of the process alone, where there is no system's."""

    def __init__(self) -> None:
        self._text = ""

    def get(self) -> str:
        """Return the text that it holds."""
        return self._text

    def set(self, text: str) -> None:
        """Put a text there."""
        self._text = text
