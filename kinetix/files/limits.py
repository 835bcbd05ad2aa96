"""Limits of everything that is read from a file: one table, shown in docs/security.md."""

import dataclasses
from typing import Final, Literal

MIB: Final = 2**20
DEPTH: Final = 64
"""Arrays and objects within each other, in any JSON; a level has 8."""
LARGEST_INTEGER: Final = 2**63 - 1
"""Whole numbers beyond this are refused in any JSON but levels, whose ranges are narrower."""
MEMBERS: Final = 64
"""Arrays in one archive."""
CHECKPOINT_FILES: Final = 10_000
"""Files below the folder of an agent."""

Kind = Literal[
    "level",
    "set",
    "agent",
    "tensors",
    "run",
    "metrics",
    "trace",
    "episodes",
    "curriculum",
    "script",
    "kept",
]


@dataclasses.dataclass(frozen=True, kw_only=True)
class FileLimit:
    """Bounds of one kind of file."""

    what: str
    """The kind in words."""
    largest: int
    """Bytes; larger files are refused unread. Of an archive: of its arrays, unpacked."""
    why: str
    """Usual size of such files."""


LIMITS: Final[dict[Kind, FileLimit]] = {
    "level": FileLimit(
        what="level, autosave", largest=8 * MIB, why="the largest published level has 52 kB"
    ),
    "set": FileLimit(what="level set", largest=32 * MIB, why="a thousand inline levels have 10 MB"),
    "agent": FileLimit(what="`agent.json`, `config.json`", largest=16 * MIB, why="about 20 kB"),
    "tensors": FileLimit(
        what="arrays of an agent or a training state", largest=16384 * MIB, why="2 MB to 2 GB"
    ),
    "run": FileLimit(what="`progress.json`, `config.toml`", largest=1 * MIB, why="about 3 kB"),
    "metrics": FileLimit(what="`metrics.jsonl`", largest=1024 * MIB, why="1 kB an update"),
    "trace": FileLimit(what="recorded episode (`.npz`)", largest=256 * MIB, why="about 1 MB"),
    "episodes": FileLimit(
        what="shard of a data set of episodes", largest=1024 * MIB, why="about 2 MB"
    ),
    "curriculum": FileLimit(
        what="history of a curriculum's buffer", largest=64 * MIB, why="below 1 MB a page"
    ),
    "script": FileLimit(what="replay script (`.jsonl`)", largest=64 * MIB, why="about 10 kB"),
    "kept": FileLimit(
        what="settings, results, names, gallery index", largest=64 * MIB, why="up to 10 MB"
    ),
}
"""By kind of file."""
