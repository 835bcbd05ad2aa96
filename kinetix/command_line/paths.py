"""Paths as command lines name them."""

from pathlib import Path
from typing import Annotated, TypeAlias

from tyro.constructors import PrimitiveConstructorSpec


def _path_of(words: list[str]) -> Path:
    # Path("") is the current folder: what a script gives when its variable is not set.
    if not words[0]:
        raise ValueError("expected a path, got an empty word; `.` is the current folder")
    return Path(words[0])


NamedPath: TypeAlias = Annotated[
    Path,
    PrimitiveConstructorSpec(
        nargs=1,
        metavar="PATH",
        instance_from_str=_path_of,
        is_instance=lambda instance: isinstance(instance, Path),
        str_from_instance=lambda instance: [str(instance)],
    ),
]
"""A path that is written out: an empty word is refused."""
