"""Scripted runs: EVENTS.jsonl through the same adapter, tools and commands as real input.

The format stands in docs/replay.md. Every frame is 1/60 s on a fixed clock, and each frame waits
for the simulation steps that the one before asked for, so that a script gives the same result on
any machine.
"""

import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from editor import actions
from editor.actions.files import address
from editor.actions.watching import agents
from editor.agents.viewer import SLOTS
from editor.base import events
from editor.base.events import FRAME
from editor.base.settings import SCALES
from editor.documents import files
from editor.documents.commands.fields import SetField
from editor.documents.document import Format
from editor.editing.tools import TOOLS
from editor.hosts import event_fields as fields
from editor.hosts.base import Host
from editor.hosts.conditions import CONDITIONS, PLAYED
from editor.hosts.event_fields import Event
from editor.hosts.film import Film
from editor.hosts.offscreen import OffscreenHost
from editor.toolkit.keys import MODIFIERS
from editor.toolkit.widgets import Probe
from kinetix.errors import KinetixError
from kinetix.files.json_text import parse_strictly
from kinetix.files.regular import FileError, read_text

_DRAG_FRAMES: Final = 10
"""A drag moves in so many steps, so that tools see the way and not only its end."""
_SETTLE_FRAMES: Final = 10
"""Before the first line: panels are brought to the front one a frame, and take the keyboard."""
_LOAD_SECONDS: Final = 120.0
"""Longest wait for an agent [s]; the first one waits for JAX to be imported."""
_STEP_SECONDS: Final = 30.0
"""Longest wait for simulation steps that are under way [s]."""
_SCALE_DIGITS: Final = 1e-5
"""Relative difference of scales that count as one: a message tells six digits."""


class ReplayError(KinetixError):
    """An event cannot be applied; the message has the file and the line number."""


