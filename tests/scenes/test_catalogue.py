import collections
import math
import subprocess
import sys

import numpy as np
import pytest

from kinetix.bench.motion import Motion
from kinetix.errors import KinetixError
from kinetix.level.geometry import area_centroid, signed_area
from kinetix.level.model import Polygon
from kinetix.scenes import SCENE_CLASSES, SCENES, scenes_named
from kinetix.scenes.stage import Stage

BUILT = {scene.id: scene.make_trials() for scene in SCENES.values()}
OVERLAPPING = {"S10", "R3", "R4", "R6"}
"""Scenes that start with overlaps on purpose, or with other people's levels."""


def at_start(trial):
    bodies = trial.level.bodies
    return Motion(
        trial=trial,
        position=np.array([[body.position for body in bodies]], np.float64),
        rotation=np.array([[body.angle for body in bodies]], np.float64),
        velocity=np.array([[body.velocity for body in bodies]], np.float64),
        angular_velocity=np.array([[body.angular_velocity for body in bodies]], np.float64),
    )


def test_there_are_76_scenes_and_30_of_them_are_core():
    groups = collections.Counter(scene.group for scene in SCENES.values())
    assert [groups[name] for name in SCENE_CLASSES] == [7, 8, 6, 10, 11, 6, 28]
    assert sum(scene.core for scene in SCENES.values()) == 30
    assert all(id == scene.id for id, scene in SCENES.items())


def test_scenes_load_no_jax():
    code = (
        "import sys; from kinetix.scenes import SCENES; "
        "[scene.make_trials() for scene in SCENES.values()]; sys.exit('jax' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("id", [id for id in SCENES if id != "R5"])
def test_scene_is_well_built(id):
    trials = BUILT[id]
    assert SCENES[id].build() == trials[0].level
    assert SCENES[id].duration == max(trial.duration for trial in trials)
    names = collections.Counter((trial.name, trial.phase) for trial in trials)
    assert len(trials) == 1 or id in {"I7", "F2", "R1"} or max(names.values()) == 1


def test_random_levels_are_no_documents():
    assert BUILT["R5"] == ()


@pytest.mark.parametrize("id", [id for id in SCENES if id not in OVERLAPPING | {"R5"}])
def test_nothing_overlaps_and_joints_are_closed_at_the_start(id):
    for trial in BUILT[id]:
        motion = at_start(trial)
        assert motion.joint_gap().max(initial=0) < 2e-6
        # Of cards and stones the published coordinates have five digits.
        assert motion.penetration().max() < 2e-5
        assert all(
            math.dist(area_centroid(body.shape.vertices), (0, 0)) < 1e-6
            and signed_area(body.shape.vertices) > 0
            for body in trial.level.bodies
            if isinstance(body.shape, Polygon) and id != "R3"
        )


@pytest.mark.parametrize(
    ("id", "body", "mass", "inertia"),
    [
        ("I3", 0, 0.12, 0.004),
        ("I4", 0, math.pi * 0.09, math.pi * 0.09**2 / 2),
        ("D2", 1, 0.1, 0.1 * 1.01 / 12),
        ("S3", 2, 0.9, 0.9 * 0.18 / 12),
    ],
)
def test_masses_are_those_of_the_suite(id, body, mass, inertia):
    found = at_start(BUILT[id][0]).masses[body]
    np.testing.assert_allclose(found, [mass, inertia], rtol=1e-6)


def test_loads_of_the_chain_weigh_10_to_1000_links():
    ratios = [
        motion.masses[-1, 0] / motion.masses[1, 0] for motion in map(at_start, BUILT["D5"][:3])
    ]
    np.testing.assert_allclose(ratios, [10, 100, 1000], rtol=1e-5)


def test_phases_shift_the_impact_by_eighths_of_a_step():
    starts = [trial.values["height"] for trial in BUILT["B1"]]
    np.testing.assert_allclose(np.diff(starts), math.sqrt(2 * 9.81) / 480, rtol=1e-9)


def test_gravity_turns_downhill_to_positive_x():
    gravity = Stage("slope", slope=math.radians(30)).level().gravity
    np.testing.assert_allclose(gravity, (4.905, -9.81 * math.sqrt(3) / 2), rtol=1e-6)


def test_scenes_are_chosen_by_name():
    assert len(scenes_named("core")) == 30
    assert len(scenes_named("all")) == 76
    assert [scene.id for scene in scenes_named("built")] == [f"U{k}" for k in range(1, 29)]
    assert len(scenes_named("core,built,S2")) == 30 + 28 + 1
    assert [scene.id for scene in scenes_named("D10, B1")] == ["D10", "B1"]
    with pytest.raises(KinetixError, match="no scene 'X9'"):
        scenes_named("B1,X9")
