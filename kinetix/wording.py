"""Words for numbers of things, as commands and the editor say them."""


def plural(count: int, noun: str, many: str = "") -> str:
    """Return a number of things: `1 joint`, `3 joints`.

    Args:
        count: How many.
        noun: One of them.
        many: Several of them, where that is not the noun with an s.
    """
    return f"{count} {noun if count == 1 else many or f'{noun}s'}"


def thousands(number: int) -> str:
    """Return a number with a space between each three digits: `1 572 864`."""
    return f"{number:,}".replace(",", " ")
