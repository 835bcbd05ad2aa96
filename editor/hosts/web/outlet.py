"""Messages to the page: pictures as their changed parts, never faster than it draws."""

import json
import struct
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

from editor.hosts.web.regions import Box, Kind, Picture, changes, encoded, kind_for

_UNDER_WAY: Final = 2
"""Most pictures that the page has not yet drawn: one travels while the next is made."""
_REST: Final = 0.2
"""After this time without a change, parts sent with loss are sent again without [s]."""
_HEARTBEAT: Final = 2.0
"""Longest silence [s]: writing is how a page that is gone is noticed."""
_PARTING: Final = 20.0
"""Longest time for sending the last messages at shutdown [s]."""
_DRAWN_WITHIN: Final = 10.0
"""A page in the background draws nothing; after this time the next picture goes out anyway [s]."""


def packet(header: dict[str, Any], *parts: bytes) -> bytes:
    """Return a message: its length, its header's length, both as 4 bytes; header, parts."""
    text = json.dumps(header, separators=(",", ":")).encode()
    body = b"".join((struct.pack(">I", len(text)), text, *parts))
    return struct.pack(">I", len(body)) + body


class Outlet:
    """Pictures and messages on their way to one page. The app puts in, the page's thread takes.

    A picture waits until the page has drawn those before it; a newer one takes its place. So a slow
    page or line gets fewer pictures, never older ones.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        """Make one that nobody looks at.

        Args:
            wake: Wakes the app when a picture is wanted.
        """
        self._wake = wake
        self._changed = threading.Condition()
        self._viewing = 0
        """Number of the connection that takes; 0 where there is none."""
        self._connections = 0
        self._open: set[int] = set()
        """Connections that may still have something to write."""
        self._standing: dict[str, Any] = {}
        """State for a new page: the last value of each message that lasts."""
        self._messages: list[dict[str, Any]] = []
        self._picture: Picture | None = None
        self._shown: Picture | None = None
        """Picture on the page, but for `_rough`."""
        self._rough: list[Box] = []
        """Parts that it shows with loss."""
        self._fresh = False
        """True if the page has not yet got a whole picture."""
        self._sent = self._drawn = 0
        self._sent_at = self._moved_at = 0.0
        """Times of the last message, and of the last change [s]."""

    @property
    def wanted(self) -> bool:
        """True if a picture would go out at once."""
        with self._changed:
            late = time.monotonic() - self._sent_at > _DRAWN_WITHIN
            free = self._sent - self._drawn < _UNDER_WAY or late
            return bool(self._viewing) and self._picture is None and free

    @property
    def fresh(self) -> bool:
        """True if the page needs a picture even though nothing has changed."""
        with self._changed:
            return self._fresh

    def show(self, picture: Picture) -> None:
        """Send a picture; it must not be written to afterwards."""
        with self._changed:
            self._picture, self._fresh = picture, False
            self._changed.notify_all()

    def tell(self, name: str, value: Any, *, lasting: bool = True) -> None:
        """Send a message.

        Args:
            name: What it is about.
            value: Any JSON value.
            lasting: Whether a page that is opened later has to know it.
        """
        with self._changed:
            if lasting:
                if self._standing.get(name) == value:
                    return
                self._standing[name] = value
            if self._viewing:
                self._messages.append({name: value})
                self._changed.notify_all()

    def drawn(self, number: int) -> None:
        """Note that the page has drawn a picture."""
        with self._changed:
            self._drawn = max(self._drawn, min(number, self._sent))
            self._changed.notify_all()
        self._wake()

    def attach(self) -> int:
        """Start over with a page; returns the connection's number for `packets`."""
        with self._changed:
            self._connections += 1
            self._viewing = self._connections
            self._open.add(self._viewing)
            self._messages = [dict(self._standing)] if self._standing else []
            self._picture = self._shown = None
            self._rough, self._fresh = [], True
            self._drawn = self._sent
            self._changed.notify_all()
        self._wake()
        return self._viewing

    def detach(self, connection: int) -> bool:
        """End a connection; returns whether it was the present one."""
        with self._changed:
            self._open.discard(connection)
            present = self._viewing == connection
            if present:
                self._viewing = 0
            self._changed.notify_all()
        return present

    def finish(self) -> None:
        """Send the last messages, then end."""
        with self._changed:
            ends = time.monotonic() + _PARTING
            self._changed.wait_for(lambda: not (self._viewing and self._messages), _PARTING)
            self._viewing = 0
            self._changed.notify_all()
            # A message that is taken is not yet written, and the threads that write end with us.
            self._changed.wait_for(lambda: not self._open, max(0.0, ends - time.monotonic()))

    def packets(self, connection: int) -> Iterator[bytes]:
        """Yield what the page has to get, waiting for it; ends when another page takes over."""
        while True:
            with self._changed:
                if not (self._messages or self._picture is not None):
                    self._changed.wait(self._patience())
                if self._viewing != connection:
                    return
                messages, self._messages = self._messages, []
                if messages:
                    self._changed.notify_all()
                picture, self._picture = self._picture, None
                rested = bool(self._rough) and self._patience() == 0
            for message in messages:
                yield packet(message)
            if picture is not None:
                yield from self._changes_of(picture)
            elif rested:
                yield self._refined()
            elif not messages:
                yield packet({})

    def _patience(self) -> float:
        """Return how long to wait for something to happen [s]."""
        if not self._rough or self._sent - self._drawn >= _UNDER_WAY:
            return _HEARTBEAT
        return max(self._moved_at + _REST - time.monotonic(), 0.0)

    def _changes_of(self, picture: Picture) -> Iterator[bytes]:
        boxes = changes(self._shown, picture)
        if self._shown is None or self._shown.shape != picture.shape:
            self._rough = []
        self._shown = picture
        if boxes:
            self._moved_at = time.monotonic()
            kind = kind_for(boxes)
            if kind == "image/jpeg":
                self._rough = _joined(self._rough, boxes)
            yield self._frame(picture, boxes, kind)
        else:
            self._wake()

    def _refined(self) -> bytes:
        """Send a part of what was sent with loss again, without: large ones band by band."""
        left, top, right, bottom = self._rough[0]
        cut = min(top + 128, bottom)
        rest: list[Box] = [(left, cut, right, bottom)] if cut < bottom else []
        self._rough = [*rest, *self._rough[1:]]
        assert self._shown is not None
        return self._frame(self._shown, [(left, top, right, cut)], "image/png")

    def _frame(self, picture: Picture, boxes: list[Box], kind: Kind) -> bytes:
        parts = [encoded(picture, box, kind) for box in boxes]
        with self._changed:
            self._sent += 1
            self._sent_at = time.monotonic()
            number = self._sent
        height, width = picture.shape[:2]
        regions = [[*box, len(part)] for box, part in zip(boxes, parts, strict=True)]
        header = {"frame": number, "size": [width, height], "kind": kind, "regions": regions}
        return packet(header, *parts)


def _joined(boxes: list[Box], more: list[Box]) -> list[Box]:
    """Return one box around everything: what moved is mostly in one place."""
    every = [*boxes, *more]
    return [
        (
            min(box[0] for box in every),
            min(box[1] for box in every),
            max(box[2] for box in every),
            max(box[3] for box in every),
        )
    ]
