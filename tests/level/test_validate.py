"""Every static code has a level that has it, and a near one that does not."""

import itertools
import math

import pytest

from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import load_document
from kinetix.level.model import (
    Arena,
    ArenaBody,
    Body,
    Circle,
    Joint,
    Level,
    Limits,
    Motor,
    Polygon,
    SizeHint,
    Solution,
    Thruster,
)
from kinetix.level.validate import MOST_OVERLAPS, validate
from tests.pace import share_of


def box(width, height):
    w, h = width / 2, height / 2
    return Polygon(vertices=((w, h), (-w, h), (-w, -h), (w, -h)))


GREEN = Body(id=1, shape=Circle(radius=0.2), position=(1, 2), role="green")
BLUE = Body(id=2, shape=Circle(radius=0.2), position=(4, 2), role="blue")
PUSH = Thruster(id=3, body=1, position=(0, 0))
GOOD = Level(name="good", bodies=(GREEN, BLUE), thrusters=(PUSH,))


def with_body(**changes):
    body = Body(**({"id": 9, "shape": box(0.4, 0.4), "position": (2.5, 3)} | changes))
    return GOOD.replace(bodies=(*GOOD.bodies, body), next_id=10)


def with_joint(**changes):
    values = {"id": 8, "kind": "revolute", "a": 1, "b": 2, "anchor_a": (3, 0), "anchor_b": (0, 0)}
    return GOOD.replace(joints=(Joint(**(values | changes)),), next_id=9)


def with_green(**changes):
    return GOOD.replace(bodies=(GREEN.replace(**changes), BLUE))


RED_FLOOR = Arena(floor=ArenaBody(role="red"))
CLOCKWISE = Polygon(vertices=((0.2, 0.2), (0.2, -0.2), (-0.2, -0.2), (-0.2, 0.2)))
DENT = Polygon(vertices=((0.2, 0.2), (-0.2, 0.2), (0.1, 0.1), (0.2, -0.2)))
PENTAGON = Polygon(vertices=tuple((math.cos(k), math.sin(k)) for k in range(5)))
SHIFTED = Polygon(vertices=((1.0, 0.4), (0.0, 0.4), (0.0, 0.0), (1.0, 0.0)))
CASES = {
    "E101": (
        GOOD.replace(bodies=(GREEN.replace(role="none"), BLUE)),
        "No green shape: the level cannot be won.",
    ),
    "E102": (GOOD.replace(bodies=(GREEN,)), "No blue shape: nothing to reach."),
    "E103": (with_body(role="green"), "2 green and 1 blue shapes; expected exactly one each"),
    "E104": (with_green(position=(3.61, 2)), "Green already touches blue at the start"),
    "E105": (with_green(position=(1, 0.59)).replace(arena=RED_FLOOR), "lost at t=0"),
    "E106": (with_body(density=0.0), "Rectangle 9: density: expected 0.001 ≤ x ≤ 1000, got 0.0."),
    "E107": (with_body(shape=CLOCKWISE), "Rectangle 9: expected counter-clockwise vertices"),
    "E108": (with_joint(b=77), "Joint 8: bodies missing."),
    "E109": (
        with_body(shape=Circle(radius=0.2)).replace(size="s"),
        "Uses 3 of 2 circles: does not fit size s.",
    ),
    "W214": (
        GOOD.replace(
            solution=Solution(physics="foo", frame_skip=2, actions=((1, (0, 0, 0, 0, 1, 1)),))
        ),
        "The recorded solution is of unknown physics 'foo'; expected one of jax2d, fast,",
    ),
    "W214 thruster": (
        GOOD.replace(
            solution=Solution(physics="fast", frame_skip=2, actions=((1, (0, 0, 0, 0, 1, 2)),))
        ),
        "Thruster 1 of the recorded solution: expected 0 or 1, got 2, which counts as 0.",
    ),
    "E110": (
        GOOD.replace(thrusters=(PUSH.replace(binding=2),)),
        "Binding 2 of thruster 3 is out of range 0–1.",
    ),
    "W201": (GOOD.replace(thrusters=()), "Nothing is controllable"),
    "W202": (with_body(position=(2.5, 0.5)), "The floor and rectangle 9 overlap by 0.1 m"),
    "W203": (with_body(position=(-8, 2)), "Rectangle 9 lies outside the arena."),
    "W204": (
        with_body().replace(
            bodies=(GREEN.replace(fixed=True), BLUE.replace(fixed=True), with_body().bodies[2]),
            thrusters=(PUSH.replace(body=9),),
        ),
        "Green and blue are both fixed",
    ),
    "W205": (with_joint(limits=Limits(min=1, max=-1)), "the limits are swapped, min > max"),
    "W206": (with_body(shape=box(2.0, 0.3)), "Rectangle 9 is larger than 2 m"),
    "W207": (
        with_joint(a="floor", b=2, anchor_a=(1.5, 6.8)).replace(
            bodies=(GREEN, BLUE.replace(fixed=True))
        ),
        "Joint 8 between two fixed shapes has no effect.",
    ),
    "W208": (with_joint(motor=Motor(speed=0)), "Joint 8: motor speed 0."),
    "W212": (with_body(angle=90), "Rectangle 9: angle 90 rad is 14.3 turns; 90° are 1.571 rad."),
    "W213": (
        with_joint(kind="fixed", reference_angle=0.5),
        "Weld 8: drawn 28.6° from the angle that it holds",
    ),
    "W215": (
        with_joint(limits=Limits(min=1, max=2)),
        "Joint 8: drawn 57.3° outside its limits, will be turned there.",
    ),
    "W216": (
        with_green(collision="ghost"),
        "Green and blue can never touch (by their collision, as parts of the arena, or held apart "
        "by welds): the level cannot be won.",
    ),
    "W217": (
        with_body().replace(
            joints=(
                Joint(id=10, kind="revolute", a=1, b=9, anchor_a=(1.5, 1), anchor_b=(0, 0)),
                Joint(id=11, kind="fixed", a=9, b=1, anchor_a=(-1.5, -1), anchor_b=(0, 0)),
            ),
            next_id=12,
        ),
        "Joint 10 cannot turn: its shapes are welded together.",
    ),
    "W209": (with_joint(anchor_a=(3, 0.02)), "Joint 8: anchor mismatch 0.02 m"),
}


