"""Our checkpoints: a directory with `agent.json` and `params/`. Nothing in it can execute."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kinetix.agents.arrays import (
    Tree,
    check_inside,
    compare_shapes,
    digest,
    flatten,
    read_arrays,
    write_arrays,
)
from kinetix.agents.card import AgentCard, EnvironmentCard, Inventory, read_card, write_card
from kinetix.agents.directories import replacing_directory
from kinetix.agents.from_card import normalised_widths, parameter_shapes
from kinetix.engine.presets import solver_named
from kinetix.errors import CheckpointError, KinetixError

CARD = "agent.json"
PARAMS = "params"
RUN_CHECKPOINTS = "checkpoints"
"""Folder of a training run's checkpoints, one directory per step."""


def write_checkpoint(
    directory: Path,
    card: AgentCard,
    params: Tree,
    *,
    extra: Callable[[Path], None] | None = None,
    replace: bool = False,
) -> None:
    """Write a checkpoint: complete or not at all.

    Everything is written under a temporary name beside the target and renamed at the end. An
    existing checkpoint of that name is replaced.

    Args:
        directory: The checkpoint.
        card: The agent's description.
        params: Its parameters (the tree below "params").
        extra: Writes what lies beside them, into the directory that it is given.
        replace: Whether a folder that holds no agent is replaced too.

    Raises:
        CheckpointError: The target is not a checkpoint, or cannot be written.
    """
    if os.path.exists(directory) and not os.path.isdir(directory):
        raise CheckpointError(f"{directory}: expected a folder, got a file; choose another place")
    replaced = replace or os.path.isfile(directory / CARD)
    if os.path.exists(directory) and any(directory.iterdir()) and not replaced:
        raise CheckpointError(f"{directory}: is not empty and holds no agent; choose another place")
    shapes = {name: tuple(leaf.shape) for name, leaf in flatten(params)}
    with replacing_directory(directory) as temporary:
        write_arrays(temporary / PARAMS, params)
        if extra is not None:
            extra(temporary)
        write_card(temporary / CARD, card, Inventory(shapes=shapes, digest=digest(params)))


def read_checkpoint(
    directory: Path, accept: Callable[[AgentCard], None] | None = None
) -> tuple[AgentCard, dict[str, Any]]:
    """Read a checkpoint.

    Args:
        directory: The checkpoint.
        accept: Looks at the description before any array is read; raises if it does not fit.

    Returns:
        The agent's description and its parameters.

    Raises:
        CheckpointError: Something in it is missing, damaged or does not fit; one sentence.
    """
    check_inside(directory)
    card, inventory = read_card(directory / CARD)
    check_environment(directory / CARD, card.environment)
    if accept is not None:
        accept(card)
    expected = expected_shapes(directory / CARD, card)
    _check_normalisation(directory / CARD, card)
    leaves = {name: leaf.shape for name, leaf in flatten(expected)}
    compare_shapes(directory / CARD, leaves, inventory.shapes)
    params = read_arrays(directory / PARAMS, expected)
    if digest(params) != inventory.digest:
        raise CheckpointError(
            f"{directory / PARAMS}: the parameters are not those that {CARD} was written for"
        )
    return card, params


def expected_shapes(path: Path, card: AgentCard) -> Tree:
    """`shapes.parameter_shapes`, with errors that name the file.

    Args:
        path: The file that the description is from.
        card: The description.

    Raises:
        CheckpointError: No network can be made from the description.
    """
    try:
        return parameter_shapes(card)
    except (ValueError, TypeError, KeyError, KinetixError) as error:
        raise CheckpointError(f"{path}: no network can be made from this: {error}") from None


def check_environment(path: Path, environment: EnvironmentCard) -> None:
    """Refuse physics and parity that this program does not have.

    Args:
        path: The file, for the sentence.
        environment: The environment of its card.

    Raises:
        CheckpointError: The physics or the parity is unknown.
    """
    try:
        solver_named(environment.physics)
    except KinetixError as error:
        raise CheckpointError(f"{path}: $.environment.physics: {error}") from None
    if environment.parity not in (None, "kinetix-3"):
        raise CheckpointError(
            f'{path}: $.environment.parity: expected "kinetix-3" or null, '
            f"got {environment.parity!r}"
        )


def _check_normalisation(path: Path, card: AgentCard) -> None:
    """Compare the statistics with what the agent sees."""
    stored = card.normalisation
    if stored is None:
        return
    expected = normalised_widths(card)
    for name, by_field in (("mean", stored.mean), ("variance", stored.variance)):
        widths = {field: len(values) for field, values in by_field.items()}
        if widths != expected:
            raise CheckpointError(
                f"{path}: $.normalisation.{name}: expected columns {expected}, got {widths}"
            )
    if any(value < 0 for values in stored.variance.values() for value in values):
        raise CheckpointError(f"{path}: $.normalisation.variance: expected numbers from 0")


def steps_of_run(run: Path) -> list[int]:
    """Return steps of the complete checkpoints of a training run, ascending.

    Args:
        run: The run's directory.
    """
    folder = run / RUN_CHECKPOINTS
    if not os.path.isdir(folder):
        return []
    return sorted(
        int(path.name)
        for path in folder.iterdir()
        if path.name.isascii() and path.name.isdecimal() and os.path.isfile(path / CARD)
    )


def newest_checkpoint(directory: Path) -> Path:
    """Return the checkpoint that a directory means: itself, or the newest of a training run.

    Args:
        directory: A checkpoint or a run.

    Raises:
        CheckpointError: The directory has no checkpoint of its own.
    """
    if os.path.isfile(directory / CARD):
        return directory
    steps = steps_of_run(directory)
    if steps:
        return directory / RUN_CHECKPOINTS / str(steps[-1])
    if os.path.isdir(directory / RUN_CHECKPOINTS):
        raise CheckpointError(f"{directory}: this training run has no complete checkpoint yet")
    runs = sorted(
        path.parent
        for below in ("*", "*/seed_*")
        for path in directory.glob(f"{below}/{RUN_CHECKPOINTS}")
    )
    if runs:
        raise CheckpointError(
            f"{directory}: is a folder of runs; name one of them, such as {runs[0]}"
        )
    raise CheckpointError(
        f"{directory}: expected an agent: {CARD} with {PARAMS}/, or params.safetensors with "
        "config.json, or a training run with checkpoints/"
    )
