"""Names of files as text."""

from pathlib import Path


def is_text(path: str | Path) -> bool:
    """Return whether a name is Unicode text; Linux allows any bytes, and old archives have them."""
    return not any("\ud800" <= character <= "\udfff" for character in str(path))
