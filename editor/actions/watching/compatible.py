"""Known agents that can play a level, by their descriptions."""

import functools
from pathlib import Path

from editor.actions.watching.agents import known_agents
from editor.agents.viewer import mismatch
from editor.session import Session
from editor.worker.requests import BUILT_IN
from kinetix.agents.card import AgentCard, read_card
from kinetix.errors import CheckpointError
from kinetix.level.model import Level
from kinetix.level.sizes import capacity_of
from kinetix.paths import user_agents_dir

_DESCRIPTION = "agent.json"


def compatible_agents(session: Session, level: Level) -> tuple[str, ...]:
    """Return names of the agents that can play a level: the app's own, recent and loaded ones."""
    found = []
    for path, label in known_agents(session):
        card = None if path in BUILT_IN else _card_of(Path(path))
        if card is not None and card.sees(capacity_of(level)):
            found.append(card.name or label)
    for summary in session.viewer.agents:
        able = summary.any_size or not mismatch(summary, level)
        if able and summary.ref.path not in BUILT_IN:
            found.append(summary.name)
    return tuple(dict.fromkeys(found))


def agents_stamp() -> int:
    """Return a number that changes when an agent of the user's own comes, goes or is renamed."""
    try:
        return user_agents_dir().stat().st_mtime_ns
    except OSError:
        return 0


def _card_of(folder: Path) -> AgentCard | None:
    """Return an agent's description of itself; None if it cannot be read."""
    try:
        return _card(folder / _DESCRIPTION, (folder / _DESCRIPTION).stat().st_mtime_ns)
    except OSError:
        return None


@functools.lru_cache(maxsize=64)
def _card(path: Path, stamp: int) -> AgentCard | None:
    del stamp  # part of the key only: a changed description is read again
    try:
        return read_card(path)[0]
    except CheckpointError:
        return None
