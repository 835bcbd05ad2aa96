"""Starts of episodes: options of files, weights of level sets, random sizes, walkers."""

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.environment import reset
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.params import EnvParams, static_env_params_from_size
from kinetix.environment.reset import (
    ResetFunction,
    level_state,
    load_from_json_file,
    make_reset_fn_list_of_levels,
    make_reset_fn_locomotion,
    make_reset_fn_sample_kinetix_level,
    make_reset_fn_sample_sizes,
    static_env_params_for_levels,
)
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Body, Circle, Level
from kinetix.level.sets import build_set, gather_levels, load_set, save_set

FIXTURES = Path(__file__).resolve().parents[1] / "level" / "fixtures"
MOON = (0.25, -1.62)
STANDARD = (0.0, -9.81)


def balls(name: str, x: float, **changes: Any) -> Level:
    """A green ball at x, and a blue one on the right."""
    bodies = (
        Body(id=1, shape=Circle(radius=0.2), position=(x, 2.0), role="green"),
        Body(id=2, shape=Circle(radius=0.2), position=(4.5, 2.0), role="blue"),
    )
    return Level(name=name, size="s", next_id=3, bodies=bodies, **changes)


def native_moon(folder: Path) -> Path:
    """A native level with a gravity and a time limit of its own."""
    file = folder / "native.json"
    save_level(balls("moon", 1.0, gravity=MOON, max_timesteps=40), file)
    return file


def foreign_moon(folder: Path) -> Path:
    """The same two numbers in a file of kinetix-env's format."""
    tree = json.loads((FIXTURES / "kinetix_env" / "gaps.json").read_text())
    tree["env_state"]["gravity"] = {"0": MOON[0], "1": MOON[1]}
    tree["env_params"]["max_timesteps"] = 40
    file = folder / "foreign.json"
    file.write_text(json.dumps(tree))
    return file


@pytest.mark.parametrize("make", [native_moon, foreign_moon])
@pytest.mark.parametrize(
    ("options", "gravity", "limit", "physics"),
    [
        ({}, MOON, 40, "balanced"),
        ({"gravity": "fixed"}, STANDARD, 40, "balanced"),
        ({"time_limit": "fixed"}, MOON, 256, "balanced"),
        ({"physics": "drift"}, MOON, 40, "drift"),
        ({"parity": "kinetix-3"}, STANDARD, 256, "jax2d"),
    ],
)
def test_what_of_a_file_counts(
    make: Any, options: dict, gravity: tuple, limit: int, physics: str, tmp_path: Path
) -> None:
    state, static, params = load_from_json_file(make(tmp_path), **options)
    np.testing.assert_allclose(state.world.gravity, gravity, rtol=1e-6)
    assert int(state.labels.max_timesteps) == limit
    assert params.max_timesteps == limit
    assert static.physics == physics
    assert static.frame_skip == 2


def test_the_limit_of_a_file_ends_its_episodes(tmp_path: Path) -> None:
    """Two levels of one batch, each with its own limit."""
    static = static_env_params_from_size("s", physics="drift")
    states = [
        load_from_json_file(native_moon(tmp_path), static_env_params=static, time_limit=source)[0]
        for source in ("file", "fixed")
    ]
    batch = jax.tree.map(lambda *leaves: jnp.stack([jnp.asarray(x) for x in leaves]), *states)
    env = make_kinetix_env("discrete", "blind", None, EnvParams(), static, auto_reset=False)
    noops = jnp.stack([env.actions.noop_action()] * 2)
    keys = jax.random.split(jax.random.key(0), 2)

    def step(state: Any, _: None) -> tuple[Any, jax.Array]:
        _, state, _, _, info = jax.vmap(env.step)(keys, state, noops)
        return state, info["truncated"]

    truncated = np.asarray(jax.jit(lambda s: jax.lax.scan(step, s, length=41))(batch)[1])
    assert truncated[:, 0].argmax() == 39
    assert not truncated[:, 1].any()


def test_a_set_is_drawn_by_its_weights(tmp_path: Path) -> None:
    for index in range(3):
        save_level(balls(f"balls {index}", 1.0 + index), tmp_path / f"{index}.json")
    made = build_set(gather_levels([tmp_path]), name="balls", folder=tmp_path)
    file = tmp_path / "set.json"
    save_set(made, file)
    tree = json.loads(file.read_text())
    for entry in tree["levels"]:
        entry["weight"] = {"0.json": 1.0, "1.json": 3.0, "2.json": 4.0}[entry["path"]]
    file.write_text(json.dumps(tree))
    static = static_env_params_from_size("s", physics="drift")
    keys = jax.random.split(jax.random.key(1), 4000)
    drawn = []
    for source in (file, load_set(file), gather_levels([file])):
        x = jax.jit(jax.vmap(make_reset_fn_list_of_levels(source, static)))(keys)
        drawn.append(np.rint(np.asarray(x.physics.position)[:, 5, 0] - 1.0))
    np.testing.assert_array_equal(drawn[0], drawn[1])
    np.testing.assert_array_equal(drawn[0], drawn[2])
    for index, share in enumerate((1 / 8, 3 / 8, 4 / 8)):
        spread = np.sqrt(share * (1 - share) / len(keys))
        assert abs((drawn[0] == index).mean() - share) < 4 * spread


