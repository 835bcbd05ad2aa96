"""Levels of size l on wheels."""

from scripts.library.draft import LEFT_RIGHT, UP_DOWN, Draft
from scripts.library.machines import car


def delivery() -> Draft:
    """Drive the lorry with Left and Right: tip its green ball onto the blue pad, not the red
    floor.
    """
    draft = Draft("wheels", "lorry", "hazard", difficulty=2, floor="red")
    made = car(draft, 1.1, 0.4, length=1.2, role="none", radius=0.18)
    for x in (0.56, 1.64):
        board = draft.box((x, 0.785), 0.1, 0.05)
        draft.weld(made.chassis, board, (x, 0.76))
    draft.ball((1.1, 0.94), 0.17, "green", density=0.4)
    draft.box((4.2, 0.5), 1.2, 0.2, "blue", fixed=True)
    return draft


def stunt_car() -> Draft:
    """Race left with Left, leap off the ramp over the red pit and reach the blue tower."""
    draft = Draft("wheels", "jump", "ramp", "hazard", difficulty=2)
    draft.box((4.2, 0.95), 1.6, 1.1, fixed=True)
    draft.shape(((3.4, 1.5), (3.95, 1.5), (3.4, 1.7)), fixed=True)
    draft.box((2.85, 0.44), 1.1, 0.08, "red", fixed=True)
    draft.box((1.35, 0.6), 1.9, 0.4, fixed=True)
    draft.box((0.2, 1.0), 0.4, 1.2, "blue", fixed=True)
    car(draft, 4.45, 1.5, length=0.7, radius=0.16, speed=4.0, power=3.0)
    return draft


def periscope() -> Draft:
    """Drive with Left and Right, lay the green mast down with Down to pass the red bar, raise it
    to blue.
    """
    draft = Draft("wheels", "arm", "hazard", difficulty=2)
    made = car(draft, 0.9, 0.4, role="none")
    mast = draft.box((0.9, 1.2), 0.1, 0.95, "green", density=0.4)
    draft.hinge(
        made.chassis, mast, (0.9, 0.75), control=UP_DOWN, speed=0.4, power=1.0, limits=(-88, 88)
    )
    draft.box((2.7, 1.75), 0.2, 1.2, "red", fixed=True)
    draft.ball((4.2, 2.0), 0.3, "blue", fixed=True)
    return draft


def car_park() -> Draft:
    """Left and Right: drive the green car down two decks and back to the blue bay at the bottom
    left.
    """
    draft = Draft("wheels", "platforms", difficulty=2, steps=320)
    draft.box((0.9, 3.3), 1.8, 0.14, fixed=True)
    draft.box((2.6, 3.3), 1.6, 0.14, fixed=True)
    draft.box((4.1, 1.9), 1.8, 0.14, fixed=True)
    draft.box((2.4, 1.9), 1.6, 0.14, fixed=True)
    draft.box((0.3, 0.75), 0.4, 0.7, "blue", fixed=True)
    car(draft, 0.8, 3.37, length=0.7, radius=0.15)
    return draft


def drawbridge() -> Draft:
    """Bump the raised bridge with Right until it falls across the red moat, then drive to the blue
    gate.
    """
    draft = Draft("wheels", "lever", "hazard", difficulty=2, floor="red")
    bank = draft.box((1.1, 0.8), 1.8, 0.8, fixed=True)
    draft.box((4.2, 0.8), 1.6, 0.8, fixed=True)
    bridge, _ = draft.rod((2.02, 1.18), 96, 1.6, width=0.1, density=0.3)
    draft.hinge(bank, bridge, (2.02, 1.18), limits=(-115, 4))
    draft.box((4.6, 1.6), 0.4, 0.8, "blue", fixed=True)
    car(draft, 0.8, 1.2, length=0.8, radius=0.18, speed=2.0, power=2.5)
    return draft


def monorail() -> Draft:
    """Left and Right turn both wheels of the green trolley: bring it down on the blue ball
    below.
    """
    draft = Draft("wheels", "rail", "hazard", difficulty=3, floor="red")
    draft.box((2.0, 3.0), 1.9, 0.16, fixed=True)
    frame = draft.box((1.6, 3.0), 0.1, 0.66, collision="ghost")
    above = draft.ball((1.6, 3.3), 0.2, "green")
    below = draft.ball((1.6, 2.7), 0.2)
    for wheel, y in ((above, 3.3), (below, 2.7)):
        draft.hinge(frame, wheel, (1.6, y), control=LEFT_RIGHT, speed=1.5, power=1.5)
    draft.ball((3.4, 1.4), 0.45, "blue", fixed=True)
    return draft


