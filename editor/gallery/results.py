"""Results of players on levels, from play and evaluations, by the level's hash.

One JSON file in the user's state folder. The gallery filters and sorts by it; a level that is
edited has another hash and starts without results.
"""

import contextlib
import dataclasses
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from editor.base.state_file import Kept, alone, read_state, state_fault, write_state

HUMAN: Final = "you"
"""The name under which the user's own episodes are kept."""
MAX_LEVELS: Final = 20_000
"""Of more levels the oldest are forgotten."""
_ROW: Final = (str, str, str, bool, int, str, int, int)
"""Kinds of the entries of a trial's row in the file: the trial, attempts, solved ones."""
_ROW_WITHOUT_CARD: Final = (str, str, str, bool, int, int, int)
"""Types of a row of an older version."""


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
    card: str = ""
    """Digest of how the agent plays, its parameters aside; empty where an older version noted
    none: a trial with a card replaces the one without."""

    @property
    def words(self) -> str:
        """The trial in words: `general 3fa2b1·9c0d, balanced, likeliest, seed 7`."""
        digests = "·".join(filter(None, (self.digest[:6], self.card[:4])))
        parts = [f"{self.player} {digests}".strip(), self.physics]
        parts += ["likeliest"] if self.deterministic else []
        parts += [f"seed {self.seed}"] if self.seed else []
        return ", ".join(part for part in parts if part)


class Results(Kept):
    """Records by level hash and trial; every change keeps what another window has written."""

    FILE = "results.json"

    def __init__(self, path: Path | None = None, *, stored: bool = True) -> None:
        super().__init__(path, stored=stored)
        self._levels: dict[str, dict[Trial, Record]] | None = None if stored else {}
        self._foreign: dict[str, Any] = {}
        """Entries that this version does not understand: they are written back unchanged."""
        self._unwritten: dict[str, dict[Trial, Record]] = {}
        """Records that the file does not have yet; the next write adds them."""
        self._seen: tuple[int, int, int] | None = None
        """The file as it was read or written last."""
        self.revision = 0
        """Rises with every change, so that lists know when to look again."""
        self._fault = self._told_fault = ""

    @property
    def players(self) -> tuple[str, ...]:
        """Everybody who has a record, in the order of names."""
        return tuple(sorted({t.player for records in self._read().values() for t in records}))

    def of(self, sha256: str) -> dict[Trial, Record]:
        """Return the records of a level, by trial."""
        return self._read().get(sha256, {})

    def take_fault(self) -> str:
        """Return once why the file could not be read; empty where it could."""
        new = "" if self._fault == self._told_fault else self._fault
        self._told_fault = self._fault
        return new

    def record(self, trial: Trial, levels: Mapping[str, Record]) -> None:
        """Keep how a player did; an evaluation replaces what the same trial gave before.

        Args:
            trial: Who played, and under what.
            levels: Record of each level, by `level_hash`.

        Raises:
            LevelError: The file cannot be written.
        """
        self.record_all({trial: levels})

    def record_all(self, found: Mapping[Trial, Mapping[str, Record]]) -> None:
        """Keep how several players did, as `record` does of one; the file is written once.

        Raises:
            LevelError: The file cannot be written; the next write, or `flush`, adds them all.
        """
        records: dict[str, dict[Trial, Record]] = {}
        for trial, levels in found.items():
            for sha256, record in levels.items():
                records.setdefault(sha256, {})[trial] = record
        with self._alone():
            self._refresh()
            self._put(records)

    def flush(self) -> None:
        """Try again what could not be written.

        Raises:
            LevelError: A file still cannot be written.
        """
        if self._unwritten:
            self.record_all({})

    def add_episode(self, player: str, sha256: str, *, won: bool) -> None:
        """Count one more episode of a player (the user's own play).

        Raises:
            LevelError: The file cannot be written.
        """
        trial = Trial(player=player)
        with self._alone():
            self._refresh()
            before = self.of(sha256).get(trial, Record(attempts=0, solved=0))
            after = Record(attempts=before.attempts + 1, solved=before.solved + int(won))
            self._put({sha256: {trial: after}})

    def _alone(self) -> contextlib.AbstractContextManager[None]:
        return alone(self.path) if self._stored else contextlib.nullcontext()

    def _put(self, records: Mapping[str, dict[Trial, Record]]) -> None:
        """Take records in and write the file; those of a failed write go with the next one."""
        for sha256, trials in records.items():
            self._unwritten[sha256] = self._unwritten.get(sha256, {}) | trials
        self._merge(records)
        self.revision += 1
        if self._stored:
            sound = self._seen is not None and self._seen == _state_of(self.path)
            tree = _tree(self._read(), self._foreign)
            written = write_state(self.path, tree, sound=sound, indent=None)
            # Not as it is by now: another window may have replaced it.
            self._seen = None if written is None else _told(written)
        self._unwritten.clear()

    def _refresh(self) -> None:
        """Take over what other windows have written; what is not written yet stays on top.

        A file that was broken meanwhile is passed over.
        """
        if not self._stored:
            return
        state = _state_of(self.path)
        if state is not None and state == self._seen:
            return
        there = read_state(self.path)
        self._seen = state if there else None
        if there or not os.path.lexists(self.path):
            self._take(there)
            self._merge(self._unwritten)
        else:
            self._fault = state_fault(self.path)

    def _merge(self, records: Mapping[str, dict[Trial, Record]]) -> None:
        levels = self._read()
        for sha256, trials in records.items():
            replaced = {dataclasses.replace(trial, card="") for trial in trials if trial.card}
            before = levels.pop(sha256, {}).items()
            kept = {trial: record for trial, record in before if trial not in replaced}
            # At the end: the file is in the order of the last change.
            levels[sha256] = kept | trials
        while len(levels) > MAX_LEVELS:
            oldest = next(iter(levels))
            del levels[oldest]
            self._foreign.pop(oldest, None)

    def _read(self) -> dict[str, dict[Trial, Record]]:
        if self._levels is None:
            there = read_state(self.path)
            self._take(there)
            self._fault = "" if there else state_fault(self.path)
        assert self._levels is not None
        return self._levels

    def _take(self, tree: Mapping[str, Any]) -> None:
        """Take over the content of the file."""
        read = {sha256: _parse(told) for sha256, told in tree.items()}
        self._levels = {sha256: trials for sha256, (trials, _) in read.items()}
        self._foreign = {sha256: others for sha256, (_, others) in read.items() if others}


