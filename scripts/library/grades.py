"""Difficulty of levels: from measurements to tags; and how often players win them."""

import dataclasses
import json
from pathlib import Path
from typing import Any, Final

from kinetix.level.codec import level_hash
from kinetix.level.model import Level

MEASURED: Final = Path(__file__).with_name("difficulty.json")
"""Measurements of `scripts.difficulty`."""
PLAYED: Final = Path(__file__).with_name("played.json")
"""Measurements of `scripts.player_win_rates`."""
STEPS: Final = (4, 16, 64, 512)
"""Plans that levels of the difficulties 1 to 4 need at most; more is 5."""
TAG: Final = "difficulty-"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Effort:
    """Effort of a search that wins a level."""

    level: str
    """Hash of the level that was measured."""
    plans: int
    """Random plans played."""
    lucky: int
    """Plans that won."""
    passes: int
    """Passes of the search after that, each as dear as the random plans; 0 where some won."""

    @property
    def needed(self) -> float:
        """Plans a win takes on average."""
        return self.plans / self.lucky if self.lucky else self.plans * (1 + self.passes)

    @property
    def difficulty(self) -> int:
        """1 (trivial) to 5 (hard)."""
        return 1 + sum(self.needed > most for most in STEPS)

    def tree(self) -> dict[str, Any]:
        """Return the values for JSON."""
        return dataclasses.asdict(self)


def read_efforts() -> dict[str, Effort]:
    """By level, such as `s/hang_on`."""
    if not MEASURED.exists():
        return {}
    return {name: Effort(**tree) for name, tree in json.loads(MEASURED.read_text()).items()}


def write_efforts(efforts: dict[str, Effort]) -> None:
    """One line a level, in order."""
    rows = [f'"{name}": {json.dumps(effort.tree())}' for name, effort in sorted(efforts.items())]
    MEASURED.write_text("{\n" + ",\n".join(rows) + "\n}\n")


def graded(level: Level, effort: Effort | None) -> Level:
    """Return the level with the difficulty that was measured, if it was measured as it is."""
    if effort is None or effort.level != level_hash(level):
        return level
    tag = f"{TAG}{effort.difficulty}"
    return level.replace(tags=tuple(tag if t.startswith(TAG) else t for t in level.tags))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Played:
    """Shares of attempts that players win."""

    level: str
    """Hash of the level that was measured."""
    rates: dict[str, float]
    """Share of attempts that were won, by player."""


def read_played() -> dict[str, Played]:
    """By level, such as `s/hang_on`."""
    if not PLAYED.exists():
        return {}
    return {name: Played(**tree) for name, tree in json.loads(PLAYED.read_text()).items()}


def write_played(played: dict[str, Played]) -> None:
    """One line a level, in order."""
    rows = [
        f'"{name}": {json.dumps(dataclasses.asdict(each))}' for name, each in sorted(played.items())
    ]
    PLAYED.write_text("{\n" + ",\n".join(rows) + "\n}\n")
