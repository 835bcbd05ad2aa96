"""Released agents of kinetix-env: `params.safetensors` + `config.json`; never its pickles."""

import dataclasses
import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from safetensors.numpy import save_file

from kinetix.agents.arrays import check_inside, compare_shapes, flatten, unflatten
from kinetix.agents.card import (
    ActionCard,
    AgentCard,
    CapacityCard,
    EnvironmentCard,
    ObservationCard,
    read_json_object,
)
from kinetix.agents.checkpoint import check_environment, expected_shapes
from kinetix.agents.from_card import observations_of_card, static_env_params_of_card
from kinetix.agents.networks.config import NetworkConfig
from kinetix.environment.params import EnvParams
from kinetix.errors import CheckpointError, LevelError
from kinetix.files.arrays import read_tensors, tensor_shapes
from kinetix.files.atomic import replacing
from kinetix.files.regular import FileError
from kinetix.level.sizes import SIZES
from kinetix.wording import misfit

TENSORS = "params.safetensors"
CONFIG = "config.json"
_ROOT = "params/"
"""Stands in front of every tensor's name."""

_KIND_OF_OBSERVATION = {
    "symbolic_entity": "entity_transformer",
    "symbolic_flat_padded": "permutation_invariant_mlp",
    "symbolic_flat": "flat_mlp",
    "blind": "flat_mlp",
    "pixels": "cnn",
}
_OUR_ONLY = ("name", "description", "model", "observation_type", "action_type")


def is_peer_checkpoint(directory: Path) -> bool:
    """Return whether a directory holds an agent in kinetix-env's form."""
    return os.path.isfile(directory / TENSORS) and os.path.isfile(directory / CONFIG)


def read_peer_checkpoint(
    directory: Path, accept: Callable[[AgentCard], None] | None = None
) -> tuple[AgentCard, dict[str, Any]]:
    """Read an agent in kinetix-env's form.

    Args:
        directory: Holds the two files.
        accept: Looks at the description before any array is read; raises if it does not fit.

    Returns:
        The agent's description and its parameters (the tree below "params").

    Raises:
        CheckpointError: Something in it is missing, damaged or does not fit; one sentence.
    """
    check_inside(directory)
    path = directory / TENSORS
    try:
        shapes = tensor_shapes(path)
    except FileError as error:
        raise CheckpointError(str(error)) from None
    card = _card(directory / CONFIG, shapes)
    if accept is not None:
        accept(card)
    expected = {
        _ROOT + name: leaf.shape
        for name, leaf in flatten(expected_shapes(directory / CONFIG, card))
    }
    compare_shapes(path, expected, shapes)
    try:
        arrays = read_tensors(path, expected)
    except FileError as error:
        raise CheckpointError(str(error)) from None
    return card, unflatten((name.removeprefix(_ROOT), array) for name, array in arrays.items())


def write_peer_checkpoint(directory: Path, card: AgentCard, params: Mapping[str, Any]) -> None:
    """Write an agent in kinetix-env's form.

    Args:
        directory: Made if need be; the two files in it are replaced.
        card: The agent's description.
        params: Its parameters (the tree below "params").

    Raises:
        CheckpointError: The agent cannot be written.
    """
    model = dataclasses.asdict(card.network)
    model["permutation_invariant_mlp"] = model.pop("kind") == "permutation_invariant_mlp"
    config = {
        "name": card.name,
        "description": card.description,
        "model": model,
        "observation_type": card.observation.type,
        "action_type": card.action.type,
        "capacity": msgspec.to_builtins(card.capacity),
        "environment": msgspec.to_builtins(card.environment),
        "training": card.training,
        "results": card.results,
    }
    arrays = {_ROOT + name: np.ascontiguousarray(leaf) for name, leaf in flatten(params)}
    text = json.dumps(config, indent=1, ensure_ascii=False, allow_nan=False)
    write_files(directory, arrays, text)


