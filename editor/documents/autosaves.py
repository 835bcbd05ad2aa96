"""Copies of unsaved levels: written soon after a change, kept until the level is saved or given up.

Every run has a folder of its own below the user's state folder, named at random, because process
ids repeat. A lock in it tells whether the run still goes on. What a run that has ended left there
is offered to the next one.
"""

import contextlib
import datetime
import json
import os
import secrets
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Final

from editor.documents.document import Document, Stamp, same_content
from editor.documents.run_lock import RunLock, goes_on
from kinetix.errors import KinetixError, LevelError
from kinetix.files.atomic import write_atomically
from kinetix.files.json_text import parse
from kinetix.files.regular import FileError, read_text
from kinetix.level.codec import dumps
from kinetix.level.sizes import without_outgrown_size
from kinetix.paths import state_dir

PAUSE: Final = 2.0
"""A change is copied after so much quiet [s]."""
LONGEST: Final = 5.0
"""While changes go on without a pause a copy is made this often [s]."""
_OPEN: Final = "open.json"
"""In the folder of a run: the files that it has open."""


def autosave_dir() -> Path:
    """Return the folder of all copies."""
    return state_dir() / "autosave"


class _Watched:
    """A document and how far its copy is."""

    def __init__(self, document: Document, file: Path) -> None:
        self.document = document
        self.file = file
        self.seen = document.committed
        """The level in the last frame."""
        self.saves = document.saves
        self.first = self.last = 0.0
        """Times of the first and the last change that is not copied yet [s]."""
        self.wanted: bytes | None = None
        """Bytes that the thread is to write."""
        self.gone = False
        """True if the thread is to remove the copy."""
        self.on_disk = False
        """True once the thread has written a copy that it has not removed."""


