"""The errors that users meet: one sentence each, saying what is wrong and what was expected."""

from typing import Any


class KinetixError(Exception):
    """Base of every error that this project raises on purpose."""


class LevelError(KinetixError):
    """A level or level-set file is bad: file, JSON path, what was expected, what was found."""

    def __init__(self, message: str, faults: tuple[Any, ...] = ()) -> None:
        """Keep the sentence, and each fault by itself where there are several.

        Args:
            message: The sentence that users read.
            faults: `kinetix.level.faults.Fault` values, when a file was read.
        """
        super().__init__(message)
        self.faults = faults


class CheckpointError(KinetixError):
    """An agent's directory is bad, or does not fit the level it is asked to play."""


class CommandError(KinetixError):
    """An edit cannot be done to this level; the sentence is meant for the status bar."""
