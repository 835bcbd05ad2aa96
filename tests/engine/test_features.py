"""A scene compiled for what it uses moves as in the step that can do everything."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.engine import Capacity, Control, Features, SceneSpec, default_parameters, step
from kinetix.engine.fitting import fitted, narrow, widen
from kinetix.engine.pairs import pair_counts, pushing_candidates
from kinetix.engine.solvers import SOLVERS
from kinetix.level.compile import compile_level
from kinetix.level.features import features_of
from tests.engine import scenes

LEVELS = {
    "stack": scenes.stack(3),
    "wheel": scenes.motor_wheel(3.0),
    "pendulum": scenes.pendulum(0.7),
}
SOLVER = SOLVERS["direct+pgs"]
STEPS = 120


def roll(level, spec):
    scene = compile_level(level, spec=spec, solver=SOLVER)
    control = Control(
        motor=jnp.ones(spec.capacity.joints), thruster=jnp.zeros(spec.capacity.thrusters)
    )

    @jax.jit
    def run(world, state):
        def once(state, _):
            state = step(world, state, control, default_parameters(), spec=spec, solver=SOLVER)
            return state, (state.position, state.rotation, state.touching)

        return jax.lax.scan(once, state, None, length=STEPS)[1]

    return jax.tree.map(np.asarray, run(scene.world, scene.state))


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(LEVELS))
def test_what_a_scene_does_not_use_changes_nothing(name):
    level = LEVELS[name]
    capacity = scenes.SPEC.capacity
    features = features_of(level, capacity=capacity)
    assert features != Features()
    lean = roll(level, dataclasses.replace(scenes.SPEC, features=features))
    full = roll(level, scenes.SPEC)
    # Sums of other lengths are rounded differently.
    for one, other in zip(lean, full, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-6)


def test_listed_pairs_are_found_whichever_way_round_they_are_said():
    capacity = Capacity(polygons=6, circles=2, joints=0, thrusters=0)
    features = Features(pairs=((0, 4), (4, 6), (7, 6)))
    kinds = pushing_candidates(capacity, features)
    assert [len(kind) for kind in kinds] == [1, 1, 1]
    everything = pushing_candidates(capacity, Features())
    assert tuple(len(kind) for kind in everything) == pair_counts(capacity)


def test_a_scene_without_pairs_has_no_room_for_contacts():
    capacity = Capacity(polygons=5, circles=1, joints=0, thrusters=0)
    room = SOLVER.slots_for(SceneSpec(capacity=capacity, features=Features(pairs=())))
    assert room.points == 0


def test_a_fitted_scene_has_the_used_slots_alone_and_gives_all_of_them_back():
    level = scenes.motor_wheel(3.0)
    capacity = Capacity(polygons=9, circles=4, joints=5, thrusters=2)
    spec = SceneSpec(capacity=capacity, features=features_of(level, capacity=capacity))
    scene = compile_level(level, spec=spec, solver=SOLVER)
    small = fitted(spec)
    assert small.capacity.bodies == 4 + len(level.bodies)
    assert small.capacity.joints == len(level.joints)
    assert len(small.features.pairs) == len(spec.features.pairs)
    control = Control(motor=jnp.arange(5.0), thruster=jnp.zeros(2))
    world, state, narrowed = narrow(scene.world, scene.state, control, spec)
    own = compile_level(level, spec=small, solver=SOLVER)
    for found, expected in zip(
        jax.tree.leaves((world, state)), jax.tree.leaves((own.world, own.state)), strict=True
    ):
        np.testing.assert_array_equal(found, expected)
    assert narrowed.motor.shape == (len(level.joints),)
    moved = dataclasses.replace(state, rotation=state.rotation + 1)
    wide = widen(scene.state, moved, spec)
    kept = np.isin(np.arange(capacity.bodies), spec.features.used.bodies)
    np.testing.assert_array_equal(wide.rotation - scene.state.rotation, kept)
    assert wide.touching.shape == scene.state.touching.shape