def waiter() -> Draft:
    """Drive with Left and Right so that the pole stays up: serve the green glass at the blue
    table.
    """
    draft = Draft("cart-pole", "wheels", "balance", "hazard", difficulty=4, floor="red")
    made = car(draft, 1.2, 0.4, role="none", length=0.8, speed=2.0, power=2.0)
    pole = draft.box((1.2, 1.2), 0.08, 0.9, density=0.4)
    draft.hinge(made.chassis, pole, (1.2, 0.75))
    glass = draft.ball((1.2, 1.75), 0.14, "green", density=0.4)
    draft.weld(pole, glass, (1.2, 1.65))
    draft.box((3.1, 1.6), 0.4, 0.9, "blue", fixed=True)
    return draft


def tightrope() -> Draft:
    """Left and Right: ride the unicycle along the rope and hand the green hat to the blue crow."""
    draft = Draft("unicycle", "balance", "hazard", difficulty=4, floor="red")
    draft.box((1.3, 1.8), 1.9, 0.1, fixed=True)
    draft.box((3.2, 1.8), 1.9, 0.1, fixed=True)
    pole = draft.box((0.9, 2.5), 0.1, 0.85)
    wheel = draft.ball((0.9, 2.07), 0.22)
    hat = draft.box((0.9, 3.0), 0.34, 0.16, "green", density=0.4)
    draft.hinge(pole, wheel, (0.9, 2.07), control=LEFT_RIGHT, speed=2.0, power=1.5)
    draft.weld(pole, hat, (0.9, 2.93))
    draft.ball((3.9, 3.0), 0.26, "blue", fixed=True)
    return draft


def reverse_parking() -> Draft:
    """Left and Right drive the tractor: back its trailer up until the green crate meets the blue
    gate.
    """
    draft = Draft("wheels", "trailer", difficulty=2)
    tractor = car(draft, 3.7, 0.4, role="none", length=0.7, height=0.3, speed=1.2, power=2.0)
    bed = draft.box((2.55, 0.68), 1.1, 0.14)
    for x in (2.2, 2.9):
        wheel = draft.ball((x, 0.54), 0.14)
        draft.hinge(bed, wheel, (x, 0.54))
    draft.hinge(tractor.chassis, bed, (3.2, 0.68), limits=(-40, 40))
    draft.box((2.4, 0.96), 0.44, 0.42, "green", density=0.4)
    draft.box((0.5, 1.0), 0.3, 1.2, "blue", fixed=True)
    return draft


def which_way() -> Draft:
    """Left and Right turn the wheel of the green barrow: roll it off the table onto the blue
    side.
    """
    draft = Draft("wheels", "platforms", "hazard", difficulty=1)
    draft.box((2.5, 2.2), 1.9, 0.14, fixed=True)
    draft.box((2.5, 1.27), 0.24, 1.7, fixed=True)
    block = draft.box((2.4, 2.47), 0.5, 0.3, "green")
    wheel = draft.ball((2.72, 2.5), 0.23)
    draft.hinge(block, wheel, (2.65, 2.5), control=LEFT_RIGHT, speed=1.0, power=1.5)
    draft.ball((0.8, 0.8), 0.4, "blue", fixed=True)
    draft.ball((4.2, 0.8), 0.4, "red", fixed=True)
    return draft


def oddball() -> Draft:
    """One lopsided wheel on Left and Right: hobble over the step to the blue ball."""
    draft = Draft("wheels", "rhythm", difficulty=2)
    block = draft.box((1.0, 0.72), 0.8, 0.24, "green")
    wheel = draft.ball((1.24, 0.68), 0.28)
    draft.hinge(block, wheel, (1.34, 0.72), control=LEFT_RIGHT, speed=1.2, power=2.5)
    draft.box((2.6, 0.46), 0.5, 0.12, fixed=True)
    draft.ball((4.4, 0.8), 0.35, "blue", fixed=True)
    return draft


LEVELS = {
    each.__name__: each
    for each in (
        delivery,
        stunt_car,
        periscope,
        car_park,
        drawbridge,
        monorail,
        waiter,
        tightrope,
        reverse_parking,
        which_way,
        oddball,
    )
}
