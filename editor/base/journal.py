"""The app's messages for the log panel: the newest few hundred, repeats counted."""

import dataclasses
from typing import Final

CAPACITY: Final = 400
"""Messages that are kept."""
NEIGHBOURS: Final = 8
"""Repeats are detected among this many newest messages."""


@dataclasses.dataclass(kw_only=True)
class Entry:
    """One message and how often it came."""

    text: str
    serial: int
    """Number of the last time it came, over the journal's whole life."""
    count: int = 1


class Journal:
    """Bounded, so that what fails sixty times a second fills neither memory nor the panel.

    One thread may write while another reads.
    """

    def __init__(self) -> None:
        self._entries: list[Entry] = []
        self._serial = 0

    @property
    def serial(self) -> int:
        """Number of messages that ever came; `since` takes it."""
        return self._serial

    @property
    def lines(self) -> tuple[str, ...]:
        """The messages, oldest first; what came more than once says how often."""
        return tuple(
            f"{entry.text.rstrip()} (×{entry.count})" if entry.count > 1 else entry.text
            for entry in tuple(self._entries)
        )

    def add(self, text: str) -> bool:
        """Take a message.

        Returns:
            Whether it is new; False for a repeat of one of the newest.
        """
        self._serial += 1
        for entry in reversed(self._entries[-NEIGHBOURS:]):
            if entry.text == text:
                entry.count, entry.serial = entry.count + 1, self._serial
                return False
        self._entries.append(Entry(text=text, serial=self._serial))
        del self._entries[:-CAPACITY]
        return True

    def since(self, serial: int) -> tuple[str, ...]:
        """Return the messages that came, or came again, after a number of `serial`."""
        return tuple(entry.text for entry in tuple(self._entries) if entry.serial > serial)
