"""Names and digests of players: of a training run by run and step; by parameters and card."""

import dataclasses
import hashlib
import re
from pathlib import Path
from typing import Final

import msgspec

from kinetix.agents.checkpoint import RUN_CHECKPOINTS
from kinetix.agents.player import Player

_SEED: Final = re.compile(r"seed_\d+")
"""Folder of one of several runs that differ by their seeds; others are called the same."""
_CARD_DIGITS: Final = 16
"""Length of a card's digest."""


def name_in_run(checkpoint: Path) -> str:
    """Return what the agent of a training run's checkpoint is called: `goalkeeper@40960`.

    Args:
        checkpoint: The checkpoint's directory.

    Returns:
        The run's folder and the environment steps, `lr=1e-3/seed_0@64` where the run is one of
        several seeds; empty where it belongs to no run.
    """
    folder = checkpoint.resolve()
    if folder.parent.name != RUN_CHECKPOINTS or not folder.name.isdigit():
        return ""
    run = folder.parent.parent
    name = f"{run.parent.name}/{run.name}" if _SEED.fullmatch(run.name) else run.name
    return f"{name}@{folder.name}"


def digest_of(player: Player) -> str:
    """Return SHA-256 of a player's parameters; empty for players that have none."""
    return getattr(player, "digest", "")


def card_digest_of(player: Player) -> str:
    """Return a digest of everything in a card that affects play; empty for scripted players.

    Its name, description, training and results do not count; nor does its physics, instead of
    which it may be measured under another one.
    """
    if not digest_of(player):
        return ""
    card = player.card
    told = (
        card.observation,
        card.action,
        card.capacity,
        dataclasses.asdict(card.network),
        msgspec.structs.replace(card.environment, physics=""),
        card.normalisation,
    )
    whole = hashlib.sha256(msgspec.json.encode(told, order="sorted"))
    return whole.hexdigest()[:_CARD_DIGITS]
