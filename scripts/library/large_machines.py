"""Levels of size l about arms, levers, gears and throwing."""

from scripts.library.draft import FLOOR, KEY_1, KEY_2, LEFT_RIGHT, UP_DOWN, W_S, Draft
from scripts.library.machines import arm


def cogs() -> Draft:
    """Left and Right turn the lower cog: let the upper one tip the green ball onto the blue
    shelf.
    """
    draft = Draft("gears", "timing", "hazard", difficulty=2, floor="red")
    for y, turn, driven in ((2.9, 0, False), (1.95, 45, True)):
        hub = draft.ball((2.5, y), 0.12, fixed=True)
        beam = draft.box((2.5, y), 1.2, 0.12, turn=turn)
        cross = draft.box((2.5, y), 1.2, 0.12, turn=turn + 90)
        motor = {"control": LEFT_RIGHT, "speed": 0.3, "power": 1.5} if driven else {}
        draft.hinge(hub, beam, (2.5, y), **motor)
        draft.weld(beam, cross, (2.5, y))
    draft.ball((2.86, 3.14), 0.17, "green", density=0.3)
    draft.box((1.0, 1.5), 1.2, 0.16, "blue", fixed=True)
    return draft


def helping_hand() -> Draft:
    """Move with Left, Right, Up and Down, grip with W and S: carry the green box to the blue
    shelf.
    """
    draft = Draft("arm", "grasp", "hazard", difficulty=5, floor="red", steps=400)
    links, wrist = arm(
        draft, (2.6, 4.2), ((-140, 1.35, "none"), (-70, 0.95, "none")), speed=0.3, power=1.5
    )
    for side in (-1, 1):
        root = (wrist[0] + side * 0.06, wrist[1])
        finger, _ = draft.rod(root, -90 + side * 22, 0.6, width=0.1, friction=2.0)
        draft.hinge(
            links[1],
            finger,
            root,
            control=W_S,
            speed=0.4 * side,
            power=1.0,
            limits=(-30, 30),
        )
    # The box stands on a pillar under the hand, its top where open fingers end.
    x, y = wrist[0], wrist[1] - 0.75
    draft.box((x, (FLOOR + y - 0.15) / 2), 0.3, y - 0.15 - FLOOR, fixed=True)
    draft.box((x, y), 0.3, 0.3, "green", density=0.4, friction=2.0)
    draft.box((4.2, 1.6), 1.0, 0.2, "blue", fixed=True)
    return draft


def ladle() -> Draft:
    """Left and Right turn the arm, Up and Down the cup: pour the green ball into the blue bowl."""
    draft = Draft("arm", "carry", "hazard", difficulty=3, floor="red")
    hub = draft.ball((1.7, 2.9), 0.14, fixed=True)
    bar, wrist = draft.rod((1.7, 2.9), 180, 1.0, width=0.14)
    draft.hinge(hub, bar, (1.7, 2.9), control=LEFT_RIGHT, speed=0.3, power=1.5)
    x, y = wrist[0] - 0.3, wrist[1] - 0.5
    cup = draft.box((x, y), 0.7, 0.1)
    rim = draft.box((x - 0.3, y + 0.17), 0.1, 0.24)
    draft.weld(cup, rim, (x - 0.3, y + 0.05))
    handle = draft.box((x + 0.3, y + 0.3), 0.1, 0.5)
    draft.weld(cup, handle, (x + 0.3, y + 0.05))
    draft.hinge(bar, handle, wrist, control=UP_DOWN, speed=0.3, power=1.0, limits=(-100, 60))
    draft.ball((x, y + 0.2), 0.15, "green", density=0.4)
    draft.box((4.1, 1.5), 1.1, 0.2, "blue", fixed=True)
    return draft


def skittles() -> Draft:
    """Left and Right swing the wrecking ball: knock the green slab off its pillars onto the blue
    floor.
    """
    draft = Draft("catapult", "tower", difficulty=1, floor="blue")
    beam, knee = draft.rod((2.1, 4.9), -90, 1.55, width=0.1)
    draft.hinge(
        "ceiling", beam, (2.1, 4.9), control=LEFT_RIGHT, speed=0.6, power=0.5, limits=(-80, 80)
    )
    rope, end = draft.rod(knee, -90, 1.55, width=0.06)
    draft.hinge(beam, rope, knee)
    weight = draft.ball(end, 0.32, density=2.0)
    draft.weld(rope, weight, end)
    for x in (3.2, 4.0):
        draft.box((x, 1.1), 0.2, 1.4, fixed=x > 3.5, role="none")
    draft.box((3.6, 1.9), 1.1, 0.2, "green", density=0.6)
    return draft


