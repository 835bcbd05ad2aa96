"""Equal reset functions are one object: so equal environments are equal, and compiled once.

That holds for copies and for what was sent to another process and back, too: workers that are sent
the same environment with every task compile it for the first one.
"""

import functools
import hashlib
from collections.abc import Callable, Hashable
from typing import Any, TypeVar
from weakref import WeakValueDictionary

import jax
import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])

_IN_USE: WeakValueDictionary[Hashable, Any] = WeakValueDictionary()


def shared(function: Function, *made_of: Any) -> Function:
    """Return the function made of the same things before, while it is in use; else this one.

    Args:
        function: Does the same as any other that is made of the same things.
        made_of: Everything the function depends on. If it is not hashable, functions are not
            shared.
    """
    try:
        # 256 and 256.0 are equal, but make arrays of different types.
        return _IN_USE.setdefault((made_of, repr(made_of)), function)
    except TypeError:
        return function


class _Partial(functools.partial):
    """A partial function whose copies are the shared one."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Name what makes it."""
        return _remade, (self.func, self.args, self.keywords)


def shared_partial(function: Callable[..., Any], *args: Any, **options: Any) -> Callable[..., Any]:
    """`functools.partial`, the same object for the same function and arguments."""
    return shared(_Partial(function, *args, **options), function, *args, *options.values())


def _remade(
    function: Callable[..., Any], args: tuple[Any, ...], options: dict[str, Any]
) -> Callable[..., Any]:
    return shared_partial(function, *args, **options)


def digest(tree: Any) -> str:
    """Return a key of pytrees of arrays: their structure, types, shapes and numbers."""
    leaves, structure = jax.tree.flatten(tree)
    summary = hashlib.sha256(str(structure).encode())
    for leaf in map(np.asarray, leaves):
        summary.update(f"{leaf.dtype} {leaf.shape} ".encode())
        summary.update(leaf.tobytes())
    return summary.hexdigest()
