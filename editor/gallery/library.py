"""All levels of some folders, with their thumbnails: read by a thread of its own, without JAX.

What was read once is kept: cards in one index file, thumbnails as PNG files named by the level's
hash, both in the user's cache folder. The window asks, goes on drawing and takes what has come.
"""

import collections
import contextlib
import os
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, Literal

import msgspec
import numpy as np
from jaxtyping import UInt8
from PIL import Image

from editor.gallery.card import Card, fault_card, read_card
from editor.gallery.thumbnail import SIDE, draw_thumbnail
from editor.gallery.walk import Walk
from kinetix.errors import LevelError
from kinetix.failures import crash_sentence, write_report
from kinetix.files.atomic import write_atomically
from kinetix.files.regular import FileError, open_regular, read_bytes
from kinetix.level.codec import load_level
from kinetix.level.sets import is_set_file
from kinetix.paths import cache_dir

Thumbnail = UInt8[np.ndarray, "h w 3"]

INDEX_VERSION: Final = 2
"""Increases when cards or thumbnails are made in another way: older ones are rebuilt."""
_PICTURES: Final = 320
"""Thumbnails kept in memory."""
_BREATH: Final = 0.002
"""Pause after each file that was read, so that the window gets the processor [s]."""
_PUBLISH_SECONDS: Final = 0.3
"""Interval at which new cards are handed over while folders are read [s]."""


class _Known(msgspec.Struct, frozen=True, kw_only=True):
    """Entry of a file in the index: a level, a level set, or something else."""

    kind: Literal["level", "set", "other"]
    card: Card


class _Index(msgspec.Struct, frozen=True, kw_only=True):
    version: int
    files: list[_Known]


