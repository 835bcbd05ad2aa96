"""Random levels and mutations as documents, and the command that writes them."""

import functools
from pathlib import Path

import pytest

from kinetix.cli.sample import Sample, run
from kinetix.engine.spec import Capacity
from kinetix.environment.generators import documents
from kinetix.environment.generators.documents import (
    mutate_level,
    random_level,
    random_levels,
)
from kinetix.environment.generators.params import UEDParams
from kinetix.errors import KinetixError
from kinetix.level.codec import dumps, load_level, loads, save_level
from kinetix.level.model import Body, Circle, Joint, Level, Motor, Polygon, Thruster
from kinetix.level.sizes import SIZES
from kinetix.level.validate import validate

BY_CHANCE = {"E104", "E105"}
"""A first contact of green can happen by chance."""


def level() -> Level:
    square = Polygon(vertices=((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)))
    return Level(
        name="Cart",
        size="m",
        bodies=(
            Body(id=3, shape=Circle(radius=0.2), position=(3.0, 2.0), role="blue"),
            Body(id=5, shape=square, position=(1.5, 2.0), role="green", friction=0.3),
            Body(id=9, shape=Circle(radius=0.2), position=(1.5, 1.7)),
        ),
        joints=(
            Joint(
                id=7,
                kind="revolute",
                a=5,
                b=9,
                anchor_a=(0.0, -0.3),
                anchor_b=(0.0, 0.0),
                motor=Motor(),
            ),
        ),
        thrusters=(Thruster(id=4, body=5, position=(0.0, 0.0)),),
        next_id=20,
    )


def problems(document: Level) -> set[str]:
    return {issue.code for issue in validate(document) if issue.severity == "error"}


@pytest.mark.parametrize("size", ["s", "m", "l", "locomotion"])
def test_random_levels_are_valid_documents(size: str, tmp_path: Path) -> None:
    for document in random_levels(7, size, 40):
        assert problems(document) <= BY_CHANCE
        assert document.size == size
        assert document.inertia_model == "kinetix"
        assert all(body.mass_properties is None for body in document.bodies)
        assert loads(dumps(document)) == document
    file = tmp_path / "level.json"
    save_level(document, file, format="kinetix-env")
    back = load_level(file)
    assert len(back.bodies) == len(document.bodies)
    assert [body.position for body in back.bodies] == [
        body.position for body in sorted(document.bodies, key=lambda b: isinstance(b.shape, Circle))
    ]
    assert [joint.anchor_a for joint in back.joints] == [j.anchor_a for j in document.joints]


def test_the_seed_decides() -> None:
    assert random_level(3, "s") == random_level(3, "s")
    assert random_level(3, "s") != random_level(4, "s")
    assert next(random_levels(3, "s", 5)) == random_level(3, "s")
    assert random_level(-1, "s").bodies


def test_a_mutation_touches_nothing_else() -> None:
    before = level()
    before = before.replace(
        bodies=tuple(body.replace(name=f"body {body.id}") for body in before.bodies)
    )
    for seed in range(4):
        after = mutate_level(before, "change_location", seed)
        assert [body.name for body in after.bodies] == [body.name for body in before.bodies]
        assert {body.id for body in after.bodies} == {3, 5, 9}
        assert after.joints == before.joints
        assert after.thrusters == before.thrusters
        moved = [new.id for new, old in zip(after.bodies, before.bodies, strict=True) if new != old]
        assert moved in ([3], [5, 9])
        stayed = [body for body in after.bodies if body.id not in moved]
        assert all(body in before.bodies for body in stayed)