def codes(level):
    return [issue.code for issue in validate(level)]


@pytest.mark.parametrize("code", CASES)
def test_each_code_is_found_alone(code):
    level, sentence = CASES[code]
    issues = validate(level)
    code = code.split()[0]
    assert [issue.code for issue in issues] == [code]
    assert sentence in issues[0].message
    assert issues[0].severity == {"E": "error", "W": "warning"}[code[0]]
    assert issues[0].path.startswith("$")


def test_a_good_level_has_no_issue():
    assert codes(GOOD) == []
    assert codes(with_joint()) == []


def test_without_walls_one_problem_tells_of_all_that_pictures_do_not_show():
    b = LevelBuilder("Outside", arena=False)
    for k in range(5):
        b.circle(-4 + 2 * k, 2.5, 0.2)
    (issue,) = [issue for issue in validate(b.build()) if issue.code == "W203"]
    assert issue.message.startswith("2 shapes outside the square of 5 m")
    assert issue.ids == (1, 2)


def test_more_contacts_than_a_step_has_room_for_are_foreseen():
    """Size l has room for sixty points: twelve bodies in one place would need more."""

    def heap(spread):
        b = LevelBuilder("Heap")
        for k in range(8):
            b.rectangle(1 + spread * k, 1, 0.4, 0.4)
        for k in range(4):
            b.circle(1 + spread * k, 2 if spread else 1, 0.2)
        return validate(b.build())

    (issue,) = [issue for issue in heap(0.0) if issue.code == "W211"]
    assert "94 contact points" in issue.message and "size l has room for 60" in issue.message
    assert "W211" not in [issue.code for issue in heap(0.4)]


