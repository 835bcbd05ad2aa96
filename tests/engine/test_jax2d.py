"""The preset `jax2d` against recordings of kinetix-env's engine (60 steps a level, two scripts)."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine import Control, SceneSpec, default_parameters, solver_named, step
from kinetix.level.codec import load_document
from kinetix.level.kinetix_env.compile import compile_kinetix_env

pytestmark = [pytest.mark.peer, pytest.mark.slow]

SCRIPTS = ("engine_", "engine_noop_")


def trajectories(spec, solver, scenes, actions):
    joints = spec.capacity.joints

    @jax.jit
    def roll(world, state, actions):
        def one(world, state, actions):
            def body(state, action):
                control = Control(motor=action[:joints], thruster=action[joints:])
                state = step(world, state, control, default_parameters(), spec=spec, solver=solver)
                return state, state.position

            return jax.lax.scan(body, state, actions)[1]

        return jax.vmap(one)(world, state, actions)

    return np.asarray(roll(scenes.world, scenes.state, actions))


@pytest.fixture(scope="module")
def errors(peer):
    """Largest position error of the active bodies: (run, step)."""
    solver = solver_named("jax2d")
    found = {}
    for size in "sml":
        paths = sorted((peer / "levels" / size).glob("*.json"))
        scenes = [compile_kinetix_env(load_document(path).source, solver=solver) for path in paths]
        fixtures = [np.load(peer / "fixtures" / f"{size}__{path.stem}.npz") for path in paths]
        polygons, circles, joints, thrusters = (int(x) for x in fixtures[0]["caps"])
        spec = SceneSpec(capacity=_capacity(polygons, circles, joints, thrusters))
        stacked = jax.tree.map(lambda *x: jnp.stack(x), *scenes)
        for script in SCRIPTS:
            actions = np.stack([fixture["engine_actions"] for fixture in fixtures])
            actions = actions if script == "engine_" else np.zeros_like(actions)
            positions = trajectories(spec, solver, stacked, jnp.asarray(actions))
            for path, scene, fixture, ours in zip(paths, scenes, fixtures, positions, strict=True):
                theirs = np.concatenate([fixture[f"{script}px"], fixture[f"{script}cx"]], axis=1)
                active = np.asarray(scene.world.bodies.active)
                found[f"{size}/{path.stem} {script}"] = np.abs(ours - theirs)[:, active].max(
                    axis=(1, 2)
                )
    return found


def _capacity(polygons, circles, joints, thrusters):
    from kinetix.engine import Capacity

    return Capacity(polygons=polygons, circles=circles, joints=joints, thrusters=thrusters)


@pytest.mark.parametrize(("steps", "bound", "share"), [(10, 1e-4, 0.95), (60, 1e-2, 0.80)])
def test_positions_agree(errors, steps, bound, share):
    at = {name: error[steps - 1] for name, error in errors.items()}
    far = {name: f"{error:.1e}" for name, error in at.items() if error > bound}
    assert 1 - len(far) / len(at) >= share, far


def test_the_first_step_agrees(errors):
    first = np.array([error[0] for error in errors.values()])
    assert (first <= 2e-5).mean() >= 0.9
    assert first.max() <= 1e-4
