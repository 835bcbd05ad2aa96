"""One open level: what is committed, what a gesture previews, what undo remembers."""

import dataclasses
import datetime
import hashlib
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal, TypeAlias

from editor.base.wording import describe, spoken, title_of
from editor.documents.commands.base import Command, EntityId, Selection
from editor.documents.history import Entry, History
from kinetix.errors import CommandError
from kinetix.level.codec import level_hash
from kinetix.level.integrity import level_faults
from kinetix.level.kinetix_env.document import KinetixEnvDocument
from kinetix.level.model import ARENA_NAMES, MAX_ENTITIES, Level
from kinetix.level.sizes import without_outgrown_size
from kinetix.level.validate import Issue, validate, value_issues

Format: TypeAlias = Literal["kinetix-level", "kinetix-env"]

_NUMBERS = itertools.count(1)
_TEXT_FIELDS: Final = ("name", "description", "tags", "solution", "next_id")
"""Fields that may change without making a recorded solution invalid."""
_UNREADABLE: Final = ("E106", "E107")
"""Issues of values that no reader takes: out of range, or no shape."""
_TOLD_AS_VALUES: Final = ("E011", "E012")
"""Faults of shapes, which `value_issues` tells by the shape's name."""


def same_content(a: Level, b: Level) -> bool:
    """Return whether two levels are equal but for the id counter."""
    return a is b or a.replace(next_id=b.next_id) == b


def same_simulation(a: Level, b: Level) -> bool:
    """Return whether two levels play alike, whatever their names, texts and solutions."""
    if a is b:
        return True
    texts = {name: getattr(b, name) for name in _TEXT_FIELDS}
    return a.unnamed().replace(**texts) == b.unnamed()


def _refuse_unwritable(after: Level, before: Level) -> None:
    """Refuse a change with which a file could be written, but not opened again.

    Raises:
        CommandError: The change does that; the message says what no file can hold.
    """
    for kind in ("bodies", "joints", "thrusters"):
        count = len(getattr(after, kind))
        if count > max(MAX_ENTITIES, len(getattr(before, kind))):
            noun = "shapes" if kind == "bodies" else kind
            raise CommandError(
                f"A level holds at most {MAX_ENTITIES} {noun}; this would make {count}. "
                "Nothing was changed."
            )
    new = set(_unreadable(after))
    new -= set(_unreadable(before)) if new else set()
    if new:
        raise CommandError(f"{min(new)} Nothing was changed.")


def _unreadable(level: Level) -> Iterator[str]:
    """Yield a sentence for all that a reader of the file would refuse.

    A size that the level has outgrown is left out: a save makes it automatic.
    """
    yield from (issue.message for issue in value_issues(level) if issue.code in _UNREADABLE)
    for fault in level_faults(without_outgrown_size(level)):
        if fault.code not in _TOLD_AS_VALUES:
            yield f"Level{fault.path[1:]}: {fault.message}."


