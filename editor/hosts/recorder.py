"""Writes what a person does in the window as a script that `--replay` plays again."""

import itertools
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, TypeAlias

from editor.base import events
from editor.base.controls import PAD_NAMES
from editor.session import Session
from editor.toolkit.keys import IMGUI, MODIFIERS
from kinetix.errors import KinetixError
from kinetix.files.atomic import write_with_backup
from kinetix.files.regular import read_text

_LONGEST: Final = 600
"""Longest pause that is kept [frames]: nobody wants to wait for a coffee again."""
_BUTTONS: Final = (events.LEFT, events.MIDDLE, events.RIGHT)
_COSTS: Final = {
    "move": (0, 2),
    "down": (1, 3),
    "up": (1, 3),
    "wheel": (1, 3),
    "pinch": (0, 2),
    "text": (0, 4),
    "key": (0, 2),
    "pad": (0, 2),
    "drop": (0, 2),
    "focus": (0, 2),
    "quit": (0, 2),
}
"""Of each line: frames that the replay takes before it happens, and frames in all."""
Look: TypeAlias = tuple[tuple[int, int], float]
"""Size of the window [px], and scale of the interface."""
_VERBS: Final = {events.Pointer.PRESS: "down", events.Pointer.RELEASE: "up"}


class Recorder:
    """Takes every frame's events; positions are in window pixels, times in frames of 1/60 s."""

    def __init__(self, session: Session, path: Path) -> None:
        """Begin a script; it opens what is open now.

        Args:
            session: The app.
            path: The script's file.

        Raises:
            KinetixError: The file cannot be written, or exists and is not a script.
        """
        self._session = session
        self._path = path
        self._time = 0.0
        self._last = self._rest = 0
        """Frame of the last event, and how many the script takes from it to the end of its line."""
        self._down: set[str] = set()
        self._look: Look | None = None
        """Size and scale of the last line about the window; None before the first."""
        self._seen: Look = ((0, 0), 0.0)
        self._ended = False
        _make_way(path)
        for tab in session.tabs:
            if tab.document.path is not None:
                self._write({"do": "open", "file": str(tab.document.path)})

    def take(self, batch: Sequence[events.InputEvent], seconds: float, look: Look) -> None:
        """Write what was done in one frame.

        Args:
            batch: What happened since the last frame.
            seconds: Time since the last frame [s].
            look: The window while it happened.
        """
        self._time += seconds
        self._seen = look
        for event, after in itertools.pairwise((*batch, None)):
            # Of moves that follow each other in one frame only the last is ever seen.
            if event is not None and not (_moves(event) and _moves(after)):
                self._event(event)

    def _event(self, event: events.InputEvent) -> None:
        match event:
            case events.TextEvent():
                # Half of a surrogate pair is no text, and no field takes it.
                text = event.text.encode("utf-8", "ignore").decode()
                if text:
                    self._tell({"do": "text", "text": text})
            case events.KeyEvent():
                self._key(event.key, event.pressed)
            case events.FocusEvent(focused=False):
                self._down.clear()
                self._tell({"do": "focus", "focused": False})
            case _:
                line = _line(event)
                if line is not None:
                    self._tell(line)

    def _key(self, key: str, pressed: bool) -> None:
        """A key that goes down or up; repetitions and keys without a name are left out."""
        if pressed == (key in self._down) or (key not in IMGUI and key not in MODIFIERS):
            return
        (self._down.add if pressed else self._down.discard)(key)
        self._tell({"do": "key", "key": key, "pressed": pressed})

    def _tell(self, event: dict[str, Any]) -> None:
        """Write an event after the pause that was before it."""
        if self._look != self._seen:
            # A page says its size only after the start: the first event is soon enough.
            self._look = self._seen
            size, scale = self._look
            self._write({"do": "window", "size": size, "scale": scale})
            self._rest += 1
        lead, cost = _COSTS[event["do"]]
        now = round(self._time / events.FRAME)
        # What is left of the last line, and what this one takes before it happens, pass by anyway.
        pause = min(now - self._last, _LONGEST) - self._rest - lead
        if pause > 0:
            # The line of a pause takes one frame more than it says, as every line does.
            self._write({"do": "wait", "frames": pause - 1})
        self._last, self._rest = now, cost - lead
        self._write(event)

    def _write(self, event: dict[str, Any]) -> None:
        if self._ended:
            return
        # Line by line, so that a crash leaves what led to it.
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(event, ensure_ascii=False) + "\n")
        except OSError as error:
            self._ended = True
            reason = error.strerror or error
            self._session.toast(f"{self._path}: the recording ends: {reason}", "error")


def _line(event: events.InputEvent) -> dict[str, Any] | None:
    """Return the line of an event that neither keys nor text make; None: it means nothing."""
    match event:
        case events.PointerEvent(kind=events.Pointer.MOVE):
            return {"do": "move", "at": event.screen}
        case events.PointerEvent(button=button) if button in _BUTTONS:
            return {"do": _VERBS[event.kind], "at": event.screen, "button": button}
        case events.WheelEvent():
            # Hosts do not say where: it turns where the pointer is.
            return {"do": "wheel", "dy": event.dy, **({"dx": event.dx} if event.dx else {})}
        case events.PinchEvent():
            return {"do": "pinch", "factor": event.factor, "at": event.screen}
        case events.PadEvent() if event.control in PAD_NAMES:
            return {"do": "pad", "control": event.control, "pressed": event.pressed}
        case events.DropEvent():
            return {"do": "drop", "file": event.path}
        case events.QuitEvent():
            return {"do": "quit"}
        case _:
            return None


def _make_way(path: Path) -> None:
    """Begin a file; an earlier script stays as a backup.

    Raises:
        KinetixError: Something else is there, or it cannot be written.
    """
    if os.path.isfile(path):
        lines = filter(str.strip, read_text(path, "script").splitlines())
        if not _is_event(next(lines, '{"do": ""}')):
            raise KinetixError(
                f"{path}: exists and is not a recorded script; choose another file name"
            )
    write_with_backup(path, b"", keep_all=True)


def _is_event(line: str) -> bool:
    try:
        event = json.loads(line)
    except ValueError:
        return False
    return isinstance(event, dict) and "do" in event


def _moves(event: events.InputEvent | None) -> bool:
    return isinstance(event, events.PointerEvent) and event.kind is events.Pointer.MOVE
