"""The option `--attempt` of commands that show an episode of an evaluation."""

from typing import Final

from kinetix.errors import KinetixError

_MOST: Final = 2**31 - 1


def check_attempt(attempt: int | None) -> None:
    """Refuse the number of an attempt that no evaluation has.

    Args:
        attempt: From the command line; None where an episode of its own is meant.

    Raises:
        KinetixError: It is out of range.
    """
    if attempt is not None and not 0 <= attempt <= _MOST:
        raise KinetixError(f"--attempt {attempt}: expected a number from 0 to {_MOST}")
