"""Names that are imported on first use, and the error for names that do not exist."""

import importlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

_MOST_LISTED: Final = 40
"""A sentence names at most so many names; longer lists help nobody."""

Lookup = tuple[Callable[[str], Any], Callable[[], list[str]]]
"""The two functions `__getattr__` and `__dir__` of a module."""


def lazy_names(
    module: str,
    home: Mapping[str, str] | None = None,
    submodules: Iterable[str] = (),
    *,
    kinetix_env: bool = True,
) -> Lookup:
    """Return `__getattr__` and `__dir__` for a module whose names live elsewhere.

    Args:
        module: Name of the module that calls this.
        home: The module that defines each name.
        submodules: Modules of the package that are found as its attributes.
        kinetix_env: Whether names and modules of kinetix-env that the module does not have itself
            are found as well (`kinetix.compat`).
    """
    homes, submodules = dict(home or {}), frozenset(submodules)

    def find(name: str) -> Any:
        if name in homes:
            return getattr(importlib.import_module(homes[name]), name)
        if name in submodules:
            return importlib.import_module(f"{module}.{name}")
        if kinetix_env and not name.startswith("__"):
            of_kinetix_env = importlib.import_module("kinetix.compat.names")
            if name in of_kinetix_env.MODULES.get(module, ()):
                return of_kinetix_env.find(module, name)
            if f"{module}.{name}" in of_kinetix_env.MODULES:
                return importlib.import_module(f"{module}.{name}")
        told = f"; {hint(name, homes)}" if homes else ""
        raise AttributeError(f"module {module!r} has no attribute {name!r}{told}")

    def names() -> list[str]:
        return sorted({*homes, *submodules})

    return find, names


def hint(name: str, known: Iterable[str], *, listing: str = "it has") -> str:
    """Return what a sentence about an unknown name ends with: the nearest name, or all of them."""
    import difflib  # only a mistake needs it

    known = sorted(known)
    lower = {each.lower(): each for each in known}
    near = difflib.get_close_matches(name.lower(), lower, n=1, cutoff=0.75)
    if near:
        return f"did you mean {lower[near[0]]!r}?"
    rest = len(known) - _MOST_LISTED
    listed = ", ".join(known[:_MOST_LISTED]) + (f" and {rest} more" if rest > 0 else "")
    return f"{listing} {listed}"