def _state_of(path: Path) -> tuple[int, int, int] | None:
    """Return what changes whenever a file does; None where it is absent."""
    try:
        return _told(path.stat())
    except OSError:
        return None


def _told(found: os.stat_result) -> tuple[int, int, int]:
    return found.st_ino, found.st_size, found.st_mtime_ns


def _tree(levels: Mapping[str, dict[Trial, Record]], foreign: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of the file."""
    return {
        sha256: _told_of(records, foreign.get(sha256, [])) for sha256, records in levels.items()
    }


def _told_of(records: Mapping[Trial, Record], others: Any) -> Any:
    """Return what the file shall have of a level; what was not understood is as it was."""
    if not isinstance(others, list):
        if not records:
            return others
        others = [others]
    return [*([*dataclasses.astuple(t), r.attempts, r.solved] for t, r in records.items()), *others]


def _parse(told: Any) -> tuple[dict[Trial, Record], Any]:
    """Return the file's results of a level, and its other entries about it."""
    known: dict[Trial, Record] = {}
    others: list[Any] = []
    for entry in told if isinstance(told, list) else [told]:
        rows = _first_version(entry) if isinstance(entry, dict) else [entry]
        read = list(filter(None, map(_row, rows)))
        known = dict(read) | known
        others += [] if len(read) == len(rows) else [entry]
    return known, told if others and not known else others


def _first_version(told: Mapping[str, Any]) -> list[Any]:
    """Return the rows of what the first version wrote: a pair by the player's name."""
    return [
        [name, "", "", False, 0, *pair] if isinstance(pair, list) else pair
        for name, pair in told.items()
    ]


def _row(row: Any) -> tuple[Trial, Record] | None:
    if not isinstance(row, list) or tuple(map(type, row)) not in (_ROW, _ROW_WITHOUT_CARD):
        return None
    *trial, attempts, solved = row
    if not 0 <= solved <= attempts:
        return None
    names = [field.name for field in dataclasses.fields(Trial)]
    return Trial(**dict(zip(names, trial, strict=False))), Record(attempts=attempts, solved=solved)
