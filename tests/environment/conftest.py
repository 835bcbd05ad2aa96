"""Levels and environments that the tests of this folder share; each environment compiles once."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine import presets
from kinetix.engine.pairs import candidate_pairs
from kinetix.engine.solvers import AbstractSolver
from kinetix.engine.spec import SceneSpec
from kinetix.engine.types import Control, Parameters, State, World
from kinetix.environment.env import KinetixEnv, make_kinetix_env
from kinetix.environment.params import EnvParams, StaticEnvParams, static_env_params_from_size
from kinetix.environment.reset import level_state, load_from_json_file
from kinetix.environment.state import EnvState, stack_states
from kinetix.level.model import Body, Circle, Joint, Level, Motor, Polygon, Thruster


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recording:
    """A level of kinetix-env with what kinetix-env recorded on it."""

    name: str
    state: EnvState
    static_env_params: StaticEnvParams
    arrays: dict[str, np.ndarray]


@pytest.fixture(scope="session")
def recordings(peer: Path) -> list[Recording]:
    """All levels of kinetix-env that come with recordings, under kinetix-env's physics."""
    found = []
    for file in sorted((peer / "fixtures").glob("*__*.npz")):
        name = file.stem.replace("__", "/", 1)
        state, static, _ = load_from_json_file(peer / "levels" / f"{name}.json", parity="kinetix-3")
        with np.load(file) as arrays:
            found.append(
                Recording(name=name, state=state, static_env_params=static, arrays=dict(arrays))
            )
    assert len(found) == 37
    return found


def by_size(recordings: list[Recording]) -> dict[StaticEnvParams, list[Recording]]:
    """The recordings grouped by what compiles to one step."""
    groups: dict[StaticEnvParams, list[Recording]] = {}
    for recording in recordings:
        groups.setdefault(recording.static_env_params, []).append(recording)
    return groups


def stacked(recordings: list[Recording]) -> Any:
    """The initial states of some recordings of one size as a batch."""
    return stack_states([recording.state for recording in recordings])


RECTANGLE = Polygon(vertices=((0.3, 0.1), (-0.3, 0.1), (-0.3, -0.1), (0.3, -0.1)))


def small_level() -> Level:
    """A motorised wheel on a green box with a thruster, and a fixed blue ball: fills size s."""
    return Level(
        name="small",
        size="s",
        next_id=6,
        bodies=(
            Body(id=1, shape=RECTANGLE, position=(2.0, 1.5), role="green"),
            Body(id=2, shape=Circle(radius=0.2), position=(1.7, 1.4), angular_velocity=0.5),
            Body(id=3, shape=Circle(radius=0.3), position=(4.0, 2.0), role="blue", fixed=True),
        ),
        joints=(
            Joint(
                id=4,
                kind="revolute",
                a=1,
                b=2,
                anchor_a=(-0.3, -0.1),
                anchor_b=(0.0, 0.0),
                motor=Motor(on=True, speed=2.0, power=1.0, binding=1),
            ),
        ),
        thrusters=(Thruster(id=5, body=1, position=(-0.3, 0.0), power=0.5, binding=1),),
    )


@dataclasses.dataclass(frozen=True)
class Drift(AbstractSolver):
    """Bodies fall and drift through each other: compiles at once, for tests of everything else.

    All bodies touch like discs of half a metre; a motor's control turns its second body.
    """

    name: ClassVar[str] = "drift"

    def empty_cache(self, spec: SceneSpec) -> Any:
        return np.zeros(2, np.float32)

    def step(
        self, world: World, state: State, control: Control, parameters: Parameters, spec: SceneSpec
    ) -> State:
        pairs = candidate_pairs(spec.capacity)
        apart = state.position[pairs[:, 0]] - state.position[pairs[:, 1]]
        active = world.bodies.active
        near = jnp.sqrt((apart**2).sum(axis=1)) < 0.5
        moves = (world.bodies.inverse_mass != 0).astype(jnp.float32)
        fall = moves[:, None] * world.gravity[None] * parameters.dt
        velocity = state.velocity + fall
        turned = jnp.zeros_like(state.rotation)
        for joint in range(spec.capacity.joints):
            is_b = jnp.arange(spec.capacity.bodies)[:, None] == world.joints.body_b[joint][None]
            turned = turned + is_b * control.motor[joint][None]
        return dataclasses.replace(
            state,
            position=state.position + velocity * parameters.dt,
            rotation=state.rotation + state.angular_velocity * parameters.dt,
            velocity=velocity,
            angular_velocity=state.angular_velocity + turned,
            touching=near & active[pairs[:, 0]] & active[pairs[:, 1]],
        )


@pytest.fixture(scope="session", autouse=True)
def drift() -> Iterator[None]:
    """Make `physics="drift"` known while the tests of this folder run."""
    presets.SOLVERS["drift"] = Drift()
    yield
    del presets.SOLVERS["drift"]


@pytest.fixture(scope="session")
def small_static() -> StaticEnvParams:
    """Size s with the physics of the tests."""
    return static_env_params_from_size("s", physics="drift")


@pytest.fixture(scope="session")
def small_state(small_static: StaticEnvParams) -> EnvState:
    """The small level at its start."""
    return level_state(small_level(), small_static)


@pytest.fixture(scope="session")
def small_env(small_static: StaticEnvParams, small_state: EnvState) -> KinetixEnv:
    """The small level with entity observations; resets go to the same level."""
    env = make_kinetix_env(
        "multi_discrete", "symbolic_entity", lambda key: small_state, EnvParams(), small_static
    )
    assert isinstance(env, KinetixEnv)
    return env


def assert_trees_close(a: Any, b: Any, tolerance: float = 1e-5) -> None:
    """Both pytrees have the same structure and, within a tolerance, the same numbers."""
    assert jax.tree.structure(a) == jax.tree.structure(b)
    for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True):
        np.testing.assert_allclose(
            np.asarray(x, np.float64), np.asarray(y, np.float64), atol=tolerance, rtol=tolerance
        )
