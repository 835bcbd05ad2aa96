"""The stored states of a run: the two newest, each with a digest; the newest sound one resumes."""

import itertools
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import msgspec

from kinetix.agents.checkpoint import CARD, RUN_CHECKPOINTS, steps_of_run
from kinetix.agents.directories import bring_back
from kinetix.errors import KinetixError
from kinetix.files.json_text import read_json
from kinetix.files.names import first_free
from kinetix.training.state import STATE, load_state, save_state
from kinetix.wording import misfit

PROGRESS: Final = "progress.json"
"""Beside `state/`: how many updates are done, how long they took, and the state's digest."""
KEPT_STATES: Final = 2
"""Of older checkpoints only the agent stays."""
DAMAGED: Final = ".damaged"
"""Ends the name of a checkpoint that could not be read; nothing looks at it again."""


class StoredProgress(msgspec.Struct, frozen=True, kw_only=True):
    """Content of `progress.json`."""

    updates: int
    seconds: float
    digest: str = ""
    """SHA-256 of the state; empty in runs of older versions."""
    levels: str = ""
    """SHA-256 of the listed levels or demonstrations that were trained on; empty where levels are
    drawn."""

    def on_others(self, levels: str) -> bool:
        """Return whether it is known that other levels were trained on.

        Args:
            levels: SHA-256 of those of now.
        """
        return bool(self.levels) and self.levels != levels


def write_state(directory: Path, state: Any, progress: StoredProgress) -> None:
    """Write a state and what it belongs to.

    Args:
        directory: The checkpoint.
        state: Any pytree of numpy arrays.
        progress: How far the run is; the state's digest is added.
    """
    progress = msgspec.structs.replace(progress, digest=save_state(directory, state))
    (directory / PROGRESS).write_bytes(msgspec.json.encode(progress))


def read_newest(
    out: Path, like: Callable[[], Any], say: Callable[[str], None], *, levels: str = ""
) -> tuple[Any, StoredProgress, list[Path]] | None:
    """Read the newest state that is sound.

    Args:
        out: The run's directory.
        like: Makes a state of the same structure, or its shapes.
        say: Takes a sentence about each checkpoint that cannot be read.
        levels: SHA-256 of the levels of now, on which the shapes of a state depend.

    Returns:
        The state, its progress and the damaged checkpoints that are newer; None in a run that has
        no checkpoint yet.

    Raises:
        KinetixError: There are checkpoints, and none has a state that can be read, or that fits the
            levels of now.
    """
    folders = [out / RUN_CHECKPOINTS / str(step) for step in reversed(_all_steps(out))]
    damaged: list[Path] = []
    changed = False
    for folder in folders:
        if os.path.isfile(folder / CARD) and not os.path.isdir(folder / STATE):
            continue  # an older agent, whose state made room
        try:
            progress = _read_progress(folder)
            changed |= progress.on_others(levels)
            state = _read_state(folder, like(), progress)
        except KinetixError as error:
            say(f"{'checkpoint of other levels' if changed else 'damaged checkpoint'}: {error}")
            damaged.append(folder)
            continue
        newer = folders.index(folder) - len(damaged)
        if newer:
            say(f"{newer} newer checkpoints have no training state; they will be made again")
        return state, progress, damaged
    if not folders:
        return None
    if changed:
        raise KinetixError(
            f"{out}: the files of the levels have changed since the last checkpoint, and what is "
            "stored of the training does not fit them or is damaged: bring the former ones back, "
            f"or choose another directory, with --from {out} to start from its newest agent"
        )
    raise KinetixError(
        f"{out}: none of its training states can be read, being damaged or of another version of "
        "Kinetix, and a new start would overwrite the run; choose another directory, with "
        f"--from {out} to start from its newest agent"
    )


def _read_progress(folder: Path) -> StoredProgress:
    path = folder / PROGRESS
    tree = read_json(path, "run")
    try:
        progress = msgspec.convert(tree, StoredProgress)
    except msgspec.ValidationError as error:
        raise KinetixError(f"{path}: {misfit(error)}") from None
    if progress.updates < 1:
        raise KinetixError(f"{path}: $.updates: expected a number from 1")
    return progress


def _read_state(folder: Path, like: Any, progress: StoredProgress) -> Any:
    state, digest = load_state(folder, like)
    if progress.digest and digest != progress.digest:
        raise KinetixError(f"{folder / STATE}: the arrays are not those that {PROGRESS} names")
    return state


def put_aside(damaged: list[Path]) -> None:
    """Rename checkpoints that cannot be read, so that they are neither used nor overwritten.

    Args:
        damaged: The checkpoints.
    """
    for folder in damaged:
        folder.rename(damaged_name(folder))


def damaged_name(path: Path) -> Path:
    """Return a free name beside a file or folder that cannot be read."""
    numbers = itertools.chain(("",), itertools.count(2))
    return first_free(path.with_name(f"{path.name}{DAMAGED}{number}") for number in numbers)


def recover(out: Path) -> None:
    """Bring checkpoints back that a kill left without their name.

    Args:
        out: The run's directory, locked.
    """
    for former in (out / RUN_CHECKPOINTS).glob(".*.old"):
        bring_back(former.with_name(former.name.split(".")[1]))


def forget_older(out: Path) -> None:
    """Delete all states but the newest ones; the agents themselves are kept.

    Args:
        out: The run's directory.
    """
    for step in steps_of_run(out)[:-KEPT_STATES]:
        shutil.rmtree(out / RUN_CHECKPOINTS / str(step) / STATE, ignore_errors=True)


def _all_steps(out: Path) -> list[int]:
    """Return the steps of all checkpoints, also of those that lack their description."""
    folder = out / RUN_CHECKPOINTS
    if not os.path.isdir(folder):
        return []
    names = [path.name for path in folder.iterdir() if os.path.isdir(path)]
    return sorted(int(name) for name in names if name.isascii() and name.isdecimal())