def test_a_size_is_that_of_the_whole_shape() -> None:
    """No corner of a triangle says how large it is: one may lie at the height of the centre."""
    before = level()
    corners = ((-0.53, 0.02), (0.27, -0.42), (0.27, 0.4))
    bodies = tuple(
        body.replace(shape=Polygon(vertices=corners)) if body.id == 5 else body
        for body in before.bodies
    )
    sides = []
    for seed in range(12):
        after = mutate_level(before.replace(bodies=bodies), "change_size", seed)
        (shape,) = (body.shape for body in after.bodies if body.id == 5)
        assert isinstance(shape, Polygon)
        sides += [max(axis) - min(axis) for axis in zip(*shape.vertices, strict=True)]
    assert 2 * UEDParams().max_shape_size >= max(sides) > 0.82 > min(sides) > 0.05


@pytest.mark.parametrize("quirks", [True, False])
def test_what_is_not_jointed_to_a_resized_shape_keeps_moving(
    quirks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = functools.partial(UEDParams, kinetix_quirks=quirks)
    monkeypatch.setattr(documents, "UEDParams", options)
    bodies = [b.replace(velocity=(1.0, 0.5), angular_velocity=2.0) for b in level().bodies]
    before = level().replace(bodies=tuple(bodies))
    changed = set()
    for seed in range(6):
        after = mutate_level(before, "change_size", seed)
        pairs = list(zip(before.bodies, after.bodies, strict=True))
        (resized,) = (old.id for old, new in pairs if old.shape != new.shape)
        changed.add(resized)
        resting = {new.id for _, new in pairs if new.velocity == (0.0, 0.0)}
        component = {3} if resized == 3 else {5, 9}
        assert resting == (component if quirks else set())
        for old, new in pairs:
            if new.id not in resting:
                assert (new.velocity, new.angular_velocity) == (old.velocity, old.angular_velocity)
    assert 3 in changed and changed & {5, 9}


def test_creatures_are_drawn_for_their_name_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(documents, "_drawer", lambda *of: asked.append(of))
    for size in ("locomotion", SIZES["locomotion"]):
        with pytest.raises(TypeError):  # nothing draws
            random_level(0, size)
    assert asked == [(SIZES["locomotion"], True), (SIZES["locomotion"], False)]


def test_removing_and_adding_keep_ids() -> None:
    before = level()
    seen = set()
    for seed in range(8):
        after = mutate_level(before, "remove_shape", seed)
        ids = {body.id for body in after.bodies}
        seen |= {3, 5, 9} - ids
        assert len(ids) == 2
        assert bool(after.joints) == (ids == {5, 9})
        assert bool(after.thrusters) == (5 in ids)
        assert after.next_id == 20
    assert seen == {3, 5, 9}
    grown = mutate_level(before, "add_thruster", 0)
    assert [thruster.id for thruster in grown.thrusters] == [4, 20]
    assert grown.thrusters[0] == before.thrusters[0]
    assert grown.next_id == 21
    assert grown.bodies == before.bodies


def test_a_mutation_with_nothing_to_do_gives_the_level_back() -> None:
    bare = Level(name="Bare", bodies=level().bodies[:1])
    assert mutate_level(bare, "remove_joint", 0) is bare
    assert mutate_level(bare, "swap_role", 0) is bare
    with pytest.raises(KinetixError, match="swap_role"):
        mutate_level(bare, "explode", 0)


def test_the_command_writes_the_same_files_for_the_same_seed(tmp_path: Path) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    for folder, count in ((first, 3), (second, 5)):
        assert run(Sample(target=folder, size="s", count=count, seed=11)) == 0
    names = sorted(file.name for file in first.iterdir())
    assert names == [f"random_s_11_000{k}.json" for k in range(3)]
    assert len(list(second.iterdir())) == 5
    for name in names:
        assert (first / name).read_bytes() == (second / name).read_bytes()
    run(Sample(target=first, size="6,1,1,1", count=1, seed=1))
    custom = load_level(first / "random_6_1_1_1_1_0000.json")
    assert Capacity(polygons=6, circles=1, joints=1, thrusters=1).bodies >= len(custom.bodies)
    for bad in (
        Sample(target=first, size="xl", count=1, seed=1),
        Sample(target=first, size="s", count=0, seed=1),
    ):
        with pytest.raises(KinetixError, match="expected"):
            run(bad)
