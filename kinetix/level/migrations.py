"""Steps from one version of the format to the next, on parsed JSON.

`MIGRATIONS[n]` is a pure function from a tree of version n to one of version n + 1. There are no
gaps; a test asserts it. Version 2 added the key `name` to bodies, joints and thrusters.
"""

from collections.abc import Callable
from typing import Any, Final

Tree = dict[str, Any]


def _keep(tree: Tree) -> Tree:
    """Return the tree as it is: the newer version only has more fields."""
    return tree


MIGRATIONS: Final[dict[int, Callable[[Tree], Tree]]] = {1: _keep}


def migrate(tree: Tree, version: int, newest: int) -> Tree:
    """A tree of version `version` as one of version `newest`; the argument is left as it is."""
    for step in range(version, newest):
        tree = MIGRATIONS[step](tree) | {"version": step + 1}
    return tree
