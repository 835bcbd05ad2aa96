"""kinetix-env's reading and writing of levels and parameters. Pickles are never read."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, get_args

import jax
import jax.numpy as jnp
import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from kinetix.agents.arrays import flatten, unflatten
from kinetix.agents.kinetix_env import write_files
from kinetix.environment.checks import check_is_state
from kinetix.environment.decompile import scene_of
from kinetix.environment.generators.params import UEDParams
from kinetix.environment.params import (
    EnvParams,
    StaticEnvParams,
    physics_engine,
    static_env_params_of,
)
from kinetix.environment.rearrange import expand_state
from kinetix.environment.reset import load_from_json_file
from kinetix.environment.state import EnvState, stack_states, state_of
from kinetix.errors import CheckpointError, KinetixError, LevelError
from kinetix.files.atomic import replacing
from kinetix.files.json_text import read_object
from kinetix.files.regular import FileError
from kinetix.level.codec import loads_document, resolve_path, save_level
from kinetix.level.compile import Scene
from kinetix.level.decompile import level_from_scene
from kinetix.level.kinetix_env.compile import compile_kinetix_env
from kinetix.level.model import InertiaModel, Level
from kinetix.level.validate import validate
from kinetix.paths import levels_dir
from kinetix.pytree import on_device

BASE_DIR: Final = str(levels_dir())
"""Folder in which names of levels are looked up."""
_WEIGHTS: Final = "params.safetensors"
_CONFIG: Final = "config.json"


def get_correct_path_of_json_level(l: str | Path) -> str:
    """Return the file that a name such as `s/first_flight` means."""
    return str(resolve_path(l))


def load_evaluation_levels(
    eval_levels: Sequence[str], static_env_params_override: StaticEnvParams | None = None
) -> tuple[EnvState, StaticEnvParams]:
    """Load levels of any sizes as one state with a leading axis.

    Args:
        eval_levels: Files, or names such as `s/first_flight`.
        static_env_params_override: The sizes of the result; by default the largest of each.

    Returns:
        The levels, and the parameters that fit them all.

    Raises:
        KinetixError: No level is given, or one does not fit.
    """
    if not len(eval_levels):
        raise KinetixError("eval_levels is empty: expected at least one level")
    loaded = [load_from_json_file(name) for name in eval_levels]
    static = static_env_params_override
    if static is None:
        capacity, first = loaded[0][1].capacity, loaded[0][1]
        for _, each, _ in loaded[1:]:
            capacity = capacity.union(each.capacity)
        static = static_env_params_of(
            capacity,
            frame_skip=first.frame_skip,
            num_motor_bindings=max(each.num_motor_bindings for _, each, _ in loaded),
            num_thruster_bindings=max(each.num_thruster_bindings for _, each, _ in loaded),
        )
    states = [
        expand_state(state, static, name=str(name))
        for name, (state, _, _) in zip(eval_levels, loaded, strict=True)
    ]
    return stack_states(states), static


def get_env_state_from_json(json_filename: str | Path) -> EnvState:
    """Load a level as a state."""
    return load_from_json_file(json_filename)[0]


def import_env_state_from_json(
    json_file: Mapping[str, Any],
) -> tuple[EnvState, StaticEnvParams, EnvParams]:
    """Return the state and the parameters that the parsed JSON of kinetix-env's format describes.

    Raises:
        LevelError: The JSON is wrong; one sentence with the JSON path.
    """
    source = loads_document(json.dumps(json_file), "json_file").source
    if source is None:
        raise KinetixError('json_file: expected kinetix-env\'s format, an object with "env_state"')
    static = StaticEnvParams(
        **{
            name: value
            for name, value in source.static.items()
            if name in StaticEnvParams.__dataclass_fields__ and name != "screen_dim"  # pyright: ignore[reportAttributeAccessIssue]
        }
    )
    engine = physics_engine(static)
    scene = compile_kinetix_env(source, spec=engine.spec, solver=engine.solver)
    return state_of(scene), static, EnvParams(**source.parameters)


def export_env_state_to_json(
    filename: str | Path,
    env_state: EnvState,
    static_env_params: StaticEnvParams,
    env_params: EnvParams,
) -> None:
    """Write a state as a level file of kinetix-env.

    Args:
        filename: The file; `.json` is added where it is missing.
        env_state: One state (not a batch); positions and speeds become those of the start.
        static_env_params: Taken for kinetix-env's sake; the state knows its sizes.
        env_params: The time limit, where the state has none.

    Raises:
        KinetixError: `env_state` is not a state, is a batch of them, or has no values, within
            `jax.jit`.
        LevelError: The state has something that no level can hold, or the file cannot be written.
    """
    del static_env_params
    path = Path(filename)
    path = path if path.suffix == ".json" else path.with_name(f"{path.name}.json")
    check_is_state(env_state, "the order is export_env_state_to_json(filename, env_state, …)")
    scene = scene_of(env_state, env_params.max_timesteps)
    path.parent.mkdir(parents=True, exist_ok=True)
    level = level_from_scene(scene, name=path.stem, inertia_model=UEDParams().inertia_model)
    save_level(level, path, format="kinetix-env")


def expand_env_state(
    env_state: EnvState, static_env_params: StaticEnvParams, ignore_collision_matrix: bool = False
) -> EnvState:
    """Return a state in more slots.

    Args:
        env_state: One state (not a batch).
        static_env_params: The sizes.
        ignore_collision_matrix: Taken for kinetix-env's sake; the matrix always follows.
    """
    del ignore_collision_matrix
    return expand_state(env_state, static_env_params)


def expand_env_states(env_state: EnvState, dst_static: StaticEnvParams) -> EnvState:
    """Return a batch of states in more slots."""
    return jax.vmap(lambda state: expand_state(state, dst_static))(env_state)


def check_if_mass_and_inertia_are_correct(
    state: EnvState, env_params: EnvParams, static_params: StaticEnvParams
) -> bool:
    """Return whether the masses and inertias of moving bodies follow from shape and density.

    They may do so by kinetix-env's rule for inertias or by ours.
    """
    del env_params, static_params
    return any(_follow(state, model) for model in get_args(InertiaModel))


def _follow(state: EnvState, inertia_model: InertiaModel) -> bool:
    scene = Scene(world=state.world, state=state.physics, labels=state.labels)
    try:
        level: Level = level_from_scene(scene, name="level", inertia_model=inertia_model)
    except LevelError:
        return False
    return all(body.mass_properties is None for body in level.bodies) and not any(
        issue.severity == "error" for issue in validate(level)
    )


def stack_list_of_pytrees(list_of_pytrees: Sequence[Any]) -> Any:
    """Return trees of equal structure as one, with a leading axis."""
    return jax.tree.map(lambda *leaves: jnp.stack(leaves), *list_of_pytrees)


def save_params(params: Mapping[str, Any], filename: str | Path) -> None:
    """Write a tree of parameters as safetensors, whatever the file's name."""
    with replacing(Path(filename)) as path:
        save_file(_arrays(params), path)


