"""The directory of a run: who may begin or go on there, and what is left over in it."""

import dataclasses
import json
import os
import shutil
from pathlib import Path
from typing import Any

from kinetix.agents.agent import load_agent
from kinetix.agents.checkpoint import RUN_CHECKPOINTS
from kinetix.agents.networks.config import NetworkConfig
from kinetix.errors import CheckpointError, KinetixError
from kinetix.files.regular import read_text
from kinetix.training.config import RESUMABLE, PpoConfig
from kinetix.training.logging import UPDATE, read_metrics
from kinetix.training.settings import (
    CONFIG,
    NETWORK,
    as_table,
    loads_config,
    make_config,
    toml_value,
)
from kinetix.wording import thousands

_MANY = 3
"""Missing values that a sentence names; further ones are only counted."""


def check_same_run(out: Path, algorithm: str, config: PpoConfig) -> str:
    """Refuse to go on with a run under other hyper-parameters than it began with.

    Args:
        out: The run's directory.
        algorithm: What trains now.
        config: What it would train with.

    Returns:
        A sentence about another length, which is allowed; empty where it is the same.

    Raises:
        KinetixError: The run is another one, or the directory holds something else.
    """
    path = out / CONFIG
    if not os.path.isfile(path):
        if not all(_may_lie_there(entry) for entry in out.iterdir()):
            raise KinetixError(f"{out}: is not empty and holds no training run")
        return ""
    name, values = loads_config(read_text(path, "run"), str(path))
    before = make_config(name, values=values)
    if name != algorithm:
        raise KinetixError(f"{out}: this run was started with {name}, not {algorithm}")
    length = ""
    for field in dataclasses.fields(config):
        old, new = getattr(before, field.name), getattr(config, field.name)
        if field.name == "total_timesteps" and old != new:
            falls = config.anneal_lr or config.warmup_lr
            rate = "; the learning rate goes on as in a run of that length" if falls else ""
            length = f"total_timesteps was {thousands(old)}, now it is {thousands(new)}{rate}"
        if field.name not in RESUMABLE and old != new:
            raise KinetixError(
                f"{path}: this run was started with {_differing(field.name, old, new)}; choose "
                "another directory"
            )
    return length


def unnamed_fields(out: Path, config: PpoConfig) -> str:
    """Return a sentence about values that a run's file does not name; empty where it names all.

    Args:
        out: The run's directory.
        config: What it trains with now.
    """
    path = out / CONFIG
    if not os.path.isfile(path):
        return ""
    _, named = loads_config(read_text(path, "run"), str(path))
    content = as_table(config)
    content |= content.pop(NETWORK)
    missing = [
        f"{name} = {toml_value(value)}"
        for name, value in content.items()
        if value is not None and name not in named
    ]
    if not missing:
        return ""
    rest = len(missing) - _MANY
    more = f" and {rest} more" if rest > 0 else ""
    return (
        f"{path}: does not say {', '.join(missing[:_MANY])}{more}; another version wrote "
        "it, or somebody by hand: it is trained with these from now on"
    )


def _may_lie_there(path: Path) -> bool:
    """Return whether a run may begin where this file is: hidden, or what a training prints."""
    return path.name.startswith(".") or path.suffix == ".log"


def _differing(name: str, old: Any, new: Any) -> str:
    """Return the first field in which two configurations differ, inside the network's too."""
    if isinstance(old, NetworkConfig) and isinstance(new, NetworkConfig):
        for field in dataclasses.fields(old):
            a, b = getattr(old, field.name), getattr(new, field.name)
            if a != b:
                return _differing(f"{name}.{field.name}", a, b)
    old, new = (json.dumps(value, ensure_ascii=False) for value in (old, new))
    return f"{name} = {old}, now it is {new}"


def refuse_lost_checkpoints(out: Path, config: PpoConfig) -> None:
    """Refuse to start over where a run has come further than its first checkpoint.

    Args:
        out: The run's directory, in which there is no checkpoint.
        config: The run's configuration.

    Raises:
        KinetixError: The run has come further; a kill before the first checkpoint leaves fewer
            rows.
    """
    done = max((row[UPDATE] for row in read_metrics(out)), default=0)
    if done > (config.checkpoint_save_freq or config.num_updates):
        raise KinetixError(
            f"{out}: has the metrics of {done:.0f} updates and no checkpoint, and a new start "
            "would overwrite the run; bring its checkpoints back, or choose another directory"
        )


def unreadable_agent(checkpoint: Path) -> str:
    """Return what is wrong with an agent, or nothing.

    Args:
        checkpoint: Its directory.
    """
    try:
        load_agent(checkpoint)
    except CheckpointError as error:
        return f"damaged agent: {error}"
    return ""


def clear_leftovers(out: Path) -> None:
    """Remove what kills have left half written.

    Args:
        out: The run's directory, locked.
    """
    for folder in (out, out / RUN_CHECKPOINTS):
        for path in [*folder.glob(".*.tmp"), *folder.glob(".*.old")]:
            if os.path.isdir(path):
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
