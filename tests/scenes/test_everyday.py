import itertools

import pytest

from kinetix.level.geometry import arena_bodies, overlap_depth
from kinetix.level.graph import components, may_push
from kinetix.level.model import ARENA_NAMES
from kinetix.level.sizes import needed_capacity
from kinetix.level.validate import validate
from kinetix.scenes.everyday.catalogue import CLASSES, draw, draw_all
from kinetix.scenes.everyday.model import ROOMS

NUMBERS = range(16)


def test_a_seed_names_the_scenes():
    assert draw("walls", 3, 7) == draw("walls", 3, 7)
    assert draw("walls", 3, 7) != draw("walls", 3, 8)
    # More scenes leave the first ones as they are.
    few, many = draw_all(32, 1), draw_all(64, 1)
    assert all(many[name][: len(few[name])] == few[name] for name in CLASSES)
    assert sum(len(scenes) for scenes in draw_all(101, 0).values()) == 101


@pytest.mark.parametrize("name", CLASSES)
def test_scenes_fit_their_room_and_take_them_in_turn(name):
    scenes = [draw(name, number, 0) for number in NUMBERS]
    assert {scene.room for scene in scenes} == set(CLASSES[name].rooms)
    for scene in scenes:
        need, room = needed_capacity(scene.trial.level), ROOMS[scene.room]
        assert need.polygons - 4 <= room.polygons
        assert need.circles <= room.circles
        assert need.joints <= room.joints
    assert len({scene.trial.level for scene in scenes}) == len(scenes)


@pytest.mark.parametrize("name", CLASSES)
def test_nothing_overlaps_at_the_start(name):
    for number in NUMBERS:
        level = draw(name, number, 0).trial.level
        component = components(level.joints)
        bodies = [(body.id, body) for body in level.bodies]
        bodies += list(zip(ARENA_NAMES, arena_bodies(level.arena), strict=True))
        for a, b in itertools.combinations(bodies, 2):
            if not (isinstance(a[0], str) and isinstance(b[0], str)) and may_push(a, b, component):
                assert overlap_depth(a[1], b[1]) < 1e-3, (number, a[0], b[0])


@pytest.mark.parametrize("name", CLASSES)
def test_what_is_expected_names_bodies_of_the_scene(name):
    for number in NUMBERS:
        scene = draw(name, number, 0)
        ids = {body.id for body in scene.trial.level.bodies}
        assert {*scene.rests, *scene.inside, *scene.watched} <= ids
        assert not scene.rests or scene.rests_from < scene.trial.duration
        # A scene without a question would always be good.
        assert scene.rests or scene.inside or scene.watched or scene.compared
        if scene.twin is not None:
            shapes = [body.shape for body in scene.twin.bodies[-len(scene.watched) :]]
            assert shapes == [scene.trial.level.body(each).shape for each in scene.watched]


@pytest.mark.parametrize("name", CLASSES)
def test_levels_are_such_as_a_file_may_hold(name):
    for number in NUMBERS:
        issues = validate(draw(name, number, 0).trial.level)
        # There is nothing to reach: that is all.
        assert {issue.code for issue in issues if issue.severity == "error"} <= {"E101", "E102"}
