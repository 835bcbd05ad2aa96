"""Folders of agents and training runs: which are some, and what is in them."""

import os
from pathlib import Path
from typing import Final

from kinetix.agents.card import read_card
from kinetix.errors import CheckpointError

_AGENT_FILES: Final = ("agent.json", "params.safetensors", "config.toml")
"""A folder with one of these is an agent or a training run."""


def is_agent_folder(path: Path) -> bool:
    """Return whether a folder looks like an agent or a training run."""
    return os.path.isdir(path) and any(os.path.isfile(path / name) for name in _AGENT_FILES)


def about_agent(path: Path) -> str:
    """Return what is known of the agent in a folder, unloaded; empty where there is none."""
    if not is_agent_folder(path):
        return ""
    if is_run(path):
        return f"{path.name}: a training run; its newest agent is taken."
    try:
        card = read_card(path / _AGENT_FILES[0])[0]
    except CheckpointError:
        return path.name
    words = [card.name, card.description, f"Trained under {card.environment.physics}."]
    return "\n".join(word for word in words if word)


def is_run(path: Path) -> bool:
    """Return whether a folder is a training run's; choosing its agent watches the run too."""
    return os.path.isdir(path / "checkpoints") and os.path.isfile(path / "metrics.jsonl")


def run_of(path: Path) -> Path | None:
    """Return the training run that a checkpoint's folder belongs to; None where it is of none."""
    run = path.parent.parent
    return run if path.parent.name == "checkpoints" and is_run(run) else None


def checkpoints_of(path: Path) -> list[Path]:
    """Return the folders of all checkpoints of a run, oldest first.

    Args:
        path: The run, or one of its checkpoints.
    """
    run = path if is_run(path) else run_of(path)
    if run is None:
        return []
    folder = run / "checkpoints"
    found = [one for one in folder.glob("*") if one.name.isdecimal() and is_agent_folder(one)]
    return sorted(found, key=lambda one: int(one.name))


def agent_folder(path: Path) -> Path | None:
    """The agent that a dropped or chosen path means: itself, or the folder that a file is in."""
    if is_agent_folder(path):
        return path
    if path.name in _AGENT_FILES and os.path.isfile(path):
        return path.parent
    return None


def agents_in(folder: Path) -> list[Path]:
    """Return the folders of agents and training runs in a folder, by name."""
    return sorted(path for path in folder.glob("*") if is_agent_folder(path))
