"""Results of players on levels, from play and evaluations, by the level's hash.

One JSON file in the user's state folder. The gallery filters and sorts by it; a level that is
edited has another hash and starts anew.
"""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from editor.base.state_file import read_state, write_state
from kinetix.paths import state_dir

HUMAN: Final = "you"
"""The name under which the user's own episodes are kept."""
MAX_LEVELS: Final = 20_000
"""Of more levels the oldest are forgotten."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Record:
    """Result of one player on one level."""

    attempts: int
    solved: int
    """Attempts that won."""

    @property
    def solve_rate(self) -> float:
        """Share of the attempts that won."""
        return self.solved / self.attempts if self.attempts else 0.0


@dataclasses.dataclass(frozen=True, kw_only=True, order=True)
class Trial:
    """Player and conditions: another trial is another result."""

    player: str
    digest: str = ""
    """SHA-256 of the agent's parameters; empty for people and scripted agents."""
    physics: str = ""
    """Empty where it was not noted."""
    deterministic: bool = False
    """True if the agent took its likeliest actions."""
    seed: int = 0

    @property
    def words(self) -> str:
        """The trial in words: `general 3fa2b1, balanced, likeliest, seed 7`."""
        parts = [f"{self.player} {self.digest[:6]}".strip(), self.physics]
        parts += ["likeliest"] if self.deterministic else []
        parts += [f"seed {self.seed}"] if self.seed else []
        return ", ".join(part for part in parts if part)


class Results:
    """Records by level hash and trial; read once, written at every change."""

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        """Start with what the file says.

        Args:
            path: The file; by default the user's own.
            stored: Whether there is a file at all; scripted runs leave no traces.
        """
        self._path = path
        self._stored = stored
        self._levels: dict[str, dict[Trial, Record]] | None = None if stored else {}
        self.revision = 0
        """Rises with every change, so that lists know when to look again."""

    @property
    def path(self) -> Path:
        """The file."""
        return self._path or state_dir() / "results.json"

    @property
    def players(self) -> tuple[str, ...]:
        """Everybody who has a record, in the order of names."""
        return tuple(sorted({t.player for records in self._read().values() for t in records}))

    def of(self, sha256: str) -> dict[Trial, Record]:
        """The records of a level, by trial."""
        return self._read().get(sha256, {})

    def record(self, trial: Trial, levels: Mapping[str, Record]) -> None:
        """Keep how a player did; an evaluation replaces what the same trial gave before.

        Args:
            trial: Who played, and under what.
            levels: Record of each level, by `level_hash`.

        Raises:
            LevelError: The file cannot be written.
        """
        for sha256, record in levels.items():
            self._put(trial, sha256, record)
        self._write()

    def add_episode(self, player: str, sha256: str, *, won: bool) -> None:
        """Count one more episode of a player (the user's own play).

        Raises:
            LevelError: The file cannot be written.
        """
        trial = Trial(player=player)
        before = self.of(sha256).get(trial, Record(attempts=0, solved=0))
        after = Record(attempts=before.attempts + 1, solved=before.solved + int(won))
        self._put(trial, sha256, after)
        self._write()

    def _put(self, trial: Trial, sha256: str, record: Record) -> None:
        levels = self._read()
        # Moved to the end: the file is in the order of the last change.
        records = levels.pop(sha256, {})
        levels[sha256] = records | {trial: record}
        while len(levels) > MAX_LEVELS:
            del levels[next(iter(levels))]
        self.revision += 1

    def _read(self) -> dict[str, dict[Trial, Record]]:
        if self._levels is None:
            self._levels = _parse(self.path)
        return self._levels

    def _write(self) -> None:
        if not self._stored:
            return
        tree = {
            sha256: [[*dataclasses.astuple(t), r.attempts, r.solved] for t, r in records.items()]
            for sha256, records in self._read().items()
        }
        write_state(self.path, tree)


def _parse(path: Path) -> dict[str, dict[Trial, Record]]:
    """Return the results in the file; broken entries are left out."""
    levels: dict[str, dict[Trial, Record]] = {}
    for sha256, told in read_state(path).items():
        rows = _rows(told)
        if rows is not None:
            levels[sha256] = dict(filter(None, map(_row, rows)))
    return levels


def _rows(told: Any) -> list[Any] | None:
    if isinstance(told, dict):  # the first version: a pair by the player's name
        pairs = [(name, pair) for name, pair in told.items() if isinstance(pair, list)]
        return [[name, "", "", False, 0, *pair] for name, pair in pairs]
    return told if isinstance(told, list) else None


def _row(row: Any) -> tuple[Trial, Record] | None:
    kinds = (str, str, str, bool, int, int, int)
    if not isinstance(row, list) or tuple(map(type, row)) != kinds:
        return None
    player, digest, physics, deterministic, seed, attempts, solved = row
    if not 0 <= solved <= attempts:
        return None
    trial = Trial(
        player=player, digest=digest, physics=physics, deterministic=deterministic, seed=seed
    )
    return trial, Record(attempts=attempts, solved=solved)
