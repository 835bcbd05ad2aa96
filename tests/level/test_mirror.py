"""Mirror images of whole levels: shapes, joints, walls, and play."""

import dataclasses

import jax
import numpy as np
import pytest

from kinetix.datasets.episode import solution_episode
from kinetix.datasets.replays import replay
from kinetix.environment.generators.documents import random_levels
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import dumps, load_level, loads
from kinetix.level.geometry import bounds, referenced_body, to_world
from kinetix.level.mirror import mirrored_level
from kinetix.level.model import Arena, ArenaBody, Geometry

LEVELS = ("s/goalkeeper", "s/circus_act", "s/first_flight", "l/hot_foot")


@pytest.mark.parametrize("name", LEVELS)
def test_a_mirror_image_of_the_mirror_image_is_the_level(name: str) -> None:
    """Places, joints and walls come back; what is written can be read."""
    level = load_level(name)
    image = mirrored_level(level)
    assert image.solution is None
    assert loads(dumps(image), name) == image
    twice = mirrored_level(image)
    for before, after in zip(level.bodies, twice.bodies, strict=True):
        assert np.allclose(before.position, after.position)
        assert np.allclose(bounds(before), bounds(after))
    assert [joint.motor for joint in twice.joints] == [joint.motor for joint in level.joints]
    assert twice.arena == level.arena


@pytest.mark.parametrize("name", LEVELS)
def test_anchors_are_where_the_mirror_shows_them(name: str) -> None:
    """Both anchors of every joint, walls included, are mirrored."""
    level = load_level(name)
    image = mirrored_level(level)
    for before, after in zip(level.joints, image.joints, strict=True):
        for end in ("a", "b"):
            places = [
                to_world(
                    referenced_body(each, getattr(joint, end)), getattr(joint, f"anchor_{end}")
                )
                for each, joint in ((level, before), (image, after))
            ]
            assert np.allclose((5 - places[0][0], places[0][1]), places[1], atol=1e-6)


@pytest.mark.parametrize("moved", [False, True])
def test_a_joint_on_a_side_wall_is_on_the_other_wall_where_the_mirror_shows_it(moved: bool) -> None:
    """Both ends stay together, though the standard frames of both walls are in one place."""
    b = LevelBuilder()
    arm = b.rectangle(4.5, 2, 1, 0.1)
    b.hinge(b.right_wall, arm, (5, 2))
    b.hinge(arm, b.left_wall, (0, 3))
    level = b.build()
    if moved:
        corners = ((-1.0, 3.0), (-1.0, -3.0), (1.0, -3.0), (1.0, 3.0))
        place = Geometry(position=(-0.5, 2.5), vertices=corners)
        level = level.replace(arena=Arena(left_wall=ArenaBody(geometry=place)))
        on_wall = level.joints[1].replace(anchor_b=(0.5, 0.5))
        level = level.replace(joints=(level.joints[0], on_wall))
    image = mirrored_level(level)
    assert [(joint.a, joint.b) for joint in image.joints] == [
        ("left_wall", arm),
        (arm, "right_wall"),
    ]
    for joint, there in zip(image.joints, ((0, 2), (5, 3)), strict=True):
        ends = ((joint.a, joint.anchor_a), (joint.b, joint.anchor_b))
        for body, anchor in ends:
            assert np.allclose(to_world(referenced_body(image, body), anchor), there)
    assert mirrored_level(image).joints == level.joints


def test_the_same_actions_play_the_mirror_image() -> None:
    """States of random levels under random actions are mirror images of each other at first."""
    found = solution_episode(load_level("s/goalkeeper"))
    assert found is not None
    control = np.random.default_rng(0).uniform(-1, 1, (20, 6)).astype(np.float32)
    control[:, 4:] = control[:, 4:] > 0
    for level in random_levels(5, "s", 6):
        plan = dataclasses.replace(found, level=level, control=control)
        image = dataclasses.replace(plan, level=mirrored_level(level))
        ours, theirs = (jax.tree.map(np.asarray, replay(each).states) for each in (plan, image))
        steps = min(len(ours.timestep), len(theirs.timestep), 6)
        active = ours.world.bodies.active[0].copy()
        active[:4] = False
        a, b = (x.physics.position[:steps][:, active] for x in (ours, theirs))
        assert np.allclose(5 - a[..., 0], b[..., 0], atol=2e-3)
        assert np.allclose(a[..., 1], b[..., 1], atol=2e-3)
