"""Random machines: every family, sound levels of the size, the same for the same seed."""

import random

import pytest

from kinetix.cli import main
from kinetix.environment.generators.machines import FAMILIES, random_machine, random_machines
from kinetix.environment.generators.machines.vehicles import driving
from kinetix.environment.generators.machines.workshop import Workshop
from kinetix.errors import KinetixError
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import dumps, load_level, loads
from kinetix.level.model import ARENA_NAMES
from kinetix.level.sizes import capacity_of, size_name
from kinetix.level.validate import has_errors, validate

SIZES = ("s", "m", "l")


@pytest.mark.parametrize("size", SIZES)
def test_levels_are_sound_and_of_the_size(size):
    for level in random_machines(3, size, 150):
        issues = validate(level)
        assert not has_errors(issues)
        assert not [issue for issue in issues if issue.code == "W202"]
        assert size_name(capacity_of(level)) == size
        arena = [getattr(level.arena, name).role for name in ARENA_NAMES]
        roles = arena + [body.role for body in level.bodies]
        assert (roles.count("green"), roles.count("blue")) == (1, 1)
        controls = [joint.motor for joint in level.joints if joint.motor] + [*level.thrusters]
        assert controls, level.name
        assert loads(dumps(level)) == level


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_fits_the_largest_size(family):
    machines = [random_machine(random.Random(seed), "l", [family]) for seed in range(30)]
    assert {machine.name for machine in machines} == {family.__name__}
    assert len({dumps(machine) for machine in machines}) == 30


@pytest.mark.parametrize("family", FAMILIES)
def test_a_machine_is_not_joined_to_the_one_beside_it(family):
    shop = Workshop(random.Random(0), LevelBuilder("two"))
    driving(shop)
    first = {body.id for body in shop.build.build().bodies}
    family(shop)
    for joint in shop.build.build().joints:
        assert len({end in first for end in (joint.a, joint.b) if isinstance(end, int)}) == 1


@pytest.mark.parametrize("size", SIZES)
def test_sizes_have_several_families(size):
    names = {random_machine(random.Random(seed), size).name for seed in range(200)}
    assert len(names) >= 6


def test_a_level_depends_on_seed_and_number_alone():
    many = list(random_machines(5, "m", 6))
    assert list(random_machines(5, "m", 3)) == many[:3]
    assert next(random_machines(6, "m", 1)) != many[0]


def test_what_fits_nowhere_is_refused():
    walker = next(family for family in FAMILIES if family.__name__ == "long_arm")
    with pytest.raises(KinetixError, match="none of these families fits"):
        random_machine(random.Random(0), "s", [walker])
    with pytest.raises(KinetixError, match="expected s, m or l"):
        random_machine(random.Random(0), "locomotion")


def test_the_command_writes_them(tmp_path, capsys):
    arguments = ["sample", str(tmp_path), "--size", "m", "--count", "3", "--seed", "7"]
    assert main([*arguments, "--machines"]) == 0
    assert "3 levels" in capsys.readouterr().err
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == [f"machine_m_7_{index:04d}.json" for index in range(3)]
    assert load_level(tmp_path / written[1]) == list(random_machines(7, "m", 2))[1]
    assert main([*arguments, "--machines", "--size", "12,4,6,2"]) != 0
    assert "expected s, m or l" in capsys.readouterr().err
