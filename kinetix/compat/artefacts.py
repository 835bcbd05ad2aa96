"""kinetix-env's traffic with Weights & Biases: runs, and parameters as artefacts.

Parameters are safetensors, in artefacts too. Wherever the name of an artefact is expected, a folder
or file of this machine does as well. Pickles are never read.
"""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from kinetix.compat.config import get_tags
from kinetix.compat.saving import load_params, save_pretrained_checkpoint
from kinetix.errors import CheckpointError
from kinetix.training.wandb import wandb_package

WEIGHTS: Final = "params.safetensors"
CONFIG: Final = "config.json"
_FOLDER: Final = "checkpoints"
"""Folder of `save_model`, unless `save_path` names another."""


def init_wandb(config: Mapping[str, Any], name: str) -> Any:
    """Begin a run of Weights & Biases and return it.

    Args:
        config: `wandb_project`, `wandb_entity`, `group_name`, `run_name`; `use_wandb` false keeps
            everything on this machine.
        name: Of the algorithm, a tag of the run.

    Raises:
        KinetixError: The package is not installed.
    """
    return wandb_package().init(
        project=config.get("wandb_project"),
        entity=config.get("wandb_entity"),
        group=config.get("group_name"),
        name=config.get("run_name"),
        config=dict(config),
        tags=get_tags(config, name),
        mode="online" if config.get("use_wandb", True) else "disabled",
    )


def load_params_from_wandb_artifact_path(checkpoint_name: str) -> dict[str, Any]:
    """Return the parameters of an artefact, or of a folder or file of this machine.

    Raises:
        CheckpointError: The artefact holds no safetensors.
        KinetixError: The name is not a path, and wandb is not installed or cannot fetch it.
    """
    return _params_in(_folder(checkpoint_name, None))


def load_train_state_from_wandb_artifact_path(
    train_state: Any,
    checkpoint_name: str,
    load_only_params: bool = False,
    specific_dir: str | None = None,
    return_extra: bool = False,
) -> Any:
    """Return a train state with the parameters of an artefact; its optimiser is as it was.

    Args:
        train_state: Flax's.
        checkpoint_name: The artefact, or a folder or file of this machine.
        load_only_params: Taken for kinetix-env's sake: nothing but parameters is stored.
        specific_dir: Where an artefact is downloaded to.
        return_extra: Return the train state and, as a dictionary, what else was saved.

    Raises:
        CheckpointError: The artefact holds no safetensors, or parameters of another network.
    """
    del load_only_params
    folder = _folder(checkpoint_name, specific_dir)
    params = _params_in(folder)
    _check_same_tree(train_state.params, params, checkpoint_name)
    train_state = train_state.replace(params=params)
    if not return_extra:
        return train_state
    file = folder / CONFIG
    return train_state, json.loads(file.read_text()) if os.path.isfile(file) else {}


def save_params_to_wandb(params: Mapping[str, Any], timesteps: int, config: Any) -> None:
    """Write parameters and send them as an artefact of the run that is under way."""
    save_model(None, timesteps, config, save_to_wandb=True, params=params)


def save_model(
    train_state: Any,
    timesteps: int,
    config: Mapping[str, Any],
    is_final: bool = False,
    save_to_wandb: bool = False,
    extra: Mapping[str, Any] | None = None,
    *,
    params: Mapping[str, Any] | None = None,
) -> Path:
    """Write parameters as safetensors and return their folder.

    Args:
        train_state: Has `params`.
        timesteps: Environment steps so far; part of the folder's name.
        config: `save_path` and `run_name` say where; by default `checkpoints/`.
        is_final: Call the folder `final`.
        save_to_wandb: Send the folder as an artefact of the run that is under way.
        extra: Written beside the parameters, as far as JSON can say it.
        params: Instead of those of the train state.
    """
    run = str(config.get("run_name") or "model")
    folder = (
        Path(config.get("save_path") or _FOLDER) / run / ("final" if is_final else str(timesteps))
    )
    chosen = train_state.params if params is None else params
    save_pretrained_checkpoint(chosen, extra or {}, folder)
    if save_to_wandb:
        wandb = wandb_package()
        artefact = wandb.Artifact(
            f"{run}-checkpoint", type="checkpoint", metadata={"timesteps": timesteps}
        )
        artefact.add_dir(str(folder))
        artefact.save()
    return folder


def _folder(name: str, target: str | None) -> Path:
    """Return the folder or file of a checkpoint; what is not on this machine is downloaded."""
    if os.path.exists(Path(name)):
        return Path(name)
    return Path(wandb_package().Api().artifact(name).download(root=target))


def _params_in(folder: Path) -> dict[str, Any]:
    if os.path.isfile(folder):
        return load_params(folder)
    named = folder / WEIGHTS
    found = [named] if os.path.isfile(named) else sorted(folder.glob("*.safetensors"))
    if len(found) != 1:
        raise CheckpointError(
            f"{folder}: expected one file {WEIGHTS}, found {len(found)} (pickles are not read)"
        )
    return load_params(found[0])


def _check_same_tree(have: Any, got: Any, name: str) -> None:
    import jax

    shapes = [jax.tree.map(lambda x: tuple(x.shape), tree) for tree in (have, got)]
    if shapes[0] != shapes[1]:
        raise CheckpointError(
            f"{name}: its parameters are not those of this network; make_network_from_config with "
            "the configuration that it was trained with makes the right one"
        )