@dataclasses.dataclass(frozen=True, kw_only=True)
class Outcome:
    """Result of a commit."""

    changed: bool
    """False: the command changed nothing and made no history entry."""
    created: Selection = ()
    """Ids of the entities that are new."""
    notices: tuple[str, ...] = ()
    """Sentences about side effects that the user should know."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Stamp:
    """A file as it was read: enough to notice that somebody else changed it."""

    modified_ns: int
    content: bytes

    @property
    def digest(self) -> str:
        """Short name of the content."""
        return hashlib.sha256(self.content).hexdigest()


class Document:
    """A level being edited: immutable snapshots, a preview on top, a counter that only rises."""

    def __init__(
        self,
        level: Level,
        *,
        path: Path | None = None,
        format: Format = "kinetix-level",
        warnings: tuple[str, ...] = (),
        source: KinetixEnvDocument | None = None,
    ) -> None:
        self.number = next(_NUMBERS)
        """Tells the documents of one run apart."""
        self.source = source
        """kinetix-env's file as it was read, for writing it back byte for byte."""
        self.stamp: Stamp | None = None
        """State of the file on disk when it was last read or written."""
        self.outside = ""
        """Change of the file by another program; empty: none."""
        self.readable = True
        """False if that program has left a file that cannot be read."""
        self.replaces_other = False
        """True if the next save takes the place of what another program has put into the file."""
        self.path = path
        self.format: Format = format
        self.warnings = warnings
        """Parts of the file that the document does not hold, one sentence each."""
        self.locked: frozenset[EntityId] = frozenset()
        """Entities that picking passes over; editor state, not saved."""
        self.hidden: frozenset[EntityId] = frozenset()
        """Entities that are not drawn in Edit; editor state, not saved."""
        self.autosaved: Level = level
        """Level of the last autosave, or as opened."""
        self.autosaved_at: datetime.datetime | None = None
        """Time of the last copy of unsaved changes; None: there is none."""
        self.origin: tuple[Path, ...] = ()
        """Copies of earlier runs that it was restored from: kept until it is saved or closed."""
        self.given_up: Level | None = None
        """The level that the user chose not to save; None: there was no such choice."""
        self.passing = False
        """True for a moment of an episode: when it is no longer open, no copy of it is kept."""
        self.drawn = False
        """True if it was drawn at random: until it is changed, the next one may take its tab."""
        self.saves = 0
        """Number of saves."""
        self._history: History[Level, Selection] = History(level, ())
        self._saved: Level | None = level
        self._next_id = level.next_id
        self._counted: tuple[Level, Level] | None = None
        """A snapshot, and the same level with the document's counter."""
        self._selection: Selection = ()
        self._preview: Level | None = None
        self._issues: tuple[Level, tuple[Issue, ...]] | None = None

    @property
    def level(self) -> Level:
        """The committed level; its `next_id` is the document's counter.

        The same object until something changes: after something new was undone too, when the
        snapshot counts less.
        """
        level = self._history.current.value
        if level.next_id == self._next_id:
            return level
        known = self._counted
        if known is None or known[0] is not level or known[1].next_id != self._next_id:
            known = self._counted = (level, level.replace(next_id=self._next_id))
        return known[1]

    @property
    def committed(self) -> Level:
        """The snapshot behind `level`: the same object until something changes."""
        return self._history.current.value

    @property
    def shown(self) -> Level:
        """Level on the canvas: the preview of a gesture, or the committed level."""
        return self._preview if self._preview is not None else self._history.current.value

    @property
    def previewing(self) -> bool:
        """True if a preview is on show."""
        return self._preview is not None

    @property
    def history(self) -> History[Level, Selection]:
        """The snapshots; read it, change it only through the document."""
        return self._history

    @property
    def next_id(self) -> int:
        """The id that the next new entity gets."""
        return self._next_id

    @property
    def dirty(self) -> bool:
        """True if there are changes that no file holds; undoing to the saved state is clean."""
        return self._saved is None or not same_content(self._history.current.value, self._saved)

    @property
    def saved(self) -> Level | None:
        """The level as its file has it, or as it was opened; None when no file does."""
        return self._saved

    @property
    def untouched(self) -> bool:
        """True if it can be closed without loss: no file, no change, nothing to undo."""
        return self.path is None and not self.dirty and not self.edited

    @property
    def edited(self) -> bool:
        """True if it was changed since it was opened, whether that was saved or undone or not."""
        return len(self._history.entries) > 1

    @property
    def title(self) -> str:
        """Title of the tab."""
        return self.path.name if self.path else title_of(self.level)

    @property
    def hash(self) -> str:
        """Identity of the committed content."""
        return level_hash(self.level)

    def name_of(self, entity: EntityId) -> str:
        """Return what an entity is called: by its own name, or by kind and id."""
        return describe(self.shown, entity)

    def spoken_name_of(self, entity: EntityId) -> str:
        """Return the same in the language of the app."""
        return spoken(self.shown, entity)

    @property
    def problems(self) -> tuple[Issue, ...]:
        """The issues of the level on show, checked once for each level."""
        if self._issues is None or self._issues[0] is not self.shown:
            self._issues = (self.shown, tuple(validate(self.shown)))
        return self._issues[1]

    @property
    def selection(self) -> Selection:
        """Selected ids; setting them never changes the level and never clears redo."""
        return self._selection

    @selection.setter
    def selection(self, selection: Selection) -> None:
        known = self._known_ids(self.shown)
        self._selection = tuple(dict.fromkeys(i for i in selection if i in known))
        if self._preview is None:
            self._history.select(self._selection)

    @property
    def unlocked(self) -> Selection:
        """Selected ids but those that are locked: what can be moved, turned and deleted."""
        return tuple(each for each in self._selection if each not in self.locked)

    def preview(self, command: Command | None) -> None:
        """Show what a command would do to the *committed* level; None shows the committed level.

        Raises:
            CommandError: The command cannot be done; what was on show stays.
        """
        self._preview = None if command is None else command.apply(self.level)

    def discard_preview(self) -> None:
        """Show the committed level again."""
        self._preview = None

    def commit(self, command: Command, *, time: float = 0.0) -> Outcome:
        """Do a command as one history entry (which may merge with the last).

        Args:
            command: The edit.
            time: Now [s], for merging.

        Returns:
            Whether anything changed, what is new, what else happened.

        Raises:
            CommandError: The command cannot be done; the document is unchanged.
        """
        before = self._history.current.value
        after = command.apply(self.level)
        self._preview = None
        if same_content(after, before):
            return Outcome(changed=False)
        _refuse_unwritable(after, before)
        notices = []
        new = after.solution is not None and after.solution is not before.solution
        if before.solution and not (new or same_simulation(after, before)):
            after = after.replace(solution=None)
            notices.append("The recorded solution was dropped: the level changed.")
        notices += self._mass_notices(before, after)
        known = self._known_ids(before)
        created: Selection = tuple(e.id for e in after.entities() if e.id not in known)
        self._next_id = max(self._next_id, after.next_id)
        self._selection = self._surviving(after)
        entry = Entry(
            label=command.label,
            value=after,
            selection=self._selection,
            merge_key=command.merge_key,
            time=time,
        )
        first = self._history.before(entry)
        if first.solution is not before.solution and same_simulation(after, first):
            # Steps there and back, which are one entry.
            entry = dataclasses.replace(entry, value=after.replace(solution=first.solution))
            notices.append("The recorded solution is back: the level plays as before.")
        if first is not before and same_content(entry.value, first):
            self._history.drop()  # There and back: nothing is left to undo.
            self._history.select(self._selection)
        else:
            self._history.push(entry)
        return Outcome(changed=True, created=created, notices=tuple(notices))

    def undo(self) -> str | None:
        """Take the last entry back; returns its label, or None if there is none."""
        self._preview = None
        label = self._history.undo_label
        self._show(self._history.undo())
        return label

    def redo(self) -> str | None:
        """Do the next entry again; returns its label, or None if there is none."""
        self._preview = None
        label = self._history.redo_label
        self._show(self._history.redo())
        return label

    def jump(self, index: int) -> None:
        """Go to any entry of the history."""
        self._preview = None
        self._show(self._history.jump(index))

    def mark_saved(self, path: Path | None = None, format: Format | None = None) -> None:
        """Remember that the committed level is what the file holds."""
        self._history.seal()
        self._saved = self._history.current.value
        self.saves += 1
        self.path = path or self.path
        self.format = format or self.format

    def mark_unsaved(self) -> None:
        """Remember that no file holds this level (recovered, pasted, or its file is gone)."""
        self._saved = None

    def _show(self, entry: Entry[Level, Selection] | None) -> None:
        if entry is not None:
            self._selection = tuple(each for each in entry.selection if each not in self.hidden)

    def _surviving(self, level: Level) -> Selection:
        known = self._known_ids(level)
        return tuple(i for i in self._selection if i in known)

    @staticmethod
    def _known_ids(level: Level) -> set[EntityId]:
        return {*(entity.id for entity in level.entities()), *ARENA_NAMES}

    @staticmethod
    def _mass_notices(before: Level, after: Level) -> list[str]:
        held = {b.id for b in before.bodies if b.mass_properties is not None}
        lost = [b.id for b in after.bodies if b.id in held and b.mass_properties is None]
        if not lost:
            return []
        return ["Imported mass properties were dropped: mass now follows from shape and density."]
