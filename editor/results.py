"""Who has won which level: what play and evaluations leave behind, by the level's hash.

One JSON file in the user's state folder. The gallery filters and sorts by it; a level that is
edited has another hash and starts anew.
"""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from editor.kept import read_kept, write_kept
from kinetix.paths import state_dir

HUMAN: Final = "you"
"""The name under which the user's own episodes are kept."""
MAX_LEVELS: Final = 20_000
"""Of more levels the oldest are forgotten."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Record:
    """How one player did on one level."""

    attempts: int
    solved: int
    """Attempts that won."""

    @property
    def solve_rate(self) -> float:
        """Share of the attempts that won."""
        return self.solved / self.attempts if self.attempts else 0.0


class Results:
    """Records by level hash and player; read once, written at every change."""

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        """Start with what the file says.

        Args:
            path: The file; by default the user's own.
            stored: Whether there is a file at all; scripted runs leave no traces.
        """
        self._path = path
        self._stored = stored
        self._levels: dict[str, dict[str, Record]] | None = None if stored else {}
        self.revision = 0
        """Rises with every change, so that lists know when to look again."""

    @property
    def path(self) -> Path:
        """The file."""
        return self._path or state_dir() / "results.json"

    @property
    def players(self) -> tuple[str, ...]:
        """Everybody who has a record, in the order of names."""
        return tuple(sorted({name for records in self._read().values() for name in records}))

    def of(self, sha256: str) -> dict[str, Record]:
        """The records of a level, by player."""
        return self._read().get(sha256, {})

    def record(self, player: str, levels: Mapping[str, Record]) -> None:
        """Keep how a player did; an evaluation replaces what was known of its levels.

        Args:
            player: Name of the agent.
            levels: Record of each level, by `level_hash`.

        Raises:
            LevelError: The file cannot be written.
        """
        for sha256, record in levels.items():
            self._put(player, sha256, record)
        self._write()

    def add_episode(self, player: str, sha256: str, *, won: bool) -> None:
        """Count one more episode of a player (the user's own play).

        Raises:
            LevelError: The file cannot be written.
        """
        before = self.of(sha256).get(player, Record(attempts=0, solved=0))
        after = Record(attempts=before.attempts + 1, solved=before.solved + int(won))
        self._put(player, sha256, after)
        self._write()

    def _put(self, player: str, sha256: str, record: Record) -> None:
        levels = self._read()
        # Moved to the end: the file is in the order of the last change.
        records = levels.pop(sha256, {})
        levels[sha256] = records | {player: record}
        while len(levels) > MAX_LEVELS:
            del levels[next(iter(levels))]
        self.revision += 1

    def _read(self) -> dict[str, dict[str, Record]]:
        if self._levels is None:
            self._levels = _parse(self.path)
        return self._levels

    def _write(self) -> None:
        if not self._stored:
            return
        tree = {
            sha256: {name: [r.attempts, r.solved] for name, r in records.items()}
            for sha256, records in self._read().items()
        }
        write_kept(self.path, tree)


def _parse(path: Path) -> dict[str, dict[str, Record]]:
    """What the file says; what is broken in it is passed over."""
    levels: dict[str, dict[str, Record]] = {}
    for sha256, players in read_kept(path).items():
        if not isinstance(players, dict):
            continue
        records = {name: _record(pair) for name, pair in players.items()}
        levels[sha256] = {name: one for name, one in records.items() if one is not None}
    return levels


def _record(pair: Any) -> Record | None:
    if not (isinstance(pair, list) and len(pair) == 2 and all(type(n) is int for n in pair)):
        return None
    attempts, solved = pair
    return Record(attempts=attempts, solved=solved) if 0 <= solved <= attempts else None
