"""The contract of every edit: a frozen value with a pure `apply`; nobody writes an undo."""

from collections.abc import Hashable
from typing import Protocol, TypeAlias

from kinetix.level.model import Level

EntityId: TypeAlias = int | str
"""The id of a body, joint or thruster, or the name of an arena body (`"floor"`)."""
Selection: TypeAlias = tuple[EntityId, ...]
"""Selected ids, in the order of selecting; the last one is the primary one."""


class Command(Protocol):
    """One edit of a level.

    Implementations are frozen dataclasses. New entities take their ids from `level.next_id`, which
    the document keeps above every id it ever gave.
    """

    @property
    def label(self) -> str:
        """Description for the menu and the history panel: "Rotate 3 shapes"."""
        ...

    @property
    def merge_key(self) -> Hashable | None:
        """Equal keys in quick succession become one history entry; None never merges."""
        ...

    def apply(self, level: Level) -> Level:
        """Return the level after the edit; the same object when nothing changes.

        Raises:
            CommandError: The edit cannot be done; the message is for the status bar.
        """
        ...


def count_label(verb: str, count: int, noun: str) -> str:
    """Return a label that counts: `Move shape`, `Move 3 shapes`."""
    return f"{verb} {noun}" if count == 1 else f"{verb} {count} {noun}s"
