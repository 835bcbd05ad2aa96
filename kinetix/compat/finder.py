"""Modules of kinetix-env that this package does not have, made from the table of names."""

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

from kinetix.lazy import lazy_names


class NamesOfKinetixEnv:
    """Finds the modules of the table, after everything that exists as a file.

    A finder and loader of `sys.meta_path`; the table is read when it is first asked.
    """

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the specification of a module of the table."""
        del path, target
        if not fullname.startswith("kinetix."):
            return None
        from kinetix.compat.names import MODULES

        if fullname not in MODULES:
            return None
        is_package = any(name.startswith(f"{fullname}.") for name in MODULES)
        return ModuleSpec(fullname, cls, is_package=is_package)  # pyright: ignore[reportArgumentType]

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Leave it to Python."""
        del spec

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Let the module find its names on first use."""
        from kinetix.compat.names import MODULES

        names = MODULES[module.__name__]
        module.__doc__ = f"The names of kinetix-env's {module.__name__}; see docs/migrating.md."
        module.__dict__["__all__"] = sorted(name for name, at in names.items() if at.home)
        module.__dict__["__getattr__"], _ = lazy_names(module.__name__)
        module.__dict__["__dir__"] = lambda: sorted(names)


def install() -> None:
    """Make the modules importable; a second call changes nothing."""
    if NamesOfKinetixEnv not in sys.meta_path:
        sys.meta_path.append(NamesOfKinetixEnv)  # pyright: ignore[reportArgumentType]
