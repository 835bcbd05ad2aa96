"""The contract of every kind of action, and the way from bindings to actuators."""

import abc
import dataclasses
from typing import Any, ClassVar, overload

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.types import Control, World
from kinetix.environment.params import StaticEnvParams
from kinetix.environment.spaces import Space
from kinetix.environment.state import EnvState
from kinetix.level.compile import Labels


@dataclasses.dataclass(frozen=True, kw_only=True)
class AbstractAction(abc.ABC):
    """An action space: how an agent controls the motors and thrusters.

    Every kind decodes to the *unified action*: one number −1 … 1 per motor binding, then one number
    0 … 1 per thruster binding.
    """

    name: ClassVar[str]

    motor_bindings: int = 4
    thruster_bindings: int = 2

    @property
    def value(self) -> str:
        """Its name, as that of the equal `ActionType`."""
        return self.name

    @property
    @abc.abstractmethod
    def action_space(self) -> Space:
        """The set of actions."""

    @abc.abstractmethod
    def unified(self, action: Any) -> Float[Array, " u"]:
        """Return the unified action, within its bounds."""

    @abc.abstractmethod
    def noop_action(self) -> Any:
        """Return the action that drives nothing (automatic joints still run)."""

    @abc.abstractmethod
    def random_action(self, key: Array) -> Any:
        """Return a random action."""

    @overload
    def process_action(self, action: Any, state: Labels) -> Control: ...

    @overload
    def process_action(
        self, action: Any, state: EnvState, static_env_params: StaticEnvParams | None = None
    ) -> Float[Array, " jt"]: ...

    def process_action(
        self,
        action: Any,
        state: EnvState | Labels,
        static_env_params: StaticEnvParams | None = None,
    ) -> Control | Float[Array, " jt"]:
        """Return what an action means to the engine: a number per joint and one per thruster.

        Args:
            action: An element of `action_space`.
            state: The state that it is played in; or the labels alone: bindings of the level's
                joints and thrusters, and which joints are automatic.
            static_env_params: As kinetix-env has it; not used.

        Returns:
            One vector, joints first (+1 where one is automatic); of labels alone the engine's
            record of the two.
        """
        if isinstance(state, EnvState):
            control = self.process_action(action, state.labels)
            return jnp.concatenate([control.motor, control.thruster])
        del static_env_params
        labels, unified = state, self.unified(action)
        motors, thrusters = unified[: self.motor_bindings], unified[self.motor_bindings :]
        motor = _pick(jnp.clip(motors, -1, 1), labels.motor_binding)
        return Control(
            motor=jnp.where(labels.motor_auto, 1.0, motor),
            thruster=_pick(jnp.clip(thrusters, 0, 1), labels.thruster_binding),
        )

    def live(self, world: World, labels: Labels) -> Bool[Array, " u"]:
        """Return which bindings drive anything: a motor that is on and not automatic, a thruster.

        Args:
            world: The level's joints and thrusters.
            labels: Their bindings.

        Returns:
            One truth per motor binding, then one per thruster binding.
        """
        joints, thrusters = world.joints, world.thrusters
        driven = joints.active & ~joints.fixed & joints.motor_on & ~labels.motor_auto
        motors = [
            jnp.any(driven & (labels.motor_binding == index))
            for index in range(self.motor_bindings)
        ]
        burns = [
            jnp.any(thrusters.active & (labels.thruster_binding == index))
            for index in range(self.thruster_bindings)
        ]
        return jnp.stack([*motors, *burns])


def _pick(values: Float[Array, " u"], binding: Int[Array, " e"]) -> Float[Array, " e"]:
    """`values[binding]` by comparison, which stays elementwise under vmap (a gather does not)."""
    if values.shape[0] == 0:
        return jnp.zeros(binding.shape, values.dtype)
    last = values.shape[0] - 1
    picked = jnp.broadcast_to(values[last], binding.shape)
    for index in range(last):
        picked = jnp.where(binding == index, values[index], picked)
    return picked