def test_every_static_code_has_a_case():
    errors, warnings = range(101, 111), [*range(201, 210), *range(212, 218)]
    assert {case.split()[0] for case in CASES} == {f"E{k}" for k in errors} | {
        f"W{k}" for k in warnings
    }


@pytest.mark.parametrize(
    ("code", "level"),
    [
        ("E101", GOOD.replace(bodies=(BLUE,), thrusters=())),
        ("E102", GOOD.replace(bodies=(GREEN,))),
    ],
)
def test_a_coloured_floor_counts(code, level):
    role = {"E101": "green", "E102": "blue"}[code]
    assert code in codes(level)
    assert code not in codes(level.replace(arena=Arena(floor=ArenaBody(role=role))))


@pytest.mark.parametrize("shape", [DENT, PENTAGON, SHIFTED])
def test_other_bad_polygons(shape):
    assert codes(with_body(shape=shape)) == ["E107"]


@pytest.mark.parametrize(
    ("path", "level"),
    [
        ("$.bodies[2].position[0]", with_body(position=(math.nan, 0))),
        ("$.bodies[2].shape.radius", with_body(shape=Circle(radius=-1))),
        ("$.bodies[2].angle", with_body(angle=-math.inf)),
        ("$.bodies[2].friction", with_body(friction=11)),
        ("$.gravity[1]", GOOD.replace(gravity=(0, math.nan))),
        ("$.name", GOOD.replace(name="")),
        ("$.arena.floor.density", GOOD.replace(arena=Arena(floor=ArenaBody(density=0)))),
        ("$.joints[0].motor.speed", with_joint(motor=Motor(speed=math.inf))),
    ],
)
def test_values_that_no_file_could_hold(path, level):
    issues = [issue for issue in validate(level) if issue.code == "E106"]
    assert [issue.path for issue in issues] == [path]


@pytest.mark.parametrize(("gap", "found"), [(0.004, ["E105"]), (0.006, [])])
def test_sharp_corners_touch_by_their_distance(gap, found):
    """Tip to tip, askew: no face's normal measures the gap."""
    along, across = (0.8, 0.6), (-0.6, 0.8)

    def at(x, y):
        return 2 + x * along[0] + y * across[0], 2 + x * along[1] + y * across[1]

    builder = LevelBuilder("Tips")
    builder.polygon([at(-1, -0.1), at(0, 0), at(-1, 0.1)], role="green")
    builder.polygon([at(gap, 0), at(1 + gap, -0.1), at(1 + gap, 0.1)], role="red")
    builder.circle(4.5, 4.5, 0.2, role="blue")
    assert [code for code in codes(builder.build()) if code[0] == "E"] == found


def test_touching_needs_contact_but_not_the_right_to_push():
    near = with_green(position=(3.61 - 0.02, 2))
    assert codes(near) == []
    almost = with_green(position=(3.597, 2))  # 3 mm apart: touching under the soft presets
    assert codes(almost) == ["E104"]
    joint = {"a": 1, "b": 2, "anchor_a": (0.4, 0), "anchor_b": (0, 0)}
    joined = with_joint(**joint).replace(bodies=(GREEN.replace(position=(3.7, 2)), BLUE))
    assert "E104" in codes(joined)
    apart = with_joint(**joint).replace(bodies=(GREEN.replace(position=(3.597, 2)), BLUE))
    assert "E104" not in codes(apart)
    ghost = with_green(position=(3.7, 2), collision="ghost")
    assert codes(ghost) == ["W216"]


def test_who_touches_blue_and_red_at_the_start_has_lost():
    red = Body(id=9, shape=Circle(radius=0.2), position=(3.215, 2), role="red")
    both = with_green(position=(3.61, 2))
    both = both.replace(bodies=(*both.bodies, red), next_id=10)
    assert codes(both) == ["E105"]
    assert codes(both.replace(bodies=both.bodies[:2])) == ["E104"]


