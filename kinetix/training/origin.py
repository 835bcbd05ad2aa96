"""The agent that a run began from: kept with its configuration, told by its agents."""

import os
import tomllib
from pathlib import Path
from typing import Any, Final

from kinetix.agents.agent import Agent
from kinetix.agents.checkpoint import steps_of_run
from kinetix.errors import KinetixError
from kinetix.files.regular import read_text
from kinetix.training.progress_text import Say
from kinetix.training.settings import CONFIG, START_FROM, toml_value

_STEPS: Final = "environment_steps"


def origin_of(teacher: Agent | None) -> dict[str, Any]:
    """Return the name, the digest and, where known, the training's length of an agent.

    Args:
        teacher: The agent to start from; without one there is nothing to tell.
    """
    if teacher is None:
        return {}
    steps = teacher.card.training.get(_STEPS)
    told = {"name": teacher.card.name, "digest": teacher.digest}
    return told | ({_STEPS: steps} if type(steps) is int else {})


def dumps_origin(origin: dict[str, Any]) -> str:
    """Return what a run began from as a table of TOML; empty where there is nothing to tell."""
    if not origin:
        return ""
    lines = [f"{name} = {toml_value(value)}" for name, value in origin.items()]
    return "\n".join(["", f"[{START_FROM}]", *lines]) + "\n"


def read_origin(out: Path) -> dict[str, Any]:
    """Return what a run began from; empty where its configuration does not say.

    Args:
        out: The run's directory.

    Raises:
        KinetixError: The configuration is damaged.
    """
    path = out / CONFIG
    if not os.path.isfile(path):
        return {}
    try:
        origin = tomllib.loads(read_text(path, "run")).get(START_FROM, {})
    except (ValueError, RecursionError) as error:
        raise KinetixError(f"{path}: not valid TOML: {error}") from None
    if not isinstance(origin, dict):
        raise KinetixError(f"{path}: {START_FROM}: expected a table")
    return origin


def check_origin(out: Path, teacher: Agent | None) -> None:
    """Refuse to start a run over from another origin.

    Args:
        out: The run's directory, in which there is no checkpoint yet.
        teacher: The agent to start from now.

    Raises:
        KinetixError: It is another agent, or none.
    """
    began = read_origin(out)
    if not began or (teacher is not None and teacher.digest == began.get("digest")):
        return
    now = "none is named" if teacher is None else f"now it is {teacher.card.name!r}"
    raise KinetixError(
        f"{out}: this run was started from the agent {began.get('name')!r}, {now}, and no "
        "checkpoint was written yet: name that agent with --from, or choose another directory"
    )


def still_needed(out: Path, say: Say) -> bool:
    """Return whether a run is at its beginning, for which the agent to start from is needed.

    Args:
        out: The run's directory.
        say: Takes a sentence where it is not.
    """
    if not steps_of_run(out):
        return True
    name = read_origin(out).get("name")
    began = f", which was {name!r}" if name else ""
    say(
        f"{out}: goes on from its checkpoint; an agent to start from counts at the beginning alone"
        f"{began}"
    )
    return False
