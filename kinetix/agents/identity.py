"""Names and digests of players: of a training run by run and step; by the parameters."""

from pathlib import Path

from kinetix.agents.checkpoint import RUN_CHECKPOINTS
from kinetix.agents.player import Player


def name_in_run(checkpoint: Path) -> str:
    """Return what the agent of a training run's checkpoint is called: `goalkeeper@40960`.

    Args:
        checkpoint: The checkpoint's directory.

    Returns:
        The run's folder and the environment steps; empty where it belongs to no run.
    """
    folder = checkpoint.resolve()
    if folder.parent.name != RUN_CHECKPOINTS or not folder.name.isdigit():
        return ""
    return f"{folder.parent.parent.name}@{folder.name}"


def digest_of(player: Player) -> str:
    """Return SHA-256 of a player's parameters; empty for players that have none."""
    return getattr(player, "digest", "")