def played(reset: ResetFunction, static: Any, count: int) -> tuple[Any, Any]:
    """Starts of episodes, and the observations after one step."""
    env = make_kinetix_env("multi_discrete", "symbolic_entity", reset, EnvParams(), static)
    assert isinstance(env, KinetixEnv)

    @jax.jit
    def run(keys: jax.Array) -> tuple[Any, Any]:
        _, state = jax.vmap(env.reset)(keys)
        actions = jax.vmap(env.actions.random_action)(keys)
        seen, *_ = jax.vmap(env.step)(keys, state, actions)
        return state, jax.vmap(env.observation_space().contains)(seen)

    return run(jax.random.split(jax.random.key(3), count))


@pytest.mark.slow
def test_levels_of_several_sizes_in_the_slots_of_the_largest() -> None:
    static = static_env_params_from_size("m", physics="drift")
    state, inside = played(make_reset_fn_sample_sizes(static), static, 256)
    assert inside.all()
    active = np.asarray(state.world.bodies.active)
    small = ~active[:, 5] & ~active[:, 8]
    assert 0.35 < small.mean() < 0.7
    roles = np.where(active, state.labels.role, 0)
    for wanted in (1, 2):
        assert ((roles == wanted).sum(axis=1) >= 1).mean() > 0.95


@pytest.mark.slow
def test_walkers_start_an_episode() -> None:
    static = static_env_params_from_size("locomotion", physics="drift")
    state, inside = played(make_reset_fn_locomotion(static), static, 64)
    assert inside.all()
    active = np.asarray(state.world.bodies.active)
    assert active[:, :10].all()
    assert (np.asarray(state.world.joints.active).sum(axis=1) >= 5).all()
    assert ((np.asarray(state.labels.role) == 2) & active).any(axis=1).all()
    assert np.isfinite(state.physics.position).all()


def test_an_environment_can_be_pickled() -> None:
    """Libraries send environments to other processes."""
    static = static_env_params_from_size("s")
    for reset_fn in (
        make_reset_fn_list_of_levels([balls("a", 1.0), balls("b", 2.0)], static),
        make_reset_fn_sample_kinetix_level(EnvParams(), static),
        make_reset_fn_sample_sizes(static),
        make_reset_fn_locomotion(static_env_params_from_size("locomotion")),
    ):
        env = make_kinetix_env("discrete", "blind", reset_fn, EnvParams(), static)
        same = pickle.loads(pickle.dumps(env))
        assert repr(same) == repr(env)
        assert same == env, "a worker that is sent it again would compile it again"
        assert hash(same) == hash(env)
        assert copy.deepcopy(env) == env
    drawn = make_reset_fn_list_of_levels([balls("a", 1.0), balls("b", 2.0)], static)
    key = jax.random.key(3)
    jax.tree.map(np.testing.assert_array_equal, pickle.loads(pickle.dumps(drawn))(key), drawn(key))


@pytest.mark.parametrize(
    "reset_fn",
    [
        make_reset_fn_sample_kinetix_level(EnvParams(), static_env_params_from_size("s")),
        make_reset_fn_sample_sizes(static_env_params_from_size("l")),
        make_reset_fn_locomotion(static_env_params_from_size("locomotion")),
    ],
    ids=["one size", "sizes", "walkers"],
)
def test_random_levels_keep_their_types_where_others_compute_in_binary64(
    reset_fn: ResetFunction,
) -> None:
    narrow = jax.eval_shape(reset_fn, jax.random.key(0))
    with jax.enable_x64(True):
        wide = jax.eval_shape(reset_fn, jax.random.key(0))
    assert narrow.physics.position.dtype == wide.physics.position.dtype == jnp.float32


def test_a_loaded_state_is_of_jax_arrays_as_code_for_kinetix_env_changes_them():
    state, _, _ = load_from_json_file("s/goalkeeper")
    slippery = state.replace(
        polygon=state.polygon.replace(friction=state.polygon.friction.at[0].set(0.0))
    )
    assert float(slippery.polygon.friction[0]) == 0.0


def test_many_levels_of_files_are_checked_once_and_leave_the_device_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else a training on ten thousand levels begins a minute later."""
    for x in (1.0, 2.0):
        save_level(balls("balls", x), tmp_path / f"{x}.json")
    listed = gather_levels([tmp_path])
    static = static_env_params_from_size("s")
    refused: list[Any] = []
    monkeypatch.setattr(reset, "check_computable", refused.append)
    mine = static_env_params_for_levels(listed, static)
    make_reset_fn_list_of_levels(listed, mine)
    assert not refused
    state = level_state(balls("balls", 1.0), mine)
    assert refused, "what comes from Python is checked"
    assert all(isinstance(leaf, np.ndarray) for leaf in jax.tree.leaves(state))


def test_a_level_is_loaded_as_its_file_is():
    level = load_level("s/goalkeeper")
    ours, static, params = load_from_json_file(level)
    theirs, static_of_file, params_of_file = load_from_json_file("s/goalkeeper")
    assert (static, params) == (static_of_file, params_of_file)
    jax.tree.map(np.testing.assert_array_equal, ours, theirs)