def write_files(directory: Path, arrays: Mapping[str, np.ndarray], config: str) -> None:
    """Write the two files of an agent of kinetix-env; each holds its old or its new content.

    Other files of the folder stay, whichever folder it is.

    Args:
        directory: Made if need be.
        arrays: The parameters by name.
        config: The configuration as JSON.

    Raises:
        CheckpointError: The files cannot be written.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with (
            replacing(directory / TENSORS) as tensors,
            replacing(directory / CONFIG) as text,
        ):
            save_file(dict(arrays), tensors)
            text.write_text(config, encoding="utf-8")
    except (OSError, LevelError) as error:
        raise CheckpointError(f"{directory}: cannot be written: {error}") from error


def _card(path: Path, shapes: Mapping[str, tuple[int, ...]]) -> AgentCard:
    config = read_json_object(path)
    model = config.get("model", {})
    if not isinstance(model, dict):
        raise CheckpointError(f"{path}: $.model: expected an object, got {model!r}")
    observation = config.get("observation_type", "symbolic_entity")
    if not isinstance(observation, str) or observation not in _KIND_OF_OBSERVATION:
        raise CheckpointError(
            f"{path}: $.observation_type: expected one of {', '.join(_KIND_OF_OBSERVATION)}, "
            f"got {observation!r}"
        )
    action = config.get("action_type", "multi_discrete")
    for name in ("name", "description"):
        if not isinstance(config.get(name, ""), str):
            raise CheckpointError(f"{path}: $.{name}: expected a string")
    network = _network(path, model, observation)
    try:
        environment = msgspec.convert(
            config.get("environment", {"physics": "jax2d", "parity": "kinetix-3"}), EnvironmentCard
        )
        capacity = msgspec.convert(config.get("capacity"), CapacityCard | None)
        check_environment(path, environment)
    except msgspec.ValidationError as error:
        raise CheckpointError(f"{path}: {misfit(error)}") from None
    rest = {key: value for key, value in config.items() if key not in _OUR_ONLY}
    return AgentCard(
        name=config.get("name", path.parent.name)[:1000],
        description=config.get("description", ""),
        observation=ObservationCard(type=observation),
        action=ActionCard(type=str(action)),
        capacity=capacity or _capacity_from_tensors(path, observation, shapes),
        network=network,
        environment=environment,
        training=rest.get("training", rest) if isinstance(rest.get("training", rest), dict) else {},
        results=rest["results"] if isinstance(rest.get("results"), dict) else {},
    )


def _network(path: Path, model: Mapping[str, Any], observation: str) -> NetworkConfig:
    """Read the options leniently: unknown ones are ignored, missing ones have their defaults."""
    kind = _KIND_OF_OBSERVATION[observation]
    if model.get("permutation_invariant_mlp") and observation == "symbolic_entity":
        kind = "permutation_invariant_mlp"
    names = {field.name for field in dataclasses.fields(NetworkConfig)} - {"kind"}
    options = {name: value for name, value in model.items() if name in names}
    for override in ("depth", "width"):
        value = model.get(f"override_model_{override}")
        if value is not None:
            options |= {f"actor_{override}": value, f"critic_{override}": value}
    try:
        return msgspec.convert({"kind": kind, **options}, NetworkConfig)
    except (msgspec.ValidationError, ValueError) as error:
        raise CheckpointError(f"{path}: $.model: {misfit(error)}") from None


def _capacity_from_tensors(
    path: Path, observation: str, shapes: Mapping[str, tuple[int, ...]]
) -> CapacityCard | None:
    """Return the named size whose flat observation has the width that the first layer reads."""
    names = {
        "symbolic_flat": "params/Dense_0/kernel",
        "symbolic_flat_padded": "params/MultiHeadDense_0/dense_kernels",
    }
    if observation not in names:
        return None
    name = names[observation]
    if name not in shapes or len(shapes[name]) < 2:
        raise CheckpointError(f"{path.with_name(TENSORS)}: tensor {name!r} is missing or no matrix")
    width = shapes[name][-2]
    for size in SIZES.values():
        capacity = CapacityCard(
            polygons=size.polygons,
            circles=size.circles,
            joints=size.joints,
            thrusters=size.thrusters,
        )
        card = AgentCard(name="", observation=ObservationCard(type=observation), capacity=capacity)
        static_env_params = static_env_params_of_card(card)
        space: Any = observations_of_card(card, EnvParams(), static_env_params).space
        if space.shape[-1] == width:
            return capacity
    raise CheckpointError(
        f"{path.with_name(TENSORS)}: tensor {name!r} reads {width} numbers, which is the "
        f"observation of none of the sizes {', '.join(SIZES)}"
    )
