"""Demonstrations on disk: where episodes begin, and the actions that win them.

What an agent sees is not stored: it is computed anew when somebody learns from the data, so one
shard serves every kind of observation, is small, and proves itself each time it is played.
"""

import dataclasses
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import jax
import numpy as np
from jaxtyping import Int

from kinetix.engine.spec import Capacity
from kinetix.environment.params import (
    StaticEnvParams,
    physics_engine,
    static_env_params_of,
)
from kinetix.environment.state import EnvState, state_of
from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.files.regular import FileError
from kinetix.level.atomic import write_atomically
from kinetix.level.compile import empty_scene

FORMAT: Final = "kinetix-demonstrations"
VERSION: Final = 1
SUFFIX: Final = ".npz"
_MOVING: Final = ("position", "rotation", "velocity", "angular_velocity")
"""Fields of the physics that are stored; contacts and impulses begin at nothing."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Origin:
    """The things that all episodes of a shard have in common."""

    capacity: Capacity
    physics: str
    """Preset or solver under which they were won."""
    frame_skip: int

    @property
    def static_env_params(self) -> StaticEnvParams:
        """Of an environment in which they are played."""
        return static_env_params_of(self.capacity, frame_skip=self.frame_skip, physics=self.physics)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Demonstration:
    """One episode."""

    state: EnvState
    """First state, as numpy arrays."""
    actions: Int[np.ndarray, "k 6"]
    """Multi-discrete, one per environment step, up to the winning one."""
    number: int = -1
    """Of the level in its data set; −1 where there is none."""
    rounds: int = 0
    """Rounds of search that it took; 0 where nothing was searched."""


def write_shard(path: Path, origin: Origin, episodes: Sequence[Demonstration]) -> None:
    """Write episodes as one NumPy archive.

    Its arrays: `about` (JSON: format, version, capacity, physics, frame_skip), `state/…` (where
    episodes begin, axis 0 episodes), `action` (rows of all episodes, one after the other), `first`
    (where each one's rows begin, and the end), `number`, `rounds`.
    """
    about = {
        "format": FORMAT,
        "version": VERSION,
        "capacity": dataclasses.asdict(origin.capacity),
        "physics": origin.physics,
        "frame_skip": origin.frame_skip,
    }
    named = [_named(episode.state) for episode in episodes]
    arrays = {name: np.stack([each[name] for each in named]) for name in named[0]}
    lengths = [len(episode.actions) for episode in episodes]
    arrays |= {
        "about": np.array(json.dumps(about)),
        "action": np.concatenate([episode.actions for episode in episodes]).astype(np.int8),
        "first": np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64),
        "number": np.array([episode.number for episode in episodes], np.int64),
        "rounds": np.array([episode.rounds for episode in episodes], np.int32),
    }
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # pyright: ignore[reportArgumentType]
    write_atomically(path, packed.getvalue())


def read_shard(path: Path) -> tuple[Origin, list[Demonstration]]:
    """Read episodes that `write_shard` wrote.

    Raises:
        KinetixError: The file is missing, damaged, of another kind, or of a newer version.
    """
    try:
        arrays = read_npz(path, "demonstrations")
    except FileError as error:
        raise KinetixError(f"{path}: expected demonstrations: {error.reason}") from error
    try:
        origin = _origin(json.loads(str(arrays["about"])), path)
        states = _states(origin, arrays)
        actions, first = arrays["action"], arrays["first"]
        count = len(arrays["number"])
        if actions.ndim != 2 or actions.shape[1] != 6 or not np.all((actions >= 0) & (actions < 3)):
            raise ValueError("action holds something that is no action")
        if len(first) != count + 1 or first[-1] != len(actions) or np.any(np.diff(first) < 1):
            raise ValueError("first and action do not belong together")
        return origin, [
            Demonstration(
                state=jax.tree.map(lambda x, k=k: x[k], states),
                actions=actions[first[k] : first[k + 1]],
                number=int(arrays["number"][k]),
                rounds=int(arrays["rounds"][k]),
            )
            for k in range(count)
        ]
    except KeyError as error:
        raise KinetixError(f"{path}: expected demonstrations: {error} is missing") from error
    except (ValueError, TypeError) as error:
        raise KinetixError(f"{path}: expected demonstrations: {error}") from error


def _origin(about: Any, path: Path) -> Origin:
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        raise ValueError("its `about` is of another format")
    if about["version"] > VERSION:
        raise KinetixError(
            f"{path}: version {about['version']} of {FORMAT}; this program reads up to {VERSION}"
        )
    return Origin(
        capacity=Capacity(**about["capacity"]),
        physics=str(about["physics"]),
        frame_skip=int(about["frame_skip"]),
    )


def _states(origin: Origin, arrays: dict[str, np.ndarray]) -> EnvState:
    """All first states, with a leading axis, as numpy arrays."""
    engine = physics_engine(origin.static_env_params)
    one = jax.tree.map(np.asarray, state_of(empty_scene(engine.spec, engine.solver)))
    count = len(arrays["number"])
    wanted = _named(one)
    for name, template in wanted.items():
        shape = (count, *template.shape)
        if arrays[name].shape != shape:
            raise ValueError(f"{name} has the shape {arrays[name].shape}, not {shape}")

    def filled(path: Any, leaf: np.ndarray) -> np.ndarray:
        stored = arrays.get(_name(path))
        if stored is None:
            return np.broadcast_to(leaf, (count, *leaf.shape))
        return stored.astype(leaf.dtype)

    return jax.tree_util.tree_map_with_path(filled, one)


def _named(state: EnvState) -> dict[str, np.ndarray]:
    """Return the arrays of a state that are stored, by name."""
    leaves = jax.tree_util.tree_flatten_with_path(state)[0]
    named = {_name(path): np.asarray(leaf) for path, leaf in leaves}
    physics = "state/physics/"
    stored = {f"{physics}{name}" for name in _MOVING}
    return {k: v for k, v in named.items() if not k.startswith(physics) or k in stored}


def _name(path: Any) -> str:
    parts = (str(getattr(part, "name", getattr(part, "key", part))) for part in path)
    return "/".join(("state", *parts))
