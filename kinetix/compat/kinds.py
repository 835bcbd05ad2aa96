"""Kinds of action and observation, made as kinetix-env makes them: from the two records."""

from typing import Any

from kinetix.environment import actions, observations
from kinetix.environment.actions import AbstractAction
from kinetix.environment.observations import AbstractObservation, Layout
from kinetix.environment.params import EnvParams, StaticEnvParams
from kinetix.environment.spaces import Space
from kinetix.environment.state import EnvState


class _ObservationForm:
    """kinetix-env's way to make and to call an observation."""

    def __init__(
        self, env_params: EnvParams, static_env_params: StaticEnvParams, **options: Any
    ) -> None:
        make: Any = super().__init__
        make(layout=Layout.of(env_params, static_env_params), **options)

    def get_obs(self, state: EnvState) -> Any:
        """Return the observation of a state."""
        return self(state)  # pyright: ignore[reportCallIssue]

    def observation_space(self, env_params: EnvParams | None = None) -> Space:
        """Return what `get_obs` returns."""
        return self.space  # pyright: ignore[reportAttributeAccessIssue]


class _ActionForm:
    """kinetix-env's way to make a kind of action."""

    def __init__(self, env_params: EnvParams, static_env_params: StaticEnvParams) -> None:
        del env_params
        make: Any = super().__init__
        make(
            motor_bindings=static_env_params.num_motor_bindings,
            thruster_bindings=static_env_params.num_thruster_bindings,
        )


def _formed(form: type, kind: type, name: str) -> Any:
    return type(name, (form, kind), {"__doc__": kind.__doc__, "__module__": __name__})


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