class Autosaves:
    """The copies of one run. A thread writes, so that no frame waits for a disk."""

    def __init__(
        self,
        folder: Path | None = None,
        *,
        stored: bool = True,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare; nothing is written before there is something to keep.

        Args:
            folder: Where runs have their folders; by default in the user's state folder.
            stored: Whether to write at all; scripted runs leave no traces.
            clock: Time [s].
        """
        self._base = folder
        self._stored = stored
        self._clock = clock
        self._name = secrets.token_hex(8)
        self._lock: RunLock | None = None
        self._watched: dict[int, _Watched] = {}
        self._open: tuple[str, ...] = ()
        self._refused: tuple[tuple[str, ...], float] = (), 0.0
        """Open files that could not be listed, and when they are tried again."""
        self._wake = threading.Condition()
        self._thread: threading.Thread | None = None
        self._busy = self._ended = False
        self._locking = threading.Lock()
        self._failed: list[tuple[_Watched, str]] = []
        """Copies that could not be written, or are gone, with the reason; empty: not reported."""

    @property
    def folder(self) -> Path:
        """The run's own folder."""
        return (self._base or autosave_dir()) / self._name

    @property
    def pending(self) -> bool:
        """True if a change waits to be copied."""
        return any(watched.first for watched in self._watched.values())

    def kept_at(self, document: Document) -> datetime.datetime | None:
        """Return when the changes of a document were copied; None where no copy is on the disk."""
        watched = self._watched.get(document.number)
        return document.autosaved_at if watched is not None and watched.on_disk else None

    def follow(self, documents: Iterable[Document]) -> None:
        """Look for changes; call it in every frame.

        Args:
            documents: All that are open.

        Raises:
            KinetixError: The last copy could not be written.
        """
        if not self._stored:
            return
        now = self._clock()
        followed = tuple(documents)
        for document in followed:
            if document.number in self._watched or document.dirty:
                self._look(self._watch(document), now)
        self._complain()
        self._drop_closed({document.number for document in followed})

    def _drop_closed(self, followed: set[int]) -> None:
        """Let go of documents that are not open any more, once the thread has done with them."""
        for number in self._watched.keys() - followed:
            document = self._watched[number].document
            if document.passing and document.autosaved_at is not None:
                self._remove(self._watched[number], with_origin=True)
        with self._wake:
            for number in self._watched.keys() - followed:
                watched = self._watched[number]
                if not watched.gone and watched.wanted is None:
                    del self._watched[number]

    def _complain(self) -> None:
        reason = ""
        while self._failed:
            watched, told = self._failed.pop()
            reason = told or reason
            watched.document.autosaved_at = None  # so that it is tried again
        if reason:
            raise KinetixError(f"No copy of unsaved changes could be kept. {reason}")

    def _watch(self, document: Document) -> _Watched:
        known = self._watched.get(document.number)
        if known is None:
            known = _Watched(document, self.folder / f"{document.number}.json")
            self._watched[document.number] = known
        return known

    def _look(self, watched: _Watched, now: float) -> None:
        document = watched.document
        if document.saves != watched.saves:
            watched.saves = document.saves
            self._remove(watched, with_origin=True)
        level = document.committed
        if not document.dirty:
            watched.first, watched.seen = 0.0, level
            if document.autosaved_at is not None:
                self._remove(watched, with_origin=False)
            return
        nowhere = document.autosaved_at is None and not watched.first
        if nowhere or level is not watched.seen:
            watched.seen, watched.last = level, now
            watched.first = watched.first or now
        if watched.first and (now - watched.last >= PAUSE or now - watched.first >= LONGEST):
            self.keep(document)

    def keep(self, document: Document) -> None:
        """Copy a document now where it has changes that no copy holds."""
        if not (self._stored and document.dirty):
            return
        level, watched = document.level, self._watch(document)
        watched.first, watched.seen = 0.0, document.committed
        if document.autosaved_at is not None and same_content(level, document.autosaved):
            return
        now = datetime.datetime.now().astimezone()
        document.autosaved, document.autosaved_at = level, now
        stamp = document.stamp
        record = {
            "path": str(document.path.resolve()) if document.path else None,
            "format": document.format,
            "time": now.astimezone(datetime.UTC).isoformat(),
            "base": stamp.digest if isinstance(stamp, Stamp) else None,
            "origin": [str(file) for file in document.origin],
            "level": dumps(without_outgrown_size(level)),
        }
        with self._wake:
            watched.wanted, watched.gone = json.dumps(record).encode(), False
            self._start()
            self._wake.notify_all()

    def forget(self, document: Document) -> None:
        """Remove the copy of a document that the user has given up, and what it was made from."""
        document.given_up = document.committed
        if self._stored:
            self._remove(self._watch(document), with_origin=True)

    def _remove(self, watched: _Watched, *, with_origin: bool) -> None:
        document = watched.document
        document.autosaved, document.autosaved_at = document.level, None
        watched.first = 0.0
        if with_origin:
            discard_all(document.origin)
            document.origin = ()
        with self._wake:
            watched.wanted, watched.gone = None, True
            self._start()
            self._wake.notify_all()

    def flush(self) -> None:
        """Wait until everything is on the disk.

        Raises:
            KinetixError: A copy could not be written.
        """
        with self._wake:
            while self._thread is not None and (self._busy or self._due()):
                self._wake.wait()
        self._complain()

    def open_files(self, files: Iterable[Path]) -> None:
        """Tell other runs which files this one has open.

        Raises:
            LevelError: The list cannot be written; it is tried again later, silently.
        """
        names = tuple(sorted(str(file.resolve()) for file in files))
        refused, until = self._refused
        again = names == refused
        if not self._stored or names == self._open or (again and self._clock() < until):
            return
        self._refused = names, self._clock() + LONGEST
        with contextlib.suppress(LevelError) if again else contextlib.nullcontext():
            self._begin()
            write_atomically(self.folder / _OPEN, json.dumps(names).encode())
            self._open, self._refused = names, ((), 0.0)

    def open_elsewhere(self, file: Path) -> bool:
        """Return whether a run that goes on, other than this one, has a file open."""
        name = str(file.resolve())
        return self._stored and any(
            name in _open_in(run)
            for run in _runs(self._base)
            if run != self.folder and goes_on(run)
        )

    def end(self) -> None:
        """Let go of everything; copies of what was neither saved nor given up stay."""
        with self._wake:
            self._ended = True
            self._wake.notify_all()
        if self._thread is not None:
            self._thread.join(5.0)
        if self._lock is not None:
            self._lock.release()
            (self.folder / _OPEN).unlink(missing_ok=True)
            _tidy(self.folder)

    def _due(self) -> list[_Watched]:
        return [each for each in self._watched.values() if each.gone or each.wanted is not None]

    def _start(self) -> None:
        if self._thread is None:
            self._thread = threading.Thread(target=self._write_all, name="autosave", daemon=True)
            self._thread.start()

    def _write_all(self) -> None:
        # A call for each time: what was written is not held while nothing is to be written.
        while self._write_due():
            pass

    def _write_due(self) -> bool:
        """Wait until something is to be written and write it; return False after the end."""
        with self._wake:
            self._busy = False
            self._wake.notify_all()
            while not (due := self._due()) and not self._ended:
                self._wake.wait()
            if not due:
                return False
            self._busy = True
            work = [(each, each.wanted) for each in due]
            for each in due:
                each.wanted, each.gone = None, False
        for watched, content in work:
            try:
                self._write(watched.file, content)
                watched.on_disk = content is not None
            except (OSError, KinetixError) as error:
                self._failed.append((watched, str(error)))
        return True

    def _write(self, file: Path, content: bytes | None) -> None:
        if content is None:
            file.unlink(missing_ok=True)
            return
        self._begin()
        write_atomically(file, content)

    def _begin(self) -> None:
        """Make the folder of the run and lock it, again where somebody has removed it.

        Raises:
            LevelError: The folder cannot be made.
        """
        with self._locking:
            if self._lock is not None:
                if self._lock.stands:
                    return
                self._lock.release()
                self._lock = None
                self._write_again()
            for _ in range(3):
                try:
                    self.folder.mkdir(parents=True, exist_ok=True)
                    self._lock = RunLock(self.folder)
                    return
                except FileNotFoundError:
                    # A run that looked at it before it was locked has tidied it up.
                    continue
                except OSError as error:
                    reason = error.strerror or str(error)
                    raise LevelError(f"{self.folder}: cannot be made: {reason}") from error
            raise LevelError(f"{self.folder}: cannot be made: it is removed again and again")

    def _write_again(self) -> None:
        """Have what was on the disk written once more."""
        self._open = ()
        with self._wake:
            gone = [each for each in self._watched.values() if each.on_disk]
        for each in gone:
            each.on_disk = False
            self._failed.append((each, ""))


def _runs(base: Path | None = None) -> list[Path]:
    """Return the folders of all runs."""
    try:
        return sorted(path for path in (base or autosave_dir()).iterdir() if os.path.isdir(path))
    except OSError:
        return []


def _open_in(run: Path) -> list[str]:
    try:
        names = parse(read_text(run / _OPEN, "kept"), run / _OPEN)
    except FileError:
        return []
    return names if isinstance(names, list) else []


def _tidy(run: Path) -> None:
    """Remove the folder of a run that has ended and left nothing."""
    if any(run.glob("*[0-9].json")):
        return
    for file in (*run.glob(".*.tmp"), run / _OPEN):
        file.unlink(missing_ok=True)
    RunLock.remove(run)
    try:
        run.rmdir()
    except OSError:
        return


def discard(file: Path) -> None:
    """Remove a copy, and its run's folder when nothing else is in it."""
    file.unlink(missing_ok=True)
    if file.parent.parent.name == autosave_dir().name and not goes_on(file.parent):
        _tidy(file.parent)


def discard_all(files: Sequence[Path]) -> None:
    """Remove copies that were made one from another, the newest first in `files`.

    The oldest goes first: a run that is killed in between leaves the newest, never a level that
    newer ones have replaced.
    """
    for file in reversed(files):
        discard(file)


def left_behind(base: Path | None = None) -> list[Path]:
    """Return the copies that runs which have ended left behind.

    Among them those of version 0.1.0, which lie in the folder itself and are named by process ids.
    """
    folder = base or autosave_dir()
    found = sorted(folder.glob("*-*.json")) if os.path.isdir(folder) else []
    for run in _runs(base):
        if goes_on(run):
            continue
        copies = sorted(run.glob("*[0-9].json"))
        if not copies:
            _tidy(run)
        found += copies
    return found


def being_kept(base: Path | None = None) -> list[Path]:
    """Return the copies of runs that go on."""
    return [file for run in _runs(base) if goes_on(run) for file in run.glob("*[0-9].json")]