class Library:
    """Cards and thumbnails; every method is for the window's thread and returns at once."""

    def __init__(self, cache: Path | None = None) -> None:
        self._cache = cache
        self._condition = threading.Condition(threading.RLock())
        self._thread: threading.Thread | None = None
        self._stopping = False
        self._folders: tuple[Path, ...] | None = None
        self._wanted: tuple[Card, ...] = ()
        self._asked = self._ended = 0
        self._found: tuple[tuple[Card, ...], tuple[Path, ...], str] | None = None
        self._pictures: collections.OrderedDict[str, Thumbnail] = collections.OrderedDict()
        self._known: dict[str, _Known] | None = None
        self._listed: tuple[Card, ...] = ()
        self._by_path: dict[str, Card] = {}
        """The cards of `_listed`, which were asked for by path last."""
        self._unsaved = False
        """True if files were read that the index on the disk does not have."""
        self.cards: tuple[Card, ...] = ()
        """The levels found so far, in the order of folders and paths."""
        self.sets: tuple[Path, ...] = ()
        """The level sets found."""
        self.passed_over = ""
        """One sentence about what the last look did not read; empty where it read everything."""
        self.revision = 0
        """Rises whenever `cards` changes."""

    @property
    def busy(self) -> bool:
        """True if a look goes on, or its end has not been taken."""
        with self._condition:
            return self._ended < self._asked or self._found is not None

    def look(self, folders: Sequence[Path]) -> None:
        """Look through folders (and below them); `poll` takes what is found."""
        with self._condition:
            self._folders = tuple(folders)
            self._asked += 1
            self._start()
            self._condition.notify()

    def card(self, path: str) -> Card | None:
        """Return the card of a file, or None where none was found."""
        if self._listed is not self.cards:
            self._listed, self._by_path = self.cards, {card.path: card for card in self.cards}
        return self._by_path.get(path)

    def want(self, cards: Sequence[Card]) -> None:
        """Set which thumbnails are on the screen: they are made next, others no more."""
        with self._condition:
            self._wanted = tuple(c for c in cards if c.sha256 and c.sha256 not in self._pictures)
            if self._wanted:
                self._start()
                self._condition.notify()

    def picture(self, sha256: str) -> Thumbnail | None:
        """The thumbnail of a level: uint8[side, side, 3], or None when it is not there yet."""
        with self._condition:
            found = self._pictures.get(sha256)
            if found is not None:
                self._pictures.move_to_end(sha256)
            return found

    def poll(self) -> bool:
        """Take what was found since the last call; whether the cards changed."""
        with self._condition:
            found, self._found = self._found, None
            if found is None:
                return False
            cards, self.sets, self.passed_over = found
        if cards == self.cards:
            return False
        self.cards = cards
        self.revision += 1
        return True

    def wait(self, seconds: float) -> bool:
        """Block until a look is over and taken thumbnails are made (tests, scripts)."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.poll()
            with self._condition:
                if not self.busy and not self._wanted:
                    return True
            time.sleep(0.005)
        return False

    def stop(self, seconds: float = 2.0) -> None:
        """End the thread."""
        with self._condition:
            self._stopping = True
            self._condition.notify()
        if self._thread is not None:
            self._thread.join(seconds)

    def _start(self) -> None:
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="library", daemon=True)
            self._thread.start()

    @property
    def folder(self) -> Path:
        """Folder of index and thumbnails."""
        return (self._cache or cache_dir()) / "gallery"

    def _work(self) -> None:
        look: Iterator[None] | None = None
        while True:
            with self._condition:
                self._condition.wait_for(
                    lambda: self._stopping or self._folders is not None or self._wanted,
                    None if look is None else 0,
                )
                if self._stopping:
                    return
                if self._folders is not None:
                    look, self._folders = self._look(self._folders, self._asked), None
                wanted = self._wanted[:1]
            if wanted:
                self._make(wanted[0])
            elif look is not None and self._looked(look):
                look = None

    def _looked(self, look: Iterator[None]) -> bool:
        """Read one more file; return whether that was the last."""
        try:
            return next(look, _OVER) is _OVER
        except Exception as error:  # a fault of ours must not end the thread
            write_report(error, ["gallery"])
            with self._condition:
                self._ended = self._asked if self._folders is None else self._ended
            return True

    def _make(self, card: Card) -> None:
        """Fetch or draw one thumbnail."""
        picture = self._stored(card.sha256)
        if picture is None:
            # A level that has gone or broken since keeps an empty picture until the next look.
            picture = np.full((SIDE, SIDE, 3), 255, np.uint8)
            with contextlib.suppress(Exception):
                picture = draw_thumbnail(load_level(card.file.resolve()))
                self._store(card.sha256, picture)
        self._keep(card.sha256, picture)

    def _keep(self, sha256: str, picture: Thumbnail) -> None:
        with self._condition:
            self._pictures[sha256] = picture
            self._wanted = tuple(card for card in self._wanted if card.sha256 != sha256)
            while len(self._pictures) > _PICTURES:
                self._pictures.popitem(last=False)

    def _file(self, sha256: str) -> Path:
        return self.folder / f"thumbnails-{INDEX_VERSION}" / f"{sha256[:40]}.png"

    def _stored(self, sha256: str) -> Thumbnail | None:
        try:
            with Image.open(self._file(sha256)) as image:
                picture = np.asarray(image.convert("RGB"))
        except Exception:  # whatever Pillow raises for a damaged file, it is drawn again
            return None
        return picture if picture.shape == (SIDE, SIDE, 3) else None

    def _store(self, sha256: str, picture: Thumbnail) -> None:
        file = self._file(sha256)
        # Without a cache every run redraws; that is no reason to fail.
        with contextlib.suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True)
            temporary = file.with_suffix(".tmp")
            Image.fromarray(picture).save(temporary, format="PNG")
            os.replace(temporary, file)

    def _look(self, folders: tuple[Path, ...], number: int) -> Iterator[None]:
        """Go through the folders, one file a step; ends what was asked up to `number`."""
        known = self._index()
        seen: dict[str, _Known] = {}
        published = time.monotonic()
        walk = Walk(folders)
        for path, modified_ns, size in walk.files():
            name = str(path)
            if name in seen:
                continue
            old = known.get(name)
            if old is not None and (old.card.modified_ns, old.card.bytes) == (modified_ns, size):
                seen[name] = old
                continue
            made = self._read(path)
            if made is None:
                continue
            # Another look may take the place of this one: it need not read the file again.
            seen[name] = known[name] = made
            self._unsaved = True
            if time.monotonic() - published > _PUBLISH_SECONDS:
                self._publish(seen, walk)
                published = time.monotonic()
            yield
            time.sleep(_BREATH)
        self._publish(seen, walk, ended=number)
        others = {
            name: one
            for name, one in known.items()
            if name not in seen and not any(Path(name).is_relative_to(f) for f in folders)
        }
        self._known = others | seen
        if self._unsaved or len(known) != len(self._known):
            self._save_index()
            self._unsaved = False

    def _read(self, path: Path) -> _Known | None:
        try:
            if is_set_file(path):
                status = path.stat()
                card = Card(
                    path=str(path),
                    modified_ns=status.st_mtime_ns,
                    bytes=status.st_size,
                    name=path.stem,
                )
                return _Known(kind="set", card=card)
            card, level = read_card(path)
            if level is not None and not os.path.isfile(self._file(card.sha256)):
                self._store(card.sha256, draw_thumbnail(level))
        except OSError:
            return None
        except Exception as error:  # a fault of ours in one file must not hide the others
            return self._faulty(path, crash_sentence(error, "gallery", []))
        if level is None:
            return _Known(kind="level" if _claims_to_be_a_level(path) else "other", card=card)
        return _Known(kind="level", card=card)

    def _faulty(self, path: Path, fault: str) -> _Known | None:
        with contextlib.suppress(OSError):
            return _Known(kind="level", card=fault_card(path, fault))
        return None

    def _publish(self, seen: dict[str, _Known], walk: Walk, *, ended: int = 0) -> None:
        cards = tuple(one.card for one in seen.values() if one.kind == "level")
        sets = tuple(Path(one.card.path) for one in seen.values() if one.kind == "set")
        with self._condition:
            self._found = (cards, sets, walk.passed_over)
            self._ended = max(self._ended, ended)

    def _index(self) -> dict[str, _Known]:
        if self._known is None:
            self._known = {}
            with contextlib.suppress(FileError, msgspec.DecodeError, ValueError, RecursionError):
                text = read_bytes(self.folder / "index.json", "kept")
                index = msgspec.json.decode(text, type=_Index)
                if index.version == INDEX_VERSION:
                    self._known = {one.card.path: one for one in index.files}
        return self._known

    def _save_index(self) -> None:
        index = _Index(version=INDEX_VERSION, files=list((self._known or {}).values()))
        with contextlib.suppress(OSError, LevelError):
            self.folder.mkdir(parents=True, exist_ok=True)
            write_atomically(self.folder / "index.json", msgspec.json.encode(index))


_OVER: Final = object()


def _claims_to_be_a_level(path: Path) -> bool:
    """Return whether a broken file was meant to be a level: only such are worth showing.

    One that has become empty, or all zeros as after a full disk or a crash, may have been one.
    """
    try:
        with open_regular(path, "set") as file:
            head = file.read(4096)
    except (FileError, OSError):
        return False
    empty = not head.strip(b"\0\t\r\n ")
    return empty or b'"kinetix-level"' in head or b'"env_state"' in head
