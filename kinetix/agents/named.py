"""Players by name: those that need no checkpoint, and agents from anywhere."""

from pathlib import Path
from typing import Final

from kinetix.agents.agent import load_agent
from kinetix.agents.planner.player import Planner
from kinetix.agents.player import PLANNER, Player
from kinetix.agents.scripted import SCRIPTED, ScriptedPlayer
from kinetix.errors import CheckpointError

BUILT_IN: Final = (PLANNER, *SCRIPTED)
"""Names of the players that need no checkpoint."""
SOLUTION: Final = "solution"
"""Word of `kinetix play` and `kinetix render` for what a level has recorded."""


def load_player(name: str | Path) -> Player:
    """Return the player that a name or a folder means.

    Args:
        name: `planner`, `noop` or `random`; otherwise as for `load_agent`.

    Raises:
        CheckpointError: The name means no player, or one that is damaged or does not fit; one
            sentence.
    """
    if not str(name):
        raise CheckpointError('"": expected an agent, got an empty word')
    if name == SOLUTION:
        raise CheckpointError(
            f"{SOLUTION}: is no agent; `kinetix play` and `kinetix render` take it for what a "
            "level has recorded"
        )
    if name == PLANNER:
        return Planner()
    return ScriptedPlayer(str(name)) if name in SCRIPTED else load_agent(name)
