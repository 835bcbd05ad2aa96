"""Effects of actions on motors and thrusters."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.environment.actions import (
    ACTIONS,
    ContinuousActions,
    DiscreteActions,
    MultiDiscreteActions,
)
from kinetix.environment.params import static_env_params_from_size
from kinetix.environment.reset import level_state
from kinetix.environment.spaces import ActionType
from kinetix.level.compile import Labels
from kinetix.level.controls import channels_in_use
from kinetix.level.model import Body, Joint, Level, Motor, Polygon, Thruster

LABELS = Labels(
    role=jnp.zeros(0, jnp.int32),
    density=jnp.zeros(0),
    motor_binding=jnp.array([3, 0, 1, 1, 2]),
    motor_auto=jnp.array([False, False, False, True, False]),
    thruster_binding=jnp.array([1, 0, 1]),
    max_timesteps=jnp.int32(0),
)
"""Five joints, one automatic, and three thrusters."""


def test_every_type_has_a_class() -> None:
    assert {kind.value for kind in ActionType} == set(ACTIONS)


@pytest.mark.parametrize("name", list(ACTIONS))
def test_noop_is_no_control_and_random_is_inside(name: str) -> None:
    actions = ACTIONS[name]()
    control = actions.process_action(actions.noop_action(), LABELS)
    np.testing.assert_array_equal(control.motor, [0, 0, 0, 1, 0])
    np.testing.assert_array_equal(control.thruster, [0, 0, 0])
    space = actions.action_space
    keys = jax.random.split(jax.random.key(0), 64)
    for drawn in (jax.vmap(actions.random_action)(keys), jax.vmap(space.sample)(keys)):
        assert jax.vmap(space.contains)(drawn).all()
    assert bool(space.contains(actions.noop_action()))
    assert jnp.shape(space.contains(actions.noop_action())) == ()


def test_multi_discrete_classes() -> None:
    actions = MultiDiscreteActions()
    space = actions.action_space
    assert (space.n, space.shape) == (16, (6,))
    assert space.number_of_dims_per_distribution == (3, 3, 3, 3, 2, 2)
    control = actions.process_action(jnp.array([1, 2, 0, 1, 1, 0]), LABELS)
    np.testing.assert_array_equal(control.motor, [1, 1, -1, 1, 0])
    np.testing.assert_array_equal(control.thruster, [0, 1, 0])
    for bad in ([3, 0, 0, 0, 0, 0], [0, 0, 0, 0, 2, 0], [-1, 0, 0, 0, 0, 0]):
        assert not space.contains(jnp.array(bad))


def test_discrete_values() -> None:
    actions = DiscreteActions()
    assert actions.action_space.n == 11
    table = np.array([actions.unified(jnp.int32(value)) for value in range(11)])
    for value in range(8):
        expected = np.zeros(6)
        expected[value // 2] = 1 if value % 2 else -1
        np.testing.assert_array_equal(table[value], expected)
    np.testing.assert_array_equal(table[8], np.zeros(6))
    np.testing.assert_array_equal(table[9:, 4:], np.eye(2))


def test_continuous_values_are_clipped() -> None:
    actions = ContinuousActions()
    control = actions.process_action(jnp.array([-3.0, 0.5, 2.0, 0.25, -1.0, 7.0]), LABELS)
    np.testing.assert_allclose(control.motor, [0.25, -1.0, 0.5, 1.0, 1.0])
    np.testing.assert_allclose(control.thruster, [1.0, 0.0, 1.0])
    assert not actions.action_space.contains(jnp.array([0, 0, 0, 0, -0.1, 0]))


def _machine() -> Level:
    """One joint per way in which a motor may not answer, one that does, and a thruster."""
    plate = Polygon(vertices=((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)))
    kinds = (
        ("revolute", Motor(binding=0, auto=True)),
        ("revolute", Motor(binding=1)),
        ("fixed", Motor(binding=2)),
        ("revolute", Motor(binding=3, on=False)),
    )
    return Level(
        name="machine",
        next_id=20,
        bodies=tuple(Body(id=k, shape=plate, position=(k * 0.5, 2.5)) for k in range(1, 6)),
        joints=tuple(
            Joint(
                id=10 + k,
                kind=kind,
                a=1 + k,
                b=2 + k,
                anchor_a=(0.25, 0.0),
                anchor_b=(-0.25, 0.0),
                motor=motor,
            )
            for k, (kind, motor) in enumerate(kinds)
        ),
        thrusters=(Thruster(id=19, body=1, position=(0.0, 0.0), binding=1),),
    )


@pytest.mark.parametrize("name", list(ACTIONS))
def test_live_controls_are_running_hinges_and_thrusters(name: str) -> None:
    state = level_state(_machine(), static_env_params_from_size("l"))
    live = ACTIONS[name]().live(state.world, state.labels)
    assert live.tolist() == [False, True, False, False, False, True]
    assert channels_in_use(_machine()) == (1, 5)
