"""Kinds of action and observation, made as kinetix-env makes them: from the two records."""

from typing import Any

from kinetix.environment import actions, observations
from kinetix.environment.actions import AbstractAction
from kinetix.environment.observations import AbstractObservation, Layout
from kinetix.environment.params import EnvParams, StaticEnvParams


class _ObservationForm:
    """kinetix-env's way to make an observation; without the records `make_kinetix_env` fits it."""

    def __init__(
        self,
        env_params: EnvParams | None = None,
        static_env_params: StaticEnvParams | None = None,
        *,
        layout: Layout | None = None,
        **options: Any,
    ) -> None:
        make: Any = super().__init__
        if layout is None:
            layout = Layout.of(env_params or EnvParams(), static_env_params or StaticEnvParams())
        make(layout=layout, **options)


class _ActionForm:
    """kinetix-env's way to make a kind of action."""

    def __init__(
        self,
        env_params: EnvParams | None = None,
        static_env_params: StaticEnvParams | None = None,
        **bindings: int,
    ) -> None:
        del env_params
        make: Any = super().__init__
        if static_env_params is not None:
            bindings = {
                "motor_bindings": static_env_params.num_motor_bindings,
                "thruster_bindings": static_env_params.num_thruster_bindings,
            }
        make(**bindings)


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
