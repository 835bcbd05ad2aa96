"""The kinds of observation, one file each; `OBSERVATIONS` is where a name becomes a class."""

from kinetix.environment.observations.base import AbstractObservation
from kinetix.environment.observations.blind import BlindObservations
from kinetix.environment.observations.entities import EntityObservation, EntityObservations
from kinetix.environment.observations.features import Feature, Layout
from kinetix.environment.observations.flat import FlatObservations
from kinetix.environment.observations.flat_padded import FlatPaddedObservations
from kinetix.environment.observations.pixels import PixelObservation, PixelObservations

OBSERVATIONS: dict[str, type[AbstractObservation]] = {
    kind.name: kind
    for kind in (
        EntityObservations,
        FlatObservations,
        FlatPaddedObservations,
        PixelObservations,
        BlindObservations,
    )
}

__all__ = [
    "OBSERVATIONS",
    "AbstractObservation",
    "BlindObservations",
    "EntityObservation",
    "EntityObservations",
    "Feature",
    "FlatObservations",
    "FlatPaddedObservations",
    "Layout",
    "PixelObservation",
    "PixelObservations",
]