def seesaw_twins() -> Draft:
    """Push the heavy ball off its tower with 1 or 2: it must throw the green box up to the blue
    ball.
    """
    draft = Draft("lever", "throw", "thruster", difficulty=2)
    draft.box((2.5, 3.5), 0.5, 0.14, fixed=True)
    weight = draft.ball((2.5, 3.83), 0.26, density=4.0)
    draft.thruster(weight, (2.5, 3.83), 0, 0.3, KEY_1)
    draft.thruster(weight, (2.5, 3.83), 180, 0.3, KEY_2)
    for x, side, role in ((1.3, -1, "none"), (3.7, 1, "green")):
        pivot = draft.ball((x, 0.62), 0.12, fixed=True)
        plank = draft.box((x, 0.76), 1.5, 0.1)
        draft.hinge(pivot, plank, (x, 0.7), limits=(-14, 14))
        draft.box((x + side * 0.56, 0.97), 0.28, 0.28, role, density=0.5)
    draft.box((4.5, 3.0), 0.6, 0.4, "blue", fixed=True)
    return draft


def marble_run() -> Draft:
    """Left and Right tilt the upper beam, Up and Down the lower: roll the green ball into the blue
    cup.
    """
    draft = Draft("beam", "balance", "hazard", difficulty=2, floor="red")
    for control, (x, y) in enumerate(((1.7, 3.4), (3.1, 2.0))):
        hub = draft.ball((x, y), 0.05, fixed=True)
        beam = draft.box((x, y), 1.9, 0.12, density=2.0)
        draft.hinge(hub, beam, (x, y), control=control, speed=0.12, power=0.5, limits=(-35, 35))
    draft.ball((1.6, 3.64), 0.18, "green", density=0.3)
    draft.box((1.0, 0.8), 1.0, 0.2, "blue", fixed=True)
    return draft


def chimes() -> Draft:
    """Left and Right push the upper rod: swing the green clapper up to the blue bell."""
    draft = Draft("swing-up", "rhythm", difficulty=3)
    hub = draft.ball((2.5, 3.0), 0.12, fixed=True)
    upper, elbow = draft.rod((2.5, 3.0), -90, 0.8, width=0.1)
    draft.hinge(
        hub, upper, (2.5, 3.0), control=LEFT_RIGHT, speed=0.8, power=0.4, limits=(-100, 100)
    )
    lower, tip = draft.rod(elbow, -90, 0.8, width=0.1)
    draft.hinge(upper, lower, elbow)
    clapper = draft.ball(tip, 0.18, "green")
    draft.weld(lower, clapper, tip)
    draft.ball((4.1, 3.4), 0.3, "blue", fixed=True)
    return draft


def pinball_wizard() -> Draft:
    """Left and Right snap one flipper, Up and Down the other: bat the green ball up to the blue
    bumper.
    """
    draft = Draft("pinball", "timing", "hazard", difficulty=3, floor="red")
    for control, (x, angle, side) in enumerate(((1.3, -18, 1), (3.7, 198, -1))):
        hub = draft.ball((x, 1.4), 0.1, fixed=True)
        flipper, _ = draft.rod((x, 1.4), angle, 0.95, width=0.14)
        limits = (0, 50) if side == 1 else (-50, 0)
        draft.hinge(hub, flipper, (x, 1.4), control=control, speed=3.0, power=2.0, limits=limits)
    draft.shape(((0.0, 1.4), (1.16, 1.4), (0.0, 2.1)), fixed=True)
    draft.shape(((5.0, 1.4), (5.0, 2.1), (3.84, 1.4)), fixed=True)
    draft.ball((1.2, 4.2), 0.18, "green", density=0.4, restitution=0.4)
    draft.ball((3.4, 4.3), 0.36, "blue", fixed=True, restitution=0.4)
    return draft


def silver_ball() -> Draft:
    """Left and Right flip. Keep the green ball off the red drain and send it up to the blue
    target.
    """
    draft = Draft("pinball", "timing", "hazard", difficulty=3, floor="red")
    # The slopes end above the axles: a notch would catch the ball.
    draft.shape(((0.0, 1.45), (1.4, 1.55), (0.0, 2.25)), fixed=True)
    draft.shape(((5.0, 1.45), (5.0, 2.25), (3.6, 1.55)), fixed=True)
    for side, x in ((1, 1.35), (-1, 3.65)):
        hub = draft.ball((x, 1.42), 0.1, fixed=True)
        flipper = draft.box((x + side * 0.428, 1.281), 1.0, 0.13, turn=-18 * side, restitution=0.2)
        draft.hinge(
            hub,
            flipper,
            (x, 1.42),
            control=LEFT_RIGHT,
            speed=2.0,
            power=0.8,
            limits=(-6, 50) if side > 0 else (-50, 6),
        )
    draft.ball((1.2, 3.0), 0.17, "green", density=0.7, restitution=0.4)
    draft.ball((3.4, 3.1), 0.3, fixed=True, restitution=0.8)
    draft.box((2.3, 4.86), 1.8, 0.28, "blue", fixed=True)
    return draft


LEVELS = {
    each.__name__: each
    for each in (
        cogs,
        helping_hand,
        ladle,
        skittles,
        seesaw_twins,
        marble_run,
        chimes,
        pinball_wizard,
        silver_ball,
    )
}