class Replayer:
    """Feeds one script to a host."""

    def __init__(self, host: Host, script: Path) -> None:
        self._host = host
        self._session = host.session
        self._script = script
        self._at = (0.0, 0.0)
        self._mods: tuple[str, ...] = ()
        self._buttons: set[int] = set()
        self._film: Film | None = None
        self._looked = False
        """True after the first line that opens no file: a line about the window resizes it then."""
        self._verbs: dict[str, Callable[[Event], None]] = {
            "window": self._window,
            "open": self._open,
            "save": self._save,
            "agent": self._agent,
            "action": self._action,
            "tool": self._tool,
            "move": self._move,
            "down": self._down,
            "up": self._up,
            "drag": self._drag,
            "wheel": self._wheel,
            "pinch": self._pinch,
            "key": self._press,
            "hold": self._hold,
            "text": self._text,
            "pad": self._pad,
            "drop": self._drop,
            "focus": self._focus,
            "quit": lambda _: self._step(events.QuitEvent()),
            "set": self._set,
            "wait": self._wait,
            "wait_until": self._wait_until,
            "screenshot": self._screenshot,
            "state": self._state,
            "film": self._filming,
        }

    def run(self) -> None:
        """Apply every event in order.

        Raises:
            ReplayError: The script cannot be read, or an event cannot be applied.
        """
        try:
            lines = read_text(self._script, "script").splitlines()
        except FileError as error:
            raise ReplayError(str(error)) from error
        self._frames(_SETTLE_FRAMES)
        for number, line in enumerate(lines, start=1):
            if not line.strip():
                continue
            try:
                self._apply(line)
            except KinetixError as error:
                raise ReplayError(f"{self._script}:{number}: {error}") from error
        self._frames(_SETTLE_FRAMES)
        self._finish_film()

    def _apply(self, line: str) -> None:
        try:
            event = parse_strictly(line, "event")
        except FileError as error:
            raise KinetixError(error.reason) from error
        if not isinstance(event, dict) or "do" not in event:
            raise KinetixError('expected an object with the key "do"')
        if not isinstance(event["do"], str) or event["do"] not in self._verbs:
            known = ", ".join(self._verbs)
            raise KinetixError(f"unknown event {event['do']!r}; there are {known}")
        try:
            self._verbs[event["do"]](event)
        except KeyError as error:
            raise KinetixError(f"{event['do']}: the key {error} is missing") from error
        except (TypeError, ValueError) as error:
            raise KinetixError(f"{event['do']}: {error}") from error
        except OSError as error:
            reason = f"{error.filename}: {error.strerror}" if error.filename else str(error)
            raise KinetixError(f"{event['do']}: {reason}") from error
        self._looked |= event["do"] != "open"
        self._frames(1)

    def _step(self, *batch: events.InputEvent) -> None:
        self._await_steps()
        self._host.step(batch, FRAME)
        if self._film is not None and isinstance(self._host, OffscreenHost):
            self._film.frame(self._host.screenshot)

    def _frames(self, count: int) -> None:
        for _ in range(count):
            self._step()

    def _await_steps(self) -> None:
        session, worker = self._session, self._session.worker
        simulators = (session.playback.simulator, session.viewer.rival.simulator)
        until = time.monotonic() + _STEP_SECONDS
        while (
            session.playback.active
            and any(simulator.outstanding for simulator in simulators)
            and time.monotonic() < until
        ):
            worker.wait(0.5)
            worker.poll()

    def _window(self, event: Event) -> None:
        """Take the size and the scale that the window got; what a script begins with must be so."""
        size, scale = fields.size(event), float(event["scale"])
        alike = math.isclose(scale, self._host.ui.scale, rel_tol=_SCALE_DIGITS)
        if not self._looked and not (alike and size == self._host.size):
            raise KinetixError(
                f"recorded in another window: give --size {size[0]}x{size[1]} --scale {scale:g}"
            )
        if size != self._host.size and not self._host.resize(size):
            raise KinetixError("the window was resized here; use --offscreen")
        low, high = SCALES
        if not low <= scale <= high:
            raise KinetixError(f"scale is {scale:g}: expected {low:g} to {high:g}")
        if not alike:
            self._host.ui.take_scale(scale)

    def _open(self, event: Event) -> None:
        mark = self._session.log.serial
        if not address.open_any(self._session, event["file"]):
            raise KinetixError(" ".join(self._session.log.since(mark)) or "cannot be opened")
        self._frames(2)
        self._await_loading()

    def _await_loading(self) -> None:
        """Wait for what comes from an address, and for agents."""
        fetches, places = self._session.fetches, self._session.viewer.slots.values()
        until = time.monotonic() + _LOAD_SECONDS
        while fetches.waiting or any(place.loading for place in places):
            if time.monotonic() > until:
                break
            time.sleep(0.02)
            self._step()

    def _save(self, event: Event) -> None:
        document = self._session.document
        format: Format = event.get("format", document.format)
        if format not in ("kinetix-level", "kinetix-env"):
            raise KinetixError(f"unknown format {format!r}: kinetix-level or kinetix-env")
        path = Path(event["file"])
        path.parent.mkdir(parents=True, exist_ok=True)
        files.save_document(document, path, format)

    def _agent(self, event: Event) -> None:
        """Load an agent and wait until it is there."""
        session = self._session
        slot = event.get("slot", "a")
        if slot not in SLOTS:
            raise KinetixError(f"unknown slot {slot!r}; there are {', '.join(SLOTS)}")
        agents.load_agent(session, event["dir"], slot)
        place = session.viewer.slots[slot]
        self._await_loading()
        if place.error or place.loading:
            raise KinetixError(place.error or f"not loaded after {_LOAD_SECONDS:g} s")

    def _action(self, event: Event) -> None:
        if not actions.run(self._session, event["id"]):
            raise KinetixError(f"the action {event['id']!r} is disabled now")

    def _tool(self, event: Event) -> None:
        if event["id"] not in TOOLS:
            raise KinetixError(f"unknown tool {event['id']!r}; there are {', '.join(TOOLS)}")
        if not self._session.editing:
            raise KinetixError("tools work in Edit only")
        self._session.choose_tool(event["id"])

    def _place(self, event: Event) -> tuple[float, float]:
        """Return the position of an event [px]; by default where the pointer was."""
        if "world" in event:
            return self._session.camera.to_screen(fields.point(event, "world"))
        if "widget" in event:
            found = self._session.probe.get(event["widget"])
            if not isinstance(found, Probe):
                raise KinetixError(f"no widget {event['widget']!r} is on the screen")
            return found.centre
        return fields.point(event, "at") if "at" in event else self._at

    def _hold_mods(self, event: Event) -> None:
        """Press and release modifier keys so that exactly the event's are down."""
        if "mods" not in event and self._buttons:
            return
        wanted = tuple(event.get("mods", ()))
        unknown = set(wanted) - {"ctrl", "shift", "alt", "meta"}
        if unknown:
            raise KinetixError(f"unknown modifiers {', '.join(sorted(unknown))}")
        batch = [_key(f"left {name}", False) for name in self._mods if name not in wanted]
        batch += [_key(f"left {name}", True) for name in wanted if name not in self._mods]
        self._mods = wanted
        if batch:
            self._step(*batch)

    def _pointer(self, kind: events.Pointer, button: int) -> None:
        self._step(events.PointerEvent(kind=kind, world=(0.0, 0.0), screen=self._at, button=button))

    def _move_to(self, place: tuple[float, float]) -> None:
        self._at = place
        self._pointer(events.Pointer.MOVE, 0)

    def _move(self, event: Event) -> None:
        self._hold_mods(event)
        self._move_to(self._place(event))

    def _down(self, event: Event) -> None:
        self._hold_mods(event)
        self._move_to(self._place(event))
        button = fields.button(event)
        self._pointer(events.Pointer.PRESS, button)
        self._buttons.add(button)

    def _up(self, event: Event) -> None:
        self._hold_mods(event)
        self._move_to(self._place(event))
        button = fields.button(event)
        self._pointer(events.Pointer.RELEASE, button)
        self._buttons.discard(button)
        if not self._buttons:
            self._hold_mods({})

    def _drag(self, event: Event) -> None:
        keys = {name: event[name] for name in ("button", "mods") if name in event}
        to_screen = self._session.camera.to_screen
        ax, ay = to_screen(fields.point(event, "from"))
        bx, by = to_screen(fields.point(event, "to"))
        self._down({"at": (ax, ay), **keys})
        for k in range(1, _DRAG_FRAMES + 1):
            share = k / _DRAG_FRAMES
            self._move_to((ax + (bx - ax) * share, ay + (by - ay) * share))
        self._up({"at": (bx, by), **keys})

    def _wheel(self, event: Event) -> None:
        self._move_to(self._place(event))
        dy, dx = float(event["dy"]), float(event.get("dx", 0.0))
        self._step(events.WheelEvent(dy=dy, dx=dx, screen=self._at))

    def _pinch(self, event: Event) -> None:
        self._step(events.PinchEvent(factor=fields.factor(event), screen=self._place(event)))

    def _press(self, event: Event) -> None:
        if "pressed" in event:
            self._step(_key(fields.known_key(event["key"], MODIFIERS), bool(event["pressed"])))
            return
        self._hold_mods(event)
        name = fields.known_key(event["key"])
        self._step(_key(name, True))
        self._step(_key(name, False))
        self._hold_mods({})

    def _hold(self, event: Event) -> None:
        count = fields.count(event)
        self._hold_mods(event)
        name = fields.known_key(event["key"])
        self._step(_key(name, True))
        self._frames(max(count - 1, 0))
        self._step(_key(name, False))
        self._hold_mods({})

    def _text(self, event: Event) -> None:
        self._step(events.TextEvent(text=str(event["text"])))
        self._frames(2)

    def _pad(self, event: Event) -> None:
        self._step(events.PadEvent(control=fields.control(event), pressed=bool(event["pressed"])))

    def _drop(self, event: Event) -> None:
        self._step(events.DropEvent(path=str(event["file"])))
        self._await_loading()

    def _focus(self, event: Event) -> None:
        self._step(events.FocusEvent(focused=bool(event["focused"])))
        self._buttons.clear()

    def _set(self, event: Event) -> None:
        session = self._session
        if not session.editing:
            raise KinetixError("only Edit changes the level")
        if not session.selection:
            raise KinetixError("nothing is selected")
        command = SetField(ids=session.selection, field=event["field"], value=event["value"])
        session.document.commit(command, time=session.time)

    def _wait(self, event: Event) -> None:
        self._frames(fields.count(event))

    def _wait_until(self, event: Event) -> None:
        what, session = event["what"], self._session
        if what not in CONDITIONS:
            raise KinetixError(f"unknown condition {what!r}; there are {', '.join(CONDITIONS)}")
        seconds = float(event.get("seconds", 60))
        if not seconds >= 0:
            raise KinetixError(f"seconds is {seconds:g}: expected 0 or more")
        began = time.monotonic()
        until = began + seconds
        while not CONDITIONS[what](session):
            coming = session.expected is not None
            if what in PLAYED and session.editing and not coming:
                reason = session.playback.failure or "nothing is played: the app is in Edit"
                raise KinetixError(f"{what} cannot come: {reason}")
            if time.monotonic() > until:
                raise KinetixError(f"not {what} after {seconds:g} s")
            self._step()
            # The clock is fixed but those who work have another: let them have the processor, and
            # the longer the wait is, the more of it; an episode ends by what is stepped here.
            waited = 0.0 if what == "ended" else time.monotonic() - began
            pause = min(0.02 + waited / 10, 0.25)
            if session.worker.idle:
                time.sleep(pause)
            else:
                session.worker.wait(pause)

    def _screenshot(self, event: Event) -> None:
        if not isinstance(self._host, OffscreenHost):
            raise KinetixError("this host draws no pixels; use --offscreen")
        self._frames(1)
        self._host.save_screenshot(Path(event["file"]))

    def _state(self, event: Event) -> None:
        self._frames(1)
        path = Path(event["file"])
        path.parent.mkdir(parents=True, exist_ok=True)
        record = json.dumps(self._session.state_record(), indent=2, ensure_ascii=False)
        path.write_text(record + "\n", encoding="utf-8")

    def _filming(self, event: Event) -> None:
        """Start filming into a GIF; without a file, stop."""
        self._finish_film()
        if "file" in event:
            if not isinstance(self._host, OffscreenHost):
                raise KinetixError("this host draws no pixels; use --offscreen")
            self._film = Film(Path(event["file"]), every=int(event.get("every", 4)))

    def _finish_film(self) -> None:
        if self._film is not None:
            self._film.save()
            self._film = None


def _key(name: str, pressed: bool) -> events.KeyEvent:
    return events.KeyEvent(key=name, pressed=pressed)
