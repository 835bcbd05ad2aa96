"""Closing the app: a question first, then perhaps a wait for files."""

from dataclasses import dataclass

from editor.base.prompts import Prompt
from kinetix.level.model import Level


@dataclass
class Closing:
    """The state of it; nothing is set while nobody closes the app."""

    question: Prompt | None = None
    """The last question that closing asked."""
    waits_with: tuple[Level, ...] | None = None
    """The open levels when somebody chose to wait for files and then close, or None."""
    done: bool = False
    """True if the app may end."""
