"""The layout of kinetix-env's offline data: states and actions of trajectories of 256 steps.

Fields are named as there: `action`, `done`, `action_mask`, and `env_state/` with every array of a
state. Its published shards are zarr archives; these are `.npz` files with the same fields. What the
layout has no field for, such as the physics, stands beside them in `ORIGINS`.
"""

import contextlib
import dataclasses
import io
import itertools
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np

from kinetix.datasets.episode import CONTROLS, RecordedEpisode, Source
from kinetix.engine.pairs import pair_counts
from kinetix.engine.spec import Capacity
from kinetix.environment.outcome import Outcome
from kinetix.errors import KinetixError
from kinetix.files.arrays import read_npz
from kinetix.files.atomic import write_atomically
from kinetix.files.folders import begun_folder
from kinetix.files.json_text import read_object
from kinetix.files.regular import FileError
from kinetix.level.codec import loads
from kinetix.level.kinetix_env.schema import ENV_PARAMS, KinetixContact, static_env_params
from kinetix.level.model import MOTOR_BINDINGS, Level
from kinetix.level.sizes import parse_capacity
from kinetix.wording import misfit, plural

ORIGINS: Final = "origins.json"
"""File with the origins of our own trajectories; kinetix-env's have none."""
STEPS: Final = 256
"""Environment steps in a trajectory; an episode that is over begins again."""
PREFIX: Final = "env_state/"
PER_SHARD: Final = 64
"""Trajectories in a shard: about 20 MB unpacked at size l."""
_GROUPS: Final = ("polygon", "circle", "joint", "thruster")
_ALONE: Final = (
    "collision_matrix",
    "gravity",
    "thruster_bindings",
    "motor_bindings",
    "motor_auto",
    "polygon_shape_roles",
    "circle_shape_roles",
    "polygon_highlighted",
    "circle_highlighted",
    "polygon_densities",
    "circle_densities",
    "timestep",
    "last_distance",
)


class _Origin(msgspec.Struct, frozen=True, kw_only=True):
    """Level, physics, outcome and player of a trajectory, for which that layout has no fields."""

    level: str
    physics: str
    frame_skip: int
    outcome: Outcome
    source: Source
    player: str = ""
    seed: int = 0
    attempt: int = 0
    max_timesteps: int = STEPS
    """The level's time limit."""


