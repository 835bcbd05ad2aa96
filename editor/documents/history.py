"""Undo and redo by immutable snapshots: nothing has to be undone, only shown again."""

import dataclasses
from collections.abc import Hashable
from typing import Final, Generic, TypeVar

T = TypeVar("T")
S = TypeVar("S")

ENTRIES_MAX: Final = 1000
"""Snapshots kept; each shares its unchanged parts with its neighbours, so one costs a few kB."""
MERGE_SECONDS: Final = 0.5
"""Entries with the same merge key that follow each other faster than this become one."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Entry(Generic[T, S]):
    """One state of the document and how it came about."""

    label: str
    """Description of the change that led here: "Move 2 shapes"."""
    value: T
    """The document's content."""
    selection: S
    """Selection after it."""
    merge_key: Hashable | None = None
    time: float = 0.0
    """Time at which it was made [s]."""


class History(Generic[T, S]):
    """A list of snapshots with a cursor; selection-only changes never clear what can be redone."""

    def __init__(self, value: T, selection: S, label: str = "Open") -> None:
        self._entries: list[Entry[T, S]] = [Entry(label=label, value=value, selection=selection)]
        self._cursor = 0

    @property
    def entries(self) -> tuple[Entry[T, S], ...]:
        """All snapshots, oldest first, those ahead of the cursor included."""
        return tuple(self._entries)

    @property
    def cursor(self) -> int:
        """Index of the current snapshot."""
        return self._cursor

    @property
    def current(self) -> Entry[T, S]:
        """The snapshot that is shown."""
        return self._entries[self._cursor]

    @property
    def undo_label(self) -> str | None:
        """Change that undo would take back, or None."""
        return self._entries[self._cursor].label if self._cursor > 0 else None

    @property
    def redo_label(self) -> str | None:
        """Change that redo would make again, or None."""
        following = self._cursor + 1
        return self._entries[following].label if following < len(self._entries) else None

    def push(self, entry: Entry[T, S]) -> None:
        """Add a snapshot after the cursor; merges with the last one where the rules allow it."""
        del self._entries[self._cursor + (0 if self._merges(entry) else 1) :]
        self._entries.append(entry)
        if len(self._entries) > ENTRIES_MAX:
            del self._entries[0]
        self._cursor = len(self._entries) - 1

    def drop(self) -> None:
        """Forget the snapshot at the cursor, which is not the first, and what follows it."""
        del self._entries[self._cursor :]
        self._cursor -= 1

    def before(self, entry: Entry[T, S]) -> T:
        """Return the snapshot that undo would show after such a push."""
        return self._entries[self._cursor - (1 if self._merges(entry) else 0)].value

    def _merges(self, entry: Entry[T, S]) -> bool:
        last = self.current
        return (
            self._cursor > 0
            and entry.merge_key is not None
            and entry.merge_key == last.merge_key
            and entry.time - last.time <= MERGE_SECONDS
        )

    def seal(self) -> None:
        """End a run of merging entries: the next one stands alone."""
        self._entries[self._cursor] = dataclasses.replace(self.current, merge_key=None)

    def select(self, selection: S) -> None:
        """Remember what is selected at the cursor."""
        self._entries[self._cursor] = dataclasses.replace(self.current, selection=selection)

    def jump(self, index: int) -> Entry[T, S]:
        """Move the cursor to any snapshot.

        Raises:
            IndexError: No snapshot has this index.
        """
        if not 0 <= index < len(self._entries):
            raise IndexError(f"no history entry {index}; there are {len(self._entries)}")
        self._cursor = index
        self.seal()
        return self.current

    def undo(self) -> Entry[T, S] | None:
        """Go one step back, or None at the beginning."""
        return self.jump(self._cursor - 1) if self._cursor > 0 else None

    def redo(self) -> Entry[T, S] | None:
        """Go one step forward, or None at the end."""
        return self.jump(self._cursor + 1) if self._cursor + 1 < len(self._entries) else None
