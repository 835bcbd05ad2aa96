import math
import subprocess
import sys

import numpy as np
import pytest

import kinetix
from kinetix.errors import LevelError
from kinetix.level.geometry import body_mass, to_world, world_vertices
from kinetix.level.model import Level, Limits, Motor
from kinetix.level.validate import has_errors, validate


def test_a_built_level_is_valid_and_survives_its_file(tmp_path):
    b = kinetix.LevelBuilder("Car", gravity=(0, -5))
    chassis = b.rectangle(2, 1, 1, 0.2, density=2, role="green", velocity=(1, 0))
    wheel = b.circle(1.7, 0.8, 0.15, friction=0.5, restitution=0.25)
    ramp = b.polygon([(3, 0.4), (4, 0.4), (4, 0.9)], fixed=True, role="blue")
    axle = b.hinge(chassis, wheel, (1.7, 0.8), motor=Motor(speed=2.0, auto=True))
    push = b.thruster(chassis, (1.5, 1.0), angle=0.0, power=2.0, binding=1)
    level = b.build()
    assert (chassis, wheel, ramp, axle, push) == (1, 2, 3, 4, 5)
    assert not has_errors(validate(level))
    kinetix.save_level(level, tmp_path / "car.json")
    assert kinetix.load_level(tmp_path / "car.json") == level
    assert level.body(chassis).role == "green"
    assert level.body(wheel).restitution == 0.25
    assert level.thrusters[0].position == pytest.approx((-0.5, 0.0))


def test_points_and_anchors_are_places_in_the_world():
    b = kinetix.LevelBuilder()
    corners = [(10.0, 20.0), (11.0, 20.0), (11.0, 21.0)]
    triangle = b.polygon(corners)
    box = b.rectangle(10.5, 20.0, 1, 1, angle=math.pi / 2)
    joint = b.hinge(triangle, box, (10.6, 20.2))
    level = b.build()
    assert [p for corner in world_vertices(level.body(triangle)) for p in corner] == pytest.approx(
        [p for corner in corners for p in corner]
    )
    made = level.entity(joint)
    for reference, anchor in ((made.a, made.anchor_a), (made.b, made.anchor_b)):
        assert to_world(level.body(reference), anchor) == pytest.approx((10.6, 20.2), abs=1e-5)
    # A hinge's zero is the present angle.
    assert made.reference_angle == pytest.approx(math.pi / 2)


def test_ids_may_be_numbers_of_numpy():
    b = kinetix.LevelBuilder()
    ids = np.array([b.circle(1, 1, 0.2), b.circle(2, 1, 0.2)])
    b.hinge(ids[0], ids[1], (1, 1))
    b.weld("floor", ids[0], (1, 0.5))
    b.thruster(ids[1], (2, 1), angle=0, power=1)
    level = b.build()
    assert (level.joints[0].a, level.joints[1].b, level.thrusters[0].body) == (1, 1, 2)
    assert type(level.joints[0].b) is type(level.thrusters[0].body) is int


def test_limits_are_a_pair_or_the_record():
    b = kinetix.LevelBuilder()
    a, c = b.circle(1, 1, 0.2), b.circle(2, 1, 0.2)
    b.hinge(a, c, (1, 1), limits=(-0.5, 0.5))
    b.hinge(a, c, (1, 1), limits=Limits(min=-0.5, max=0.5))
    first, second = b.build().joints
    assert first.limits == second.limits


def test_arena_bodies_can_be_named_where_there_are_any():
    b = kinetix.LevelBuilder()
    door = b.rectangle(2, 1, 0.1, 1)
    b.hinge(b.floor, door, (2, 0.4))
    b.weld(door, b.left_wall, (0, 1))
    assert [joint.a for joint in b.build().joints] == ["floor", door]
    empty = kinetix.LevelBuilder(arena=False)
    box = empty.rectangle(0, 0, 1, 1)
    with pytest.raises(LevelError, match="no ceiling, as arena=False"):
        empty.hinge(box, empty.ceiling, (0, 0))
    arena = empty.build().arena
    assert {arena.floor.collision, arena.ceiling.collision} == {"ghost"}


