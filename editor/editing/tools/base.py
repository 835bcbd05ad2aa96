"""Tools, and the one driver of all gestures.

A gesture is a generator: it is started by a press, yields what to show, is sent the following
pointer events and returns the command to commit (or None). Everything a gesture remembers is a
local variable of the generator, so that leaving it in any way leaves nothing behind.
"""

import abc
import contextlib
import dataclasses
import inspect
import math
from collections.abc import Collection, Generator
from typing import ClassVar, Final, Protocol, TypeAlias

from editor.base.events import NO_MODIFIERS, Modifiers, Point, Pointer, PointerEvent
from editor.base.overlay import Cursor, Mark
from editor.base.prompts import Prompt
from editor.documents.commands.base import Command, EntityId, Selection
from editor.documents.document import Document, Outcome
from editor.editing.snapping import Rules, Targets
from kinetix.errors import CommandError

DRAG_PIXELS: Final = 3.0
"""Less movement than this between press and release is a click [px at 100 %]."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Feedback:
    """Marks and words of a tool at one moment."""

    command: Command | None = None
    """Previewed on the committed level."""
    marks: tuple[Mark, ...] = ()
    hint: str = ""
    """A sentence for the status bar; empty: the tool's own."""
    cursor: Cursor = Cursor.ARROW


Gesture: TypeAlias = Generator[Feedback, PointerEvent, Command | None]

NOTHING: Final = Feedback()


class Preferences(Protocol):
    """Settings that tools follow."""

    from_centre: bool
    move_jointed: bool


class Shown(Protocol):
    """View settings that tools follow."""

    scale: float
    """Window pixels per pixel at 100 %."""
    edit_arena: bool
    """True if floor, walls and ceiling can be selected."""


class ToolContext(Protocol):
    """The part of the app that tools and gestures read, ask and tell."""

    tool: "Tool"
    hovered: EntityId | None
    """Entity under the pointer."""
    last_click: PointerEvent | None
    """The last click that selected, to notice a second one at the same place."""

    @property
    def selection(self) -> Selection:
        """Entities that are selected."""
        ...

    @selection.setter
    def selection(self, selection: Selection) -> None: ...

    @property
    def document(self) -> Document:
        """The document in front."""
        ...

    @property
    def settings(self) -> Preferences:
        """The preferences."""
        ...

    @property
    def view(self) -> Shown:
        """View settings."""
        ...

    @property
    def metres(self) -> float:
        """Width of a pixel of the canvas at 100 % [m]."""
        ...

    @property
    def angle_step(self) -> float:
        """Grid of angles [rad]."""
        ...

    def rules(self, modifiers: Modifiers = NO_MODIFIERS) -> Rules:
        """Return which snaps are on; Ctrl inverts them."""
        ...

    def targets(self, moving: Collection[EntityId] = ()) -> Targets:
        """Return what can be snapped to, hidden and moving bodies left out."""
        ...

    def execute(self, command: Command, *, on: Document | None = None) -> Outcome:
        """Commit a command, on the document in front if none is named."""
        ...

    def tool_done(self) -> None:
        """Take note that a tool has made something."""
        ...

    def ask(self, prompt: Prompt) -> None:
        """Put a question before the user."""
        ...

    def complain(self, text: str) -> None:
        """Report why something was not done."""
        ...


def is_drag(session: ToolContext, start: Point, end: Point) -> bool:
    """Return whether the way between two places of the window is long enough for a drag."""
    return math.dist(start, end) >= DRAG_PIXELS * session.view.scale


class Tool(abc.ABC):
    """Turns pointer events into commands; holds no state of its own between gestures."""

    id: ClassVar[str]
    label: ClassVar[str]
    hint: ClassVar[str]
    """Instruction for the status bar."""
    click_click: ClassVar[bool] = False
    """True if click, move, click does the same as press, drag, release."""
    creates: ClassVar[bool] = False
    """True if it makes things; then Select takes over afterwards unless the tool is kept."""

    @abc.abstractmethod
    def press(self, session: ToolContext, event: PointerEvent) -> Gesture | None:
        """Start a gesture at a press of the left button; None when there is nothing to do."""

    def hover(self, session: ToolContext, event: PointerEvent) -> Feedback:
        """Return the feedback while the pointer only moves."""
        del session, event
        return Feedback(cursor=Cursor.CROSS)