def test_a_goal_that_the_engine_never_looks_at_cannot_be_met():
    ghost, solid = GREEN.replace(collision="ghost"), BLUE.replace(collision="always")
    assert codes(GOOD.replace(bodies=(ghost, solid))) == []
    assert codes(GOOD.replace(bodies=(GREEN, BLUE.replace(collision="ghost")))) == ["W216"]
    blue_floor = Arena(floor=ArenaBody(role="blue"))
    assert codes(GOOD.replace(bodies=(ghost,), arena=blue_floor)) == []
    part = GREEN.replace(role="none")
    both = blue_floor.replace(ceiling=ArenaBody(role="green"))
    assert codes(GOOD.replace(bodies=(part,), arena=both)) == ["W216"]
    # One pair that can touch is enough.
    assert codes(GOOD.replace(bodies=(ghost, BLUE), arena=blue_floor)) == ["E103"]


def test_a_goal_that_welds_keep_away_cannot_be_met():
    weld = {"kind": "fixed", "anchor_a": (1.5, 0), "anchor_b": (-1.5, 0)}
    assert codes(with_joint(**weld)) == ["W216"]
    assert codes(with_joint(**weld | {"kind": "revolute"})) == []
    # A weld that is drawn apart moves them.
    assert codes(with_joint(**weld | {"anchor_a": (-1.4, 0)})) == ["W209"]
    near = {"anchor_a": (0.2, 0), "anchor_b": (-0.205, 0)}
    assert (
        codes(with_joint(**weld | near).replace(bodies=(GREEN, BLUE.replace(position=(1.405, 2)))))
        == []
    )
    # By way of another shape.
    bar = with_body(position=(2.5, 2))
    welds = (
        Joint(id=10, kind="fixed", a=1, b=9, anchor_a=(0.75, 0), anchor_b=(-0.75, 0)),
        Joint(id=11, kind="fixed", a=9, b=2, anchor_a=(0.75, 0), anchor_b=(-0.75, 0)),
    )
    assert codes(bar.replace(joints=welds, next_id=12)) == ["W216"]
    assert codes(bar.replace(joints=welds[:1], next_id=12)) == []
    other = BLUE.replace(id=20, position=(4, 4))
    bodies = (GREEN, BLUE, other)
    assert "W216" not in codes(with_joint(**weld).replace(bodies=bodies, next_id=21))


def test_jointed_and_fixed_bodies_do_not_push_each_other_apart():
    overlapping = with_body(position=(2.5, 0.5))
    assert codes(overlapping) == ["W202"]
    pinned = overlapping.replace(
        joints=(Joint(id=10, kind="revolute", a="floor", b=9, anchor_a=(0, 5.3), anchor_b=(0, 0)),),
        next_id=11,
    )
    assert codes(pinned) == []
    fixed = overlapping.replace(
        bodies=(*GOOD.bodies, overlapping.bodies[2].replace(fixed=True)),
    )
    assert codes(fixed) == []


def test_welds_hide_motors_and_limits():
    weld = with_joint(kind="fixed", motor=Motor(speed=0), limits=Limits(min=1, max=-1))
    assert codes(weld) == ["W216"]
    assert codes(weld.replace(thrusters=())) == ["W201", "W216"]
    assert codes(with_joint(limits=Limits(min=-4, max=4))) == ["W205"]
    assert codes(with_joint(limits=Limits(on=False, min=1, max=-1))) == []


def test_limits_that_exclude_the_drawn_angle_count_whole_turns():
    """The engine wraps no angle, takes limits in either order, and leaves fixed bodies alone."""

    def found(limits, **changes):
        return codes(with_joint(limits=limits, **changes))

    assert found(Limits(min=-0.1, max=0.1), reference_angle=math.tau) == ["W215"]
    assert found(Limits(min=-2.1, max=-1.9), reference_angle=2) == []
    assert found(Limits(min=math.radians(0.9), max=1)) == []
    assert found(Limits(min=math.radians(-2), max=math.radians(-1.1))) == ["W215"]
    assert found(Limits(min=1, max=-1)) == ["W205"]
    assert found(Limits(on=False, min=1, max=2)) == []
    assert found(Limits(min=1, max=2), kind="fixed") == ["W216"]
    fixed = with_joint(a="floor", anchor_a=(1.5, 6.8), limits=Limits(min=1, max=2))
    fixed = fixed.replace(bodies=(GREEN, BLUE.replace(fixed=True)))
    assert codes(fixed) == ["W207"]


