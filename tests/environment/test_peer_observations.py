"""Initial observations of kinetix-env's levels, number by number."""

import json
from pathlib import Path

import jax
import numpy as np
import pytest

from kinetix.environment.inverse import state_from_entities
from kinetix.environment.observations import (
    EntityObservation,
    EntityObservations,
    FlatObservations,
    FlatPaddedObservations,
    Layout,
)
from kinetix.environment.params import EnvParams, static_env_params_from_size
from tests.environment.conftest import Recording, by_size, stacked

TOLERANCE = 1e-6
FIELDS = ("circles", "polygons", "joints", "thrusters")
EXACT = (
    "circle_mask",
    "polygon_mask",
    "joint_mask",
    "thruster_mask",
    "attention_mask",
    "joint_indexes",
    "thruster_indexes",
)


@pytest.mark.peer
def test_flat_form_equals_the_peers(recordings: list[Recording]) -> None:
    for static, group in by_size(recordings).items():
        observe = FlatObservations(layout=Layout.of(EnvParams(), static))
        flat = jax.jit(jax.vmap(observe))(stacked(group))
        for row, recording in zip(np.asarray(flat), group, strict=True):
            np.testing.assert_allclose(
                row, recording.arrays["flat0"], atol=TOLERANCE, rtol=0, err_msg=recording.name
            )


@pytest.mark.peer
def test_entity_form_equals_the_peers(recordings: list[Recording]) -> None:
    for static, group in by_size(recordings).items():
        observe = EntityObservations(layout=Layout.of(EnvParams(), static))
        entities = jax.jit(jax.vmap(observe))(stacked(group))
        for index, recording in enumerate(group):
            for field in FIELDS:
                ours = np.asarray(getattr(entities, field))[index]
                theirs = recording.arrays[f"entity_{field}"]
                np.testing.assert_allclose(
                    ours,
                    theirs,
                    atol=TOLERANCE,
                    rtol=TOLERANCE,
                    err_msg=f"{recording.name} {field}",
                )
            for field in EXACT:
                ours = np.asarray(getattr(entities, field))[index]
                theirs = recording.arrays[f"entity_{field}"]
                np.testing.assert_array_equal(ours, theirs, err_msg=f"{recording.name} {field}")


@pytest.mark.peer
@pytest.mark.parametrize(
    ("name", "size"),
    [("s/h3_point_the_thruster", "s"), ("m/h7_car_flip", "m"), ("l/grasp_easy", "l")],
)
def test_all_forms_of_a_state_rebuilt_from_an_observation(peer: Path, name: str, size: str) -> None:
    """The entity form is inverted to a state, from which all three forms must come out again."""
    published = json.loads((peer / "fixtures" / "initial_observations.json").read_text())[name]
    static = static_env_params_from_size(size, physics="jax2d")
    entity = {
        field: np.asarray(value, bool if "mask" in field else None)
        for field, value in published["entity"].items()
    }
    invert = jax.jit(lambda seen: state_from_entities(seen, EnvParams(), static))
    state = invert(EntityObservation(**entity))
    layout = Layout.of(EnvParams(), static)
    forms = (EntityObservations, FlatObservations, FlatPaddedObservations)
    again, flat, padded = jax.jit(
        lambda state: [observations(layout=layout)(state) for observations in forms]
    )(state)
    for field in (*FIELDS, *EXACT):
        np.testing.assert_allclose(
            getattr(again, field), entity[field], atol=2e-5, rtol=2e-5, err_msg=field
        )
    np.testing.assert_allclose(flat, published["symbolic_flat"], atol=2e-5)
    np.testing.assert_allclose(padded, published["symbolic_flat_padded"], atol=2e-5)
