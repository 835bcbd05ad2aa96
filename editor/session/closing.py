"""How far closing the app has come."""

from dataclasses import dataclass

from editor.base.prompts import Prompt
from kinetix.level.model import Level


@dataclass
class Closing:
    """What was asked when somebody closed the app, and what the app waits for since."""

    question: Prompt | None = None
    """The last question that closing asked."""
    waits_with: tuple[Level, ...] | None = None
    """The open levels when somebody chose to wait for files and then close, or None."""
    done: bool = False
    """True if the app may end."""
