"""kinetix-env's bodies turn about the origin of their frame: which origins stay where they are."""

import json

import pytest

from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import dumps, loads_document

QUADRILATERAL = ((0.0, 0.0), (2.0, 0.0), (1.9, 1.5), (1.7, 1.6))


def written(*, inertia_model="exact"):
    """A level with a corner-heavy quadrilateral, as it is and as kinetix-env's text."""
    builder = LevelBuilder("Top", gravity=(0.0, 0.0))
    body = builder.polygon(QUADRILATERAL, angular_velocity=4.0, density=2.0)
    builder.circle(4.0, 3.0, 0.2)
    builder.thruster(body, (1.5, 0.5), angle=0.0, power=1.0)
    level = builder.build()
    if inertia_model != level.inertia_model:
        level = level.replace(inertia_model=inertia_model)
        (first, *others) = level.bodies
        corners = first.shape.vertices
        mean = [sum(axis) / len(corners) for axis in zip(*corners, strict=True)]
        moved = tuple((x - mean[0], y - mean[1]) for x, y in corners)
        shape = first.shape.replace(vertices=moved)
        level = level.replace(bodies=(first.replace(shape=shape), *others))
    return level, dumps(level, format="kinetix-env")


@pytest.mark.parametrize("inertia_model", ["exact", "kinetix"])
def test_a_frame_at_the_centre_of_its_own_rule_stays(inertia_model):
    level, text = written(inertia_model=inertia_model)
    loaded = loads_document(text, "Top.json")
    assert loaded.mends == ()
    assert loaded.level.inertia_model == inertia_model
    assert loaded.level.bodies == level.bodies
    assert loaded.level.thrusters == level.thrusters


def test_masses_that_follow_from_no_rule_stay_with_such_a_frame():
    level, text = written()
    tree = json.loads(text)
    tree["env_state"]["polygon"][4]["inverse_mass"] *= 2.0
    body = loads_document(json.dumps(tree), "Top.json").level.bodies[0]
    assert body.position == level.bodies[0].position
    assert body.mass_properties.mass == pytest.approx(
        0.5 / json.loads(text)["env_state"]["polygon"][4]["inverse_mass"]
    )


def test_a_frame_at_neither_centre_is_mended_as_ever():
    _, text = written()
    tree = json.loads(text)
    for corner in tree["env_state"]["polygon"][4]["vertices"].values():
        corner["0"] += 0.3
    loaded = loads_document(json.dumps(tree), "Top.json")
    assert loaded.level.inertia_model == "kinetix"
    assert [mend.code for mend in loaded.mends] == ["W210"]