def test_an_automatic_motor_is_not_a_control():
    motor = with_joint(motor=Motor(auto=True)).replace(thrusters=())
    assert codes(motor) == ["W201"]
    assert codes(with_joint(motor=Motor()).replace(thrusters=())) == []


def test_what_only_acts_on_fixed_bodies_is_no_control():
    fixed = GOOD.replace(bodies=(GREEN.replace(fixed=True), BLUE))
    found = [issue for issue in validate(fixed) if issue.code != "W204"]
    assert [issue.code for issue in found] == ["W201", "W207"]
    assert found[1].message == "Thruster 3 on a fixed shape has no effect."
    motor = with_joint(a="floor", b=1, anchor_a=(-1.5, 6.8), motor=Motor())
    motor = motor.replace(joints=(motor.joints[0].replace(anchor_b=(0, 0)),), thrusters=())
    assert codes(motor) == []
    assert codes(motor.replace(bodies=fixed.bodies)) == ["W201", "W207"]


def test_a_thruster_without_body_is_an_error():
    level = GOOD.replace(thrusters=(PUSH, PUSH.replace(id=4, body=77)), next_id=5)
    assert codes(level) == ["E108"]


def test_a_custom_size_is_named_by_its_numbers():
    hint = SizeHint(polygons=4, circles=2, joints=0, thrusters=1)
    message = validate(with_body().replace(size=hint))[0].message
    assert message == "Uses 5 of 4 polygons: does not fit size 4,2,0,1."


def test_fifty_entities_take_less_than_five_milliseconds():
    bodies = tuple(
        Body(id=k, shape=box(0.4, 0.2), position=(0.5 * (k % 9), 0.6 + 0.3 * (k // 9)), angle=k)
        for k in range(1, 36)
    )
    joints = tuple(
        Joint(id=100 + k, kind="revolute", a=k, b=k + 1, anchor_a=(0, 0), anchor_b=(0, 0))
        for k in range(1, 16)
    )
    level = Level(name="many", bodies=bodies, joints=joints)
    angles = itertools.count()

    def check():
        """A level that was checked before is remembered, so each is another one."""
        validate(level.replace(bodies=(bodies[0].replace(angle=next(angles)), *bodies[1:])))

    assert share_of(0.005, check) <= 1


@pytest.mark.peer
def test_published_levels_have_no_error_and_one_has_a_stretched_joint(peer):
    stretched = []
    for path in sorted((peer / "levels").rglob("*.json")):
        level = load_document(path).level
        issues = validate(level)
        assert not [issue for issue in issues if issue.severity == "error"]
        assert {issue.code for issue in issues} <= {"W202", "W209"}
        stretched += [level.name for issue in issues if issue.code == "W209"]
    assert stretched == ["gears"]


def test_of_a_pile_some_overlaps_are_listed_and_the_rest_is_said():
    pile = tuple(
        Body(id=k + 1, shape=Circle(radius=0.2), position=(2.5 + 2e-4 * k, 2.5)) for k in range(300)
    )
    listed = [issue for issue in validate(Level(name="pile", bodies=pile)) if issue.code == "W202"]
    assert len(listed) == MOST_OVERLAPS + 1
    assert listed[-1].message == "More shapes overlap than the 200 pairs that are listed."
    # Who touches whom at the start is looked for all the same.
    last = pile[-1].replace(role="blue")
    level = Level(name="pile", bodies=(pile[0].replace(role="green"), *pile[1:-1], last))
    assert "E104" in {issue.code for issue in validate(level)}
