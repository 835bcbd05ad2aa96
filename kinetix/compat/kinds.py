"""Kinds of action and observation, made as kinetix-env makes them: from the two records."""

from typing import Any

import jax.numpy as jnp

from kinetix.environment import actions, observations
from kinetix.environment.actions import AbstractAction
from kinetix.environment.observations import AbstractObservation, Layout
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.state import EnvState
from kinetix.level.compile import Labels


class _ObservationForm:
    """kinetix-env's way to make an observation."""

    def __init__(
        self, env_params: EnvParams, static_env_params: StaticEnvParams, **options: Any
    ) -> None:
        make: Any = super().__init__
        make(layout=Layout.of(env_params, static_env_params), **options)


class _ActionForm:
    """kinetix-env's way to make and to use a kind of action."""

    def __init__(self, env_params: EnvParams, static_env_params: StaticEnvParams) -> None:
        del env_params
        make: Any = super().__init__
        make(
            motor_bindings=static_env_params.num_motor_bindings,
            thruster_bindings=static_env_params.num_thruster_bindings,
        )

    def process_action(
        self,
        action: Any,
        state: EnvState | Labels,
        static_env_params: StaticEnvParams | None = None,
    ) -> Any:
        """Return one number per joint, then one per thruster; of labels alone, the control."""
        process: Any = super().process_action  # pyright: ignore[reportAttributeAccessIssue]
        if not isinstance(state, EnvState):
            return process(action, state)
        del static_env_params
        control = process(action, state.labels)
        return jnp.concatenate([control.motor, control.thruster])


def _formed(form: type, kind: type, name: str) -> Any:
    """Return a class with another form; an environment's own kind counts as an instance of it."""

    def is_kind(cls: type, other: type) -> Any:
        return (cls is formed and kind in other.__mro__) or NotImplemented

    members = {"__doc__": kind.__doc__, "__module__": __name__}
    formed = type(kind)(name, (form, kind), members | {"__subclasshook__": classmethod(is_kind)})
    return formed


PixelObservations = _formed(_ObservationForm, observations.PixelObservations, "PixelObservations")
EntityObservations = _formed(
    _ObservationForm, observations.EntityObservations, "EntityObservations"
)
SymbolicObservations = _formed(
    _ObservationForm, observations.FlatObservations, "SymbolicObservations"
)
SymbolicPaddedObservations = _formed(
    _ObservationForm, observations.FlatPaddedObservations, "SymbolicPaddedObservations"
)
BlindObservations = _formed(_ObservationForm, observations.BlindObservations, "BlindObservations")

MultiDiscreteActions = _formed(_ActionForm, actions.MultiDiscreteActions, "MultiDiscreteActions")
DiscreteActions = _formed(_ActionForm, actions.DiscreteActions, "DiscreteActions")
ContinuousActions = _formed(_ActionForm, actions.ContinuousActions, "ContinuousActions")

__all__ = [
    "AbstractAction",
    "AbstractObservation",
    "BlindObservations",
    "ContinuousActions",
    "DiscreteActions",
    "EntityObservations",
    "MultiDiscreteActions",
    "PixelObservations",
    "SymbolicObservations",
    "SymbolicPaddedObservations",
]
