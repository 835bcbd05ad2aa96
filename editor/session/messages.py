"""Words to the user: short messages, questions, and what became of errors."""

import dataclasses
import logging
import traceback
from collections.abc import Callable
from typing import Final, Literal, TypeAlias

from editor.base.crashes import Crashes
from editor.base.journal import Journal
from editor.base.prompts import Prompt
from kinetix.errors import CommandError, KinetixError

LOG: Final = logging.getLogger(__name__)
TOAST_SECONDS: Final = 5.0
UNDO_TOAST_SECONDS: Final = 8.0
ERROR_TOAST_SECONDS: Final = 15.0
_READ_AT_ONCE: Final = 60
"""Length up to which a message stays for the usual time [characters]."""
_READING: Final = 20.0
"""So fast a long message is read [characters a second]."""
_HELD: Final = 2.0
"""After the pointer has left a message it stays for so long at least [s]."""
_MOST: Final = 400
"""Most characters of a message on the screen."""
_END: Final = 80

Kind: TypeAlias = Literal["info", "success", "warning", "error"]


@dataclasses.dataclass(kw_only=True)
class Toast:
    """A short message that goes by itself."""

    text: str
    kind: Kind
    until: float
    """Time at which it disappears, on the session's clock [s]."""
    action: str | None = None
    """An action offered as a button (`edit.undo`)."""
    offered: Callable[[], bool] = lambda: True
    """Returns False once the button would do something else than the message says."""
    holds: Callable[[], bool] = lambda: True
    """Returns False once the message is no longer true."""


def _shortened(text: str) -> str:
    """Return a message that leaves the window visible; the log has all of it."""
    return text if len(text) <= _MOST else f"{text[: _MOST - _END]} … {text[-_END:]}"


class Messages:
    """Toasts, questions and the log."""

    def __init__(self, clock: Callable[[], float]) -> None:
        """Begin with none.

        Args:
            clock: Tells the time by which toasts disappear [s].
        """
        self._clock = clock
        self.prompts: list[Prompt] = []
        """Questions to the user, the uppermost last."""
        self.toasts: list[Toast] = []
        self.log = Journal()
        self.crashes = Crashes()
        """Unexpected errors, and the actions before them."""

    def toast(
        self,
        text: str,
        kind: Kind = "info",
        *,
        action: str | None = None,
        offered: Callable[[], bool] = lambda: True,
        holds: Callable[[], bool] = lambda: True,
    ) -> None:
        """Show a message until it can be read; the same message is not stacked."""
        self.log.add(text)
        text = _shortened(text)
        seconds = UNDO_TOAST_SECONDS if action else TOAST_SECONDS
        seconds += max(len(text) - _READ_AT_ONCE, 0) / _READING
        if kind == "error":
            seconds = max(seconds, ERROR_TOAST_SECONDS)
        self.toasts = [toast for toast in self.toasts if toast.text != text]
        until = self._clock() + seconds
        self.toasts.append(
            Toast(text=text, kind=kind, until=until, action=action, offered=offered, holds=holds)
        )

    def hold(self, toast: Toast) -> None:
        """Keep a message that the pointer is on."""
        toast.until = max(toast.until, self._clock() + _HELD)

    def withdraw(self, action: str) -> None:
        """Take the messages that offer an action away: it was done, or can be done no more."""
        self.toasts = [each for each in self.toasts if each.action != action]

    def hush(self) -> None:
        """Take the messages of success away: what begins now has the screen."""
        self.toasts = [each for each in self.toasts if each.kind != "success" or each.action]

    def expire(self) -> None:
        """Take away what is over or no longer true, and buttons that would do something else."""
        now = self._clock()
        self.toasts = [
            toast if toast.offered() else dataclasses.replace(toast, action=None)
            for toast in self.toasts
            if toast.until > now and toast.holds()
        ]

    def report(self, error: Exception, *, before: Callable[[], None]) -> None:
        """Show an error: an expected one as its sentence, another with an entry in the log.

        Args:
            error: What was raised.
            before: Called first where an unexpected error comes for the first time.
        """
        if isinstance(error, KinetixError):
            self.toast(str(error), "warning" if isinstance(error, CommandError) else "error")
            return
        sentence, new = self.crashes.tell(error)
        if new:
            before()
        self.toast(sentence, "error")
        if self.log.add("".join(traceback.format_exception(error))):
            LOG.error("unexpected error", exc_info=error)