class Driver:
    """Runs one gesture at a time: previews what it yields, commits what it returns."""

    def __init__(self, session: ToolContext) -> None:
        self._session = session
        self._gesture: Gesture | None = None
        self._press: PointerEvent | None = None
        self._last: PointerEvent | None = None
        self._floating = False
        self._typed = ""
        self.feedback = NOTHING
        """Feedback of the gesture, or else of the tool under the pointer."""

    @property
    def active(self) -> bool:
        """True if a gesture is under way."""
        return self._gesture is not None

    @property
    def typed(self) -> str:
        """The size typed so far."""
        return self._typed

    def pointer(self, event: PointerEvent) -> None:
        """Take a pointer event of the left button, or a move."""
        event = dataclasses.replace(event, typed=_numbers(self._typed))
        if self._gesture is None:
            if event.kind is Pointer.PRESS:
                self._begin(event)
            elif event.kind is Pointer.MOVE:
                self.feedback = self._session.tool.hover(self._session, event)
            return
        if self._floating:
            if event.kind is Pointer.PRESS:
                return
            if event.kind is Pointer.RELEASE:
                self._floating = False
        elif event.kind is Pointer.RELEASE and self._is_click(event):
            # The press was a click: the gesture goes on until the next one.
            self._floating = True
            return
        self._send(event)

    def text(self, characters: str) -> bool:
        """Take typed characters as a size; False when no gesture wants them."""
        if self._gesture is None or not set(characters) <= set("-0123456789.,x*"):
            return False
        self._typed += characters.replace(",", ".").replace("*", "x")
        self._resend()
        return True

    def backspace(self) -> bool:
        """Take the last typed character back; False when there is none."""
        if not self._typed:
            return False
        self._typed = self._typed[:-1]
        self._resend()
        return True

    def accept(self) -> bool:
        """Finish the gesture where it is (Enter); False when none is under way."""
        if self._gesture is None or self._last is None:
            return False
        self._send(dataclasses.replace(self._last, kind=Pointer.RELEASE))
        return True

    def cancel(self) -> bool:
        """Drop the gesture and its preview; False when none was under way.

        A gesture that itself asks the user something, as its last act, is left to end by itself.
        """
        if self._gesture is None or inspect.getgeneratorstate(self._gesture) == inspect.GEN_RUNNING:
            return False
        self._gesture.close()
        self._end()
        return True

    def settle(self) -> None:
        """End the gesture before another edit of its level.

        A drag is kept where it is; unfinished click sequences are cancelled; a press without
        movement stays active.
        """
        if self._gesture is None or inspect.getgeneratorstate(self._gesture) == inspect.GEN_RUNNING:
            return
        if self._floating:
            self.cancel()
        elif self._session.document.previewing:
            self.accept()

    def _begin(self, event: PointerEvent) -> None:
        self._typed = ""
        self._press = self._last = event
        self._gesture = self._session.tool.press(self._session, event)
        if self._gesture is not None:
            self._advance(None)

    def _send(self, event: PointerEvent) -> None:
        self._last = event
        self._advance(event)

    def _resend(self) -> None:
        if self._last is not None:
            typed = _numbers(self._typed)
            self._send(dataclasses.replace(self._last, kind=Pointer.MOVE, typed=typed))

    def _advance(self, event: PointerEvent | None) -> None:
        assert self._gesture is not None
        document = self._session.document
        try:
            feedback = self._gesture.send(event)  # pyright: ignore[reportArgumentType]
        except StopIteration as finished:
            self._end()
            if finished.value is not None:
                self._session.execute(finished.value)
                if self._session.tool.creates:
                    self._session.tool_done()
            return
        except CommandError as error:
            self._end()
            self._session.complain(str(error))
            return
        except Exception:
            self._end()
            raise
        self.feedback = feedback
        try:
            document.preview(feedback.command)
        except CommandError as error:
            self.feedback = dataclasses.replace(feedback, hint=str(error), cursor=Cursor.REFUSED)

    def _end(self) -> None:
        self._gesture = self._press = self._last = None
        self._floating, self._typed = False, ""
        self.feedback = NOTHING
        self._session.document.discard_preview()

    def _is_click(self, event: PointerEvent) -> bool:
        assert self._press is not None
        dragged = is_drag(self._session, self._press.screen, event.screen)
        return self._session.tool.click_click and not dragged


def _numbers(text: str) -> tuple[float, ...]:
    numbers = []
    for part in text.split("x"):
        with contextlib.suppress(ValueError):
            numbers.append(float(part))
    return tuple(numbers)