def _arrays(params: Mapping[str, Any]) -> dict[str, np.ndarray]:
    return {name: np.ascontiguousarray(leaf) for name, leaf in flatten(params)}


def load_params(filename: str | Path) -> dict[str, Any]:
    """Read a tree of parameters from a safetensors file.

    Raises:
        CheckpointError: The file is not a safetensors file; pickles are not read.
    """
    try:
        arrays = load_file(filename)
    except (SafetensorError, OSError) as error:
        raise CheckpointError(
            f"{filename}: expected a safetensors file (pickles are not read): {error}"
        ) from None
    return on_device(unflatten(arrays.items()))


def save_pretrained_checkpoint(
    params: Mapping[str, Any], config: Mapping[str, Any], checkpoint_dir: str | Path
) -> None:
    """Write `params.safetensors` and `config.json`, which `kinetix.load_agent` reads."""
    text = json.dumps(dict(config), indent=1, default=str)
    write_files(Path(checkpoint_dir), _arrays(params), text)


def load_pretrained_checkpoint(checkpoint_dir: str | Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Read `params.safetensors` and `config.json`: parameters and configuration.

    Raises:
        CheckpointError: One of the files is missing or damaged.
    """
    directory = Path(checkpoint_dir)
    try:
        config = read_object(directory / _CONFIG, "agent")
    except FileError as error:
        raise CheckpointError(str(error)) from None
    return load_params(directory / _WEIGHTS), config
