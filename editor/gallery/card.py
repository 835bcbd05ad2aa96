"""Facts about a level file that the gallery keeps instead of the level."""

from pathlib import Path

import msgspec

from editor.documents.files import plain_reason
from kinetix.errors import LevelError
from kinetix.level.codec import level_hash, load_document
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of, describe_capacity, size_name
from kinetix.level.validate import validate

OTHER_SIZE = "other"
"""Filter's name of a capacity without a name."""


class Card(msgspec.Struct, frozen=True, kw_only=True):
    """One level file. Plain values: the index on disk holds the same."""

    path: str
    modified_ns: int
    """Time of the file's last change [ns]."""
    bytes: int
    """Length of the file; with the time it shows whether the card is up to date."""
    name: str
    description: str = ""
    tags: tuple[str, ...] = ()
    size: str = ""
    """Capacity: a size's name or four numbers."""
    size_class: str = OTHER_SIZE
    """A size's name, or `other`."""
    bodies: int = 0
    joints: int = 0
    thrusters: int = 0
    motors: int = 0
    """Joints that can be driven."""
    sha256: str = ""
    """`level_hash`; empty when the file cannot be read."""
    format: str = "kinetix-level"
    solved: bool = False
    """True if the file carries a recorded solution."""
    errors: int = 0
    warnings: int = 0
    fault: str = ""
    """Reason why the file cannot be read, in one sentence; empty when it can."""

    @property
    def file(self) -> Path:
        """The path."""
        return Path(self.path)


def read_card(path: Path) -> tuple[Card, Level | None]:
    """Read a level file.

    Args:
        path: The file.

    Returns:
        Its card, and the level unless the file is bad: then the card's `fault` says why.

    Raises:
        OSError: The file is gone.
    """
    status = path.stat()
    try:
        loaded = load_document(path.resolve())
    except LevelError as error:
        return fault_card(path, f"{path.name}: {plain_reason(path, error)}"), None
    return make_card(loaded.level, path, status.st_mtime_ns, status.st_size, loaded.format), (
        loaded.level
    )


def fault_card(path: Path, fault: str) -> Card:
    """Make the card of a file that cannot be read.

    Raises:
        OSError: The file is gone.
    """
    status = path.stat()
    return Card(
        path=str(path),
        modified_ns=status.st_mtime_ns,
        bytes=status.st_size,
        name=path.stem,
        fault=fault,
    )


def make_card(level: Level, path: Path, modified_ns: int, size: int, format: str) -> Card:
    """Return the card of a level that was read from a file."""
    issues = validate(level)
    capacity = capacity_of(level)
    driven = [j for j in level.joints if j.kind == "revolute" and j.motor and j.motor.on]
    return Card(
        path=str(path),
        modified_ns=modified_ns,
        bytes=size,
        name=level.name.replace("\n", " "),
        description=level.description,
        tags=level.tags,
        size=describe_capacity(capacity),
        size_class=size_name(capacity) or OTHER_SIZE,
        bodies=len(level.bodies),
        joints=len(level.joints),
        thrusters=len(level.thrusters),
        motors=len(driven),
        sha256=level_hash(level),
        format=format,
        solved=level.solution is not None,
        errors=sum(issue.severity == "error" for issue in issues),
        warnings=sum(issue.severity == "warning" for issue in issues),
    )