_KEPT: Final = tuple(
    name for name in _Origin.__struct_fields__ if name not in ("level", "max_timesteps")
)
"""Those that are an episode's own."""
_FROM_KINETIX_ENV: Final = _Origin(
    # Only successes are published there.
    level="",
    physics="jax2d",
    frame_skip=2,
    outcome="won",
    source="agent",
    player="kinetix-env",
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Written:
    """Result of writing."""

    trajectories: int
    shards: int
    left_out: tuple[str, ...]
    """A sentence per episode that was not."""


def write_offline(out: Path, episodes: Iterable[RecordedEpisode], *, size: str = "l") -> Written:
    """Write episodes in kinetix-env's layout.

    Args:
        out: A new or an empty folder.
        episodes: Those that replay; of others the states are not known.
        size: Of all states: a name or four capacities.

    Raises:
        KinetixError: The folder is not empty, another process writes to it, or it cannot be
            written.
    """
    capacity = parse_capacity(size)
    with begun_folder(out, "another export"):
        _refuse_filled(out)
        return _written(out, episodes, capacity)


def _written(out: Path, episodes: Iterable[RecordedEpisode], capacity: Capacity) -> Written:
    rows: list[dict[str, np.ndarray]] = []
    left: list[str] = []
    origins: list[_Origin] = []
    shards = 0
    for episode in episodes:
        if not episode.replays:
            left.append(
                f"{episode.level.name}: left out: played again from its controls alone, it ends "
                f"otherwise than {episode.outcome} after {plural(episode.length, 'step')}: a body "
                "was pulled at, or it was played in a step that rounds differently; record the "
                "level again with `kinetix dataset record`"
            )
            continue
        if episode.length > STEPS:
            left.append(
                f"{episode.level.name}: left out: its {episode.length} steps are more than the "
                f"{STEPS} of a trajectory in this layout"
            )
            continue
        try:
            rows.append(trajectory(episode, capacity))
        except KinetixError as error:
            left.append(f"{episode.level.name}: left out: {error}")
            continue
        origins.append(_origin(episode))
        if len(rows) == PER_SHARD:
            _write(out, shards, rows, origins)
            rows, shards = [], shards + 1
    if rows:
        _write(out, shards, rows, origins)
        shards += 1
    return Written(trajectories=len(origins), shards=shards, left_out=tuple(left))


def _origin(episode: RecordedEpisode) -> _Origin:
    level = episode.level
    own = {"level": level.name, "max_timesteps": level.max_timesteps}
    return _Origin(**own, **{name: getattr(episode, name) for name in _KEPT})


def trajectory(episode: RecordedEpisode, capacity: Any) -> dict[str, np.ndarray]:
    """Return the arrays of one trajectory, `STEPS` first.

    Args:
        episode: The episode; it is played again and again until the trajectory is full.
        capacity: Sizes of the states.

    Raises:
        KinetixError: The level does not fit, or the episode ends otherwise in such states.
    """
    from kinetix.datasets.replays import replay  # only here is JAX needed

    again = replay(episode, capacity)
    if not again.ends_as(episode):
        raise KinetixError(
            f"played again in states of this size, it ends with {again.outcome} after "
            f"{plural(again.length, 'step')}, not with {episode.outcome} after {episode.length}"
        )
    index = np.arange(STEPS) % again.length
    arrays = {name: np.asarray(value)[index] for name, value in state_arrays(again.states).items()}
    return {
        "action": episode.action[index].astype(np.int32),
        "done": index == again.length - 1,
        "action_mask": np.broadcast_to(episode.action_mask, (STEPS, CONTROLS)),
        **arrays,
    }


def state_arrays(states: Any) -> dict[str, Any]:
    """Return the arrays of a state, or a batch of them, by kinetix-env's names.

    Args:
        states: An `EnvState`.
    """
    arrays: dict[str, Any] = {}
    for group in _GROUPS:
        rows = getattr(states, group)
        for field in dataclasses.fields(rows):
            arrays[f"{PREFIX}{group}/{field.name}"] = getattr(rows, field.name)
    return arrays | {f"{PREFIX}{name}": _told(states, name) for name in _ALONE}


def _told(states: Any, name: str) -> Any:
    value = np.asarray(getattr(states, name))
    count = np.shape(np.asarray(states.timestep))
    # What is the same in all moments may have no axis of time.
    missing = len(count) and value.shape[: len(count)] != count
    return np.broadcast_to(value, (*count, *value.shape)) if missing else value


def is_offline(folder: Path) -> bool:
    """Return whether a folder's first shard that can be read has kinetix-env's fields."""
    mark = f"{PREFIX}timestep"
    for path in sorted(folder.glob("*.npz")):
        with contextlib.suppress(FileError):
            return mark in read_npz(path, "episodes", only=(mark,))
    return False


def read_offline(folder: Path) -> Iterator[RecordedEpisode]:
    """Return the first episode of every trajectory, its level taken from its first state.

    Args:
        folder: Shards (`.npz`) with the fields of kinetix-env's layout.

    Raises:
        KinetixError: The folder has no shard, or one that is damaged or holds something else.
    """
    shards = sorted(folder.glob("*.npz"))
    if not shards:
        raise KinetixError(f"{folder}: expected shards (.npz) in kinetix-env's layout, found none")
    origins = _origins(folder)
    for path in shards:
        arrays = read_npz(path, "episodes")
        try:
            for k in range(len(arrays["action"])):
                rows = {name: values[k] for name, values in arrays.items()}
                yield _episode(rows, f"{path}: trajectory {k}", next(origins))
        except KeyError as error:
            raise KinetixError(
                f"{path}: expected the fields of kinetix-env's layout: {error} is missing"
            ) from error
        except (ValueError, TypeError, IndexError) as error:
            raise KinetixError(f"{path}: expected trajectories of kinetix-env: {error}") from error


def _origins(folder: Path) -> Iterator[_Origin]:
    """Yield the origin of each trajectory of a folder; kinetix-env's where none is stored."""
    path = folder / ORIGINS
    if os.path.isfile(path):
        try:
            told = read_object(path, "set").get("trajectories")
            yield from msgspec.convert(told, list[_Origin])
        except msgspec.ValidationError as error:
            raise KinetixError(f"{path}: $.trajectories: {misfit(error)}") from None
    yield from itertools.repeat(_FROM_KINETIX_ENV)


def _episode(rows: dict[str, np.ndarray], name: str, origin: _Origin) -> RecordedEpisode:
    action, done = rows["action"], rows["done"]
    if action.ndim != 2 or action.shape[1] != CONTROLS or done.shape != action.shape[:1]:
        raise ValueError(f"action has the shape {action.shape}, expected (steps, {CONTROLS})")
    ends = np.flatnonzero(done)
    length = int(ends[0]) + 1 if len(ends) else len(action)
    motors = np.array([0.0, 1.0, -1.0], np.float32)[action[:length, :MOTOR_BINDINGS]]
    control = np.concatenate([motors, action[:length, MOTOR_BINDINGS:]], axis=1)
    reward = np.zeros(length, np.float32)
    first = {key: values[0] for key, values in rows.items() if key.startswith(PREFIX)}
    outcome = origin.outcome if len(ends) else "timeout"
    reward[-1] = {"won": 1.0, "lost": -1.0}.get(outcome, 0.0)
    level = _level(first, name).replace(max_timesteps=origin.max_timesteps)
    if origin.level:
        level = level.replace(name=origin.level)
    told = {each: getattr(origin, each) for each in _KEPT} | {"level": level, "outcome": outcome}
    return RecordedEpisode(control=control.astype(np.float32), reward=reward, replays=False, **told)


def _level(first: dict[str, np.ndarray], name: str) -> Level:
    """Return the level that a first state is of."""
    groups = {group: _rows(first, group) for group in _GROUPS}
    for group, key in (("polygon", "polygon"), ("circle", "circle")):
        roles, densities = first[f"{PREFIX}{key}_shape_roles"], first[f"{PREFIX}{key}_densities"]
        for k, row in enumerate(groups[group]):
            row |= {"role": int(roles[k]), "density": float(densities[k]), "highlighted": False}
    for group, key, field in (
        ("joint", "motor_bindings", "motor_binding"),
        ("thruster", "thruster_bindings", "thruster_binding"),
    ):
        for k, row in enumerate(groups[group]):
            row[field] = int(first[PREFIX + key][k])
    for row in groups["joint"]:
        row |= {"acc_impulse": {"0": 0.0, "1": 0.0}, "acc_r_impulse": 0.0}
    capacity = tuple(len(groups[group]) for group in _GROUPS)
    counts = parse_capacity(",".join(map(str, capacity)))
    rr, cr, cc = pair_counts(counts)
    nothing = _keyed(msgspec.to_builtins(KinetixContact()))
    tree = {
        "env_state": {
            **groups,
            "collision_matrix": _keyed(first[PREFIX + "collision_matrix"].tolist()),
            "acc_rr_manifolds": [nothing] * (2 * rr),
            "acc_cr_manifolds": [nothing] * cr,
            "acc_cc_manifolds": [nothing] * cc,
            "gravity": _keyed(first[PREFIX + "gravity"].tolist()),
        },
        "env_params": ENV_PARAMS,
        "static_env_params": static_env_params(counts),
    }
    level = loads(json.dumps(tree), name)
    auto = first[PREFIX + "motor_auto"][first[f"{PREFIX}joint/active"]]
    joints_now = tuple(
        joint.replace(motor=joint.motor.replace(auto=bool(is_auto)))
        if joint.motor is not None
        else joint
        for joint, is_auto in zip(level.joints, auto, strict=True)
    )
    return level.replace(joints=joints_now)


def _rows(first: dict[str, np.ndarray], group: str) -> list[dict[str, Any]]:
    start = f"{PREFIX}{group}/"
    columns = {key[len(start) :]: values for key, values in first.items() if key.startswith(start)}
    if not columns:
        raise KeyError(start)
    count = len(next(iter(columns.values())))
    return [
        {field: _keyed(values[k].tolist()) for field, values in columns.items()}
        for k in range(count)
    ]


def _keyed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _keyed(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return {str(k): _keyed(one) for k, one in enumerate(value)}
    return value


def _refuse_filled(out: Path) -> None:
    try:
        filled = any(out.iterdir())
    except OSError as error:
        raise KinetixError(f"{out}: cannot be read: {error.strerror or error}") from error
    if filled:
        raise KinetixError(f"{out}: is not empty; choose a new folder")


def _write(
    out: Path, number: int, rows: list[dict[str, np.ndarray]], origins: list[_Origin]
) -> None:
    """Write the origins of all trajectories until now and then a shard."""
    # Origins first: a shard without them is read as one of kinetix-env.
    told = {"trajectories": msgspec.to_builtins(origins)}
    write_atomically(out / ORIGINS, (json.dumps(told, indent=1) + "\n").encode())
    stacked = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    packed = io.BytesIO()
    np.savez_compressed(packed, **stacked)  # pyright: ignore[reportArgumentType]
    write_atomically(out / f"shard-{number:05d}.npz", packed.getvalue())
