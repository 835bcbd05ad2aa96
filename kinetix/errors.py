"""The errors that users meet: one sentence each, saying what is wrong and what was expected."""


class KinetixError(Exception):
    """Base of every error that this project raises on purpose."""


class LevelError(KinetixError):
    """A level or level-set file is bad: file, JSON path, what was expected, what was found."""


class CheckpointError(KinetixError):
    """An agent's directory is bad, or does not fit the level it is asked to play."""


class CommandError(KinetixError):
    """An edit cannot be done to this level; the sentence is meant for the status bar."""
