"""Modules of kinetix-env that this package does not have, made from the table of names."""

import importlib.abc
import importlib.machinery
import sys
from collections.abc import Sequence
from types import ModuleType

from kinetix.compat.names import MODULES
from kinetix.lazy import lazy_names

_PARENTS = frozenset(name.rpartition(".")[0] for name in MODULES) - {"kinetix"}


class NamesOfKinetixEnv(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds the modules of the table, after everything that exists as a file."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the specification of a module of the table."""
        del path, target
        if fullname not in MODULES:
            return None
        return importlib.machinery.ModuleSpec(fullname, self, is_package=fullname in _PARENTS)

    def exec_module(self, module: ModuleType) -> None:
        """Let the module find its names on first use."""
        names = MODULES[module.__name__]
        module.__doc__ = f"The names of kinetix-env's {module.__name__}; see docs/migrating.md."
        module.__dict__["__all__"] = sorted(name for name, at in names.items() if at.home)
        module.__dict__["__getattr__"], _ = lazy_names(module.__name__)
        module.__dict__["__dir__"] = lambda: sorted(names)


def install() -> None:
    """Make the modules importable; a second call changes nothing."""
    if not any(isinstance(finder, NamesOfKinetixEnv) for finder in sys.meta_path):
        sys.meta_path.append(NamesOfKinetixEnv())