def test_a_builder_can_go_on_after_building():
    b = kinetix.LevelBuilder()
    b.circle(1, 1, 0.2)
    first = b.build()
    b.circle(2, 1, 0.2)
    assert (len(first.bodies), len(b.build().bodies)) == (1, 2)
    assert first.name == "Untitled"
    assert "2 bodies" in repr(b)


WRONG = {
    "hundreds of digits": (lambda b: b.circle(10**400, 0, 1), "x 1000.*expected a finite number"),
    "beyond 32 bits": (lambda b: b.circle(0, 1e30, 1), "y 1e.30: expected at most 1e.18"),
    "a list as a body": (lambda b: b.thruster([1], (0, 0), angle=0, power=1), "there is no body"),
    "a truth as a body": (
        lambda b: b.weld(b.circle(0, 0, 1), np.True_, (0, 0)),
        "there is no body",
    ),
    "half a body": (lambda b: b.weld(b.circle(0, 0, 1), 1.0, (0, 0)), "there is no body 1.0"),
    "a body to itself": (lambda b: b.weld(b.circle(0, 0, 1), 1, (0, 0)), "expected two bodies"),
    "walls alone": (lambda b: b.weld("floor", "ceiling", (0, 0)), "expected two bodies"),
    "width": (lambda b: b.rectangle(0, 0, 0, 1), "width 0: expected more than 0"),
    "radius": (lambda b: b.circle(0, 0, -1), "radius -1: expected more than 0"),
    "place": (lambda b: b.circle(math.nan, 0, 1), "x nan: expected a finite number"),
    "text": (lambda b: b.circle("far", 0, 1), "x 'far': expected a number"),
    "density": (lambda b: b.circle(0, 0, 1, density=0), "density 0: expected more than 0"),
    "restitution": (lambda b: b.circle(0, 0, 1, restitution=2), "restitution 2: expected 0 … 1"),
    "friction": (lambda b: b.circle(0, 0, 1, friction=-1), "friction -1: expected at least 0"),
    "role": (lambda b: b.circle(0, 0, 1, role="pink"), "expected one of none, green, blue, red"),
    "body's name": (lambda b: b.circle(0, 0, 1, name=""), "name '': expected 1 to 60 characters"),
    "velocity": (lambda b: b.circle(0, 0, 1, velocity=3), "velocity 3: expected two numbers"),
    "clockwise": (lambda b: b.polygon([(0, 0), (0, 1), (1, 0)]), "got clockwise ones"),
    "corners": (lambda b: b.polygon([(0, 0), (1, 0)]), "expected 3 or 4 vertices, got 2"),
    "body": (lambda b: b.weld(b.circle(0, 0, 1), 7, (0, 0)), "there is no body 7"),
    "wall": (lambda b: b.weld(b.circle(0, 0, 1), "roof", (0, 0)), "there is no body 'roof'"),
    "limits": (
        lambda b: b.hinge(b.circle(0, 0, 1), b.floor, (0, 0), limits=(1, -1)),
        "expected min ≤ max",
    ),
    "motor": (
        lambda b: b.hinge(b.circle(0, 0, 1), b.floor, (0, 0), motor=3),
        "expected a kinetix.level.Motor",
    ),
    "thruster": (
        lambda b: b.thruster(b.floor, (0, 0), angle=0, power=1),
        "not part of the arena",
    ),
    "binding": (
        lambda b: b.thruster(b.circle(0, 0, 1), (0, 0), angle=0, power=1, binding=2),
        "binding 2: expected 0 … 1",
    ),
    "fixed": (lambda b: b.circle(0, 0, 1, fixed="no"), "fixed 'no': expected True or False"),
    "speed": (
        lambda b: b.hinge(b.circle(0, 0, 1), b.floor, (0, 0), motor=Motor(speed=math.nan)),
        "motor: speed nan: expected a finite number",
    ),
    "power": (
        lambda b: b.hinge(b.circle(0, 0, 1), b.floor, (0, 0), motor=Motor(power=-1)),
        r"motor: power -1\.0: expected at least 0",
    ),
    "name": (lambda b: kinetix.LevelBuilder(5), "name 5: expected a string"),
    "gravity": (lambda b: kinetix.LevelBuilder(gravity=9.81), "gravity 9.81: expected two numbers"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_is_said_in_a_sentence(name):
    make, text = WRONG[name]
    with pytest.raises(LevelError, match=text):
        make(kinetix.LevelBuilder())


def test_bodies_joints_and_thrusters_have_names():
    b = kinetix.LevelBuilder()
    ball = b.circle(1, 1, 0.2, name="ball")
    box = b.rectangle(1, 1, 0.2, 0.2)
    b.hinge(ball, box, (1, 1), name="hip")
    b.weld(box, b.floor, (1, 0), name="foot")
    b.thruster(box, (1, 1), angle=0, power=1, name="jet")
    level = b.build()
    assert [body.name for body in level.bodies] == ["ball", None]
    assert [joint.name for joint in level.joints] == ["hip", "foot"]
    assert [thruster.name for thruster in level.thrusters] == ["jet"]
    with pytest.raises(LevelError, match="name '': expected 1 to 60 characters"):
        b.hinge(ball, box, (1, 1), name="")


def test_an_unknown_argument_lists_the_known_ones():
    with pytest.raises(TypeError, match="'colour': expected angle, velocity"):
        kinetix.LevelBuilder().circle(0, 0, 1, colour="red")


def test_no_more_than_the_format_holds():
    b = kinetix.LevelBuilder()
    for k in range(1024):
        b.circle(k, 0, 0.1)
    with pytest.raises(LevelError, match="at most 1024 bodies"):
        b.circle(0, 1, 0.1)


def test_building_needs_no_jax():
    script = (
        "import kinetix, sys; b = kinetix.LevelBuilder()\n"
        "b.weld(b.circle(0, 0, 1), b.floor, (0, 0)); b.build(); assert 'jax' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_a_level_can_be_added_to(tmp_path):
    level = kinetix.load_level("s/first_flight")
    builder = kinetix.LevelBuilder.from_level(level)
    assert builder.build() == level
    ball = builder.circle(1, 3, 0.1, role="red")
    builder.hinge(ball, builder.rectangle(1, 3.4, 0.2, 0.8), (1, 3.2), motor=Motor())
    builder.thruster(level.bodies[0].id, (2, 2), angle=0.0, power=1.0)
    more = builder.build()
    assert more.bodies[: len(level.bodies)] == level.bodies
    assert (more.name, more.arena, more.description) == (level.name, level.arena, level.description)
    assert ball == level.next_id and more.next_id == level.next_id + 4
    assert level.solution is not None and more.solution is None
    assert (level.size, more.size) == ("s", None)
    kinetix.save_level(more, tmp_path / "more.json")
    assert kinetix.load_level(tmp_path / "more.json") == more
    space = kinetix.LevelBuilder("Space", arena=False)
    space.circle(1, 1, 0.1)
    kinetix.save_level(space.build(), tmp_path / "space.json")
    again = kinetix.LevelBuilder.from_level(kinetix.load_level(tmp_path / "space.json"))
    with pytest.raises(LevelError, match="there is no floor"):
        again.hinge(1, again.floor, (1, 1))
    with pytest.raises(LevelError, match=r"a kinetix\.Level, got str"):
        kinetix.LevelBuilder.from_level("s/first_flight")


def test_what_is_added_has_its_mass_as_the_level_says(tmp_path):
    model = kinetix.LevelBuilder.from_level(Level(name="x", inertia_model="kinetix"))
    added = model.polygon([(1, 1), (2, 1), (2, 1.5), (1, 2)])
    kinetix.save_level(model.build(), tmp_path / "x.json")
    body = kinetix.load_level(tmp_path / "x.json").body(added)
    mass, _ = body_mass(body, "kinetix")
    assert mass == pytest.approx(0.75 * body.density)
