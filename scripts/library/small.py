"""Levels of size s: one polygon, two circles, one joint, one thruster."""

from scripts.library.draft import LEFT_RIGHT, Draft


def hang_on() -> Draft:
    """Hold 1 to fall slowly: the green balloon must meet the rolling blue ball above the red
    floor.
    """
    draft = Draft("thruster", "timing", "hazard", difficulty=2, floor="red")
    draft.box((1.0, 3.6), 1.7, 0.12, fixed=True, turn=-18)
    draft.ball((0.5, 4.0), 0.16, "blue")
    balloon = draft.ball((3.2, 4.3), 0.24, "green")
    draft.thruster(balloon, (3.2, 4.12), 90, 0.15)
    return draft


def plank_dash() -> Draft:
    """Left and Right turn the wheel under the blue plank: scoot over to the green ball."""
    draft = Draft("wheels", "unicycle", difficulty=1)
    plank = draft.box((3.7, 0.66), 1.2, 0.1, "blue", turn=-17)
    wheel = draft.ball((3.7, 0.66), 0.24)
    draft.hinge(plank, wheel, (3.7, 0.66), control=LEFT_RIGHT, speed=2.0, power=1.0)
    draft.ball((0.6, 0.68), 0.28, "green")
    return draft


def circus_act() -> Draft:
    """Left and Right roll the wheel: keep the green pole off the red floor and catch the blue
    ball.
    """
    draft = Draft("unicycle", "balance", "hazard", difficulty=3, floor="red")
    pole, _ = draft.rod((2.8, 0.62), 88, 1.1, "green", width=0.16)
    wheel = draft.ball((2.8, 0.62), 0.22)
    draft.hinge(pole, wheel, (2.8, 0.62), control=LEFT_RIGHT, speed=2.5, power=1.5)
    draft.ball((1.3, 4.6), 0.24, "blue")
    return draft


def tugboat() -> Draft:
    """Left and Right turn the funnel, 1 blows it: steer the green tug up to the blue moon."""
    draft = Draft("thruster", "aim", "flight", difficulty=2)
    hull = draft.box((1.0, 0.58), 0.6, 0.34, "green")
    funnel = draft.ball((1.0, 0.8), 0.17, density=0.5)
    draft.hinge(hull, funnel, (1.0, 0.8), control=LEFT_RIGHT, speed=0.4, power=1.0)
    draft.thruster(funnel, (1.0, 0.8), 90, 0.36)
    draft.ball((4.2, 3.8), 0.34, "blue", fixed=True)
    return draft


def wheelbarrow() -> Draft:
    """Right rolls the wheelbarrow along: run its green wheel into the blue ball in time."""
    draft = Draft("wheels", difficulty=1, steps=160)
    barrow = draft.box((0.98, 0.62), 1.1, 0.16, turn=9)
    wheel = draft.ball((1.5, 0.66), 0.26, "green")
    draft.hinge(barrow, wheel, (1.5, 0.66), control=LEFT_RIGHT, speed=1.5, power=1.0)
    draft.ball((4.1, 0.75), 0.35, "blue", density=0.3)
    return draft


def tiddlywink() -> Draft:
    """Right snaps the lever down: flick the green ball across the arena onto the blue one."""
    draft = Draft("catapult", "throw", difficulty=2)
    lever = draft.box((1.05, 0.85), 1.8, 0.1, turn=25)
    draft.hinge(
        "floor", lever, (1.05, 0.85), control=LEFT_RIGHT, speed=1.3, power=1.0, limits=(-65, 0)
    )
    draft.ball((0.29, 0.735), 0.16, "green", density=0.5)
    draft.ball((4.2, 2.2), 0.4, "blue", fixed=True)
    return draft


def swing_time() -> Draft:
    """Tap 1 in time with the swing to carry the green rod up to the blue ball, not back to the
    red.
    """
    draft = Draft("swing-up", "thruster", "timing", "hazard", difficulty=3)
    rod = draft.box((2.5, 4.2), 0.14, 1.5, "green")
    draft.hinge("ceiling", rod, (2.5, 4.9))
    # Too weak to do it in one push.
    draft.thruster(rod, (2.5, 3.5), 0, 0.025)
    draft.ball((4.1, 4.45), 0.22, "blue", fixed=True)
    draft.ball((0.8, 4.45), 0.22, "red", fixed=True)
    return draft


def ski_jump() -> Draft:
    """Hold 1 to speed over the ice and jump: the green puck must hit the blue ball in the air."""
    draft = Draft("thruster", "jump", "ice", difficulty=1, friction=0.0)
    draft.shape(((1.9, 0.4), (3.1, 0.4), (3.1, 1.0)), fixed=True)
    puck = draft.ball((0.5, 0.58), 0.18, "green")
    draft.thruster(puck, (0.36, 0.58), 0, 0.07)
    draft.ball((4.5, 1.5), 0.3, "blue", fixed=True)
    return draft


def parcel_drop() -> Draft:
    """Hold 1 to brake the falling green parcel, so that it lands on blue and not on red."""
    draft = Draft("thruster", "timing", "hazard", difficulty=1)
    parcel = draft.box((0.5, 4.3), 0.36, 0.3, "green", velocity=(3.6, 0.0))
    draft.thruster(parcel, (0.68, 4.3), 180, 0.1)
    draft.ball((2.4, 0.72), 0.32, "blue", fixed=True)
    draft.ball((3.7, 0.72), 0.32, "red", fixed=True)
    return draft


def wheelie() -> Draft:
    """Drive with Left and Right. Only a wheelie lifts the green tail as high as the blue lamp."""
    draft = Draft("wheels", "balance", difficulty=2)
    tail, _ = draft.rod((2.85, 0.49), 6, 1.2, "green", density=0.6, friction=0.3)
    # A heavy wheel that grips: its torque must lift the tail.
    wheel = draft.ball((3.7, 0.62), 0.22, density=1.5, friction=2.5)
    draft.hinge(tail, wheel, (3.7, 0.62), control=LEFT_RIGHT, speed=3.0, power=2.0)
    draft.ball((1.0, 1.35), 0.2, "blue", fixed=True)
    return draft


LEVELS = {
    each.__name__: each
    for each in (
        hang_on,
        plank_dash,
        circus_act,
        tugboat,
        wheelbarrow,
        tiddlywink,
        swing_time,
        ski_jump,
        parcel_drop,
        wheelie,
    )
}
