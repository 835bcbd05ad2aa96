"""Levels of size l with legs: planar remakes of the walkers that reinforcement learning grew up
on.
"""

from kinetix.level.model import Point, Role
from scripts.library.draft import A_D, FLOOR, LEFT_RIGHT, UP_DOWN, W_S, Draft


def _wall(draft: Draft, x: float) -> None:
    """The goal that those on all fours head for."""
    draft.box((x, 1.36), 0.3, 1.9, "blue", fixed=True)


def _lamp(draft: Draft, x: float, y: float) -> None:
    """A goal at the height of the head, where only who is upright gets: falling does not win."""
    draft.ball((x, y), 0.22, "blue", fixed=True)


def _leg(
    draft: Draft,
    body: int,
    hip: Point,
    controls: tuple[int, int],
    *,
    bend: float,
    foot: float,
    lengths: tuple[float, float],
) -> None:
    """A thigh and a shin with motors, and a foot welded on [° and m; the foot points to +x]."""
    thigh, knee = draft.rod(hip, -90 - bend, lengths[0], width=0.13)
    draft.hinge(body, thigh, hip, control=controls[0], speed=1.0, power=2.0, limits=(-50, 50))
    shin, ankle = draft.rod(knee, -90 + bend, lengths[1], width=0.11)
    draft.hinge(thigh, shin, knee, control=controls[1], speed=1.0, power=2.0, limits=(-60, 60))
    sole, _ = draft.rod((ankle[0] - 0.08, ankle[1]), 0, foot, width=0.1)
    draft.weld(shin, sole, ankle)


def _hopper(draft: Draft, x: float) -> None:
    foot, _ = draft.rod((x - 0.2, FLOOR + 0.06), 0, 0.5, width=0.12, density=1.5)
    shin, knee = draft.rod((x, FLOOR + 0.06), 105, 0.45, width=0.1)
    draft.hinge(foot, shin, (x, FLOOR + 0.06), control=W_S, speed=1.5, power=2.5, limits=(-45, 45))
    thigh, hip = draft.rod(knee, 70, 0.45, width=0.12)
    draft.hinge(shin, thigh, knee, control=UP_DOWN, speed=1.5, power=2.5, limits=(-70, 70))
    torso, _ = draft.rod(hip, 92, 0.5, "green", width=0.18)
    draft.hinge(thigh, torso, hip, control=LEFT_RIGHT, speed=1.5, power=2.5, limits=(-60, 60))


def _cheetah(draft: Draft, x: float) -> None:
    torso = draft.box((x, 1.16), 1.1, 0.16, "green")
    for hip, controls in ((x - 0.48, (LEFT_RIGHT, UP_DOWN)), (x + 0.48, (W_S, A_D))):
        _leg(draft, torso, (hip, 1.14), controls, bend=18, foot=0.26, lengths=(0.35, 0.37))


def _walker(draft: Draft, x: float) -> None:
    torso = draft.box((x, 1.645), 0.18, 0.7, "green")
    for bend, controls in ((20, (LEFT_RIGHT, UP_DOWN)), (4, (W_S, A_D))):
        _leg(draft, torso, (x, 1.325), controls, bend=bend, foot=0.3, lengths=(0.45, 0.42))


def _course(difficulty: int, floor: Role, *tags: str) -> Draft:
    hazard = ("hazard",) if floor == "red" else ()
    return Draft("walker", "rhythm", *tags, *hazard, difficulty=difficulty, floor=floor, steps=320)


def caterpillar() -> Draft:
    """Left, Right, Up and Down bend the two joints: wriggle the green head to the blue wall."""
    draft = _course(2, "none", "swimmer")
    tail, first = draft.rod((0.6, 0.48), 0, 0.7, width=0.16)
    middle, second = draft.rod(first, 0, 0.7, width=0.16)
    head, _ = draft.rod(second, 0, 0.7, "green", width=0.16)
    draft.hinge(tail, middle, first, control=LEFT_RIGHT, speed=1.0, power=2.0, limits=(-80, 80))
    draft.hinge(middle, head, second, control=UP_DOWN, speed=1.0, power=2.0, limits=(-80, 80))
    _wall(draft, 3.9)
    return draft


def inchworm() -> Draft:
    """Three joints (Left and Right, Up and Down, W and S): wriggle over the step until the green
    head reaches the blue wall.
    """
    draft = Draft("crawler", "rhythm", difficulty=4, steps=400)
    tail, at = draft.rod((0.3, 0.48), 0, 0.54, width=0.15)
    last = tail
    for control, role in ((LEFT_RIGHT, "none"), (UP_DOWN, "none"), (W_S, "green")):
        part, end = draft.rod(at, 0, 0.54, role, width=0.15)
        draft.hinge(last, part, at, control=control, speed=0.8, power=1.5, limits=(-70, 70))
        last, at = part, end
    draft.shape(((3.0, FLOOR), (3.7, FLOOR), (3.5, 0.52), (3.2, 0.52)), fixed=True)
    draft.box((4.8, 1.3), 0.3, 1.8, "blue", fixed=True)
    return draft


def pogo() -> Draft:
    """Hip on Left and Right, knee on Up and Down, ankle on W and S: hop the green rider up to the
    blue lamp.
    """
    draft = _course(3, "none", "hopper")
    _hopper(draft, 1.2)
    _lamp(draft, 3.8, 1.9)
    return draft


def hot_foot() -> Draft:
    """The hopper again (Left and Right, Up and Down, W and S), but its green rider must not
    fall on the way to the blue lamp.
    """
    draft = _course(4, "red", "hopper")
    _hopper(draft, 1.0)
    _lamp(draft, 2.4, 1.75)
    return draft


def sprint() -> Draft:
    """Back leg on Left, Right, Up, Down and front leg on W, S, A, D: gallop to the blue wall."""
    draft = _course(2, "none", "cheetah")
    _cheetah(draft, 1.3)
    _wall(draft, 2.8)
    return draft


def hot_pursuit() -> Draft:
    """Gallop again with Left, Right, Up, Down, W, S, A and D, but keep the green back off the
    floor.
    """
    draft = _course(4, "red", "cheetah")
    _cheetah(draft, 1.1)
    _wall(draft, 2.6)
    return draft


def first_steps() -> Draft:
    """One leg on Left, Right, Up, Down, the other on W, S, A, D: stagger upright to the blue
    lamp.
    """
    draft = _course(2, "none", "walker-2d")
    _walker(draft, 1.2)
    _lamp(draft, 2.7, 1.85)
    return draft


def hot_coals() -> Draft:
    """Walk with Left, Right, Up, Down, W, S, A and D; if the green body falls on the floor, it
    burns.
    """
    draft = _course(5, "red", "walker-2d")
    _walker(draft, 1.0)
    _lamp(draft, 2.9, 1.9)
    return draft


LEVELS = {
    each.__name__: each
    for each in (
        caterpillar,
        inchworm,
        pogo,
        hot_foot,
        sprint,
        hot_pursuit,
        first_steps,
        hot_coals,
    )
}
