"""Levels of size m: two polygons, three circles, two joints, two thrusters."""

from scripts.library.draft import KEY_1, KEY_2, LEFT_RIGHT, UP_DOWN, Draft
from scripts.library.machines import arm, car


def high_five() -> Draft:
    """Left and Right turn the shoulder, Up and Down the elbow: slap the blue ball with the green
    hand.
    """
    draft = Draft("arm", "reach", "hazard", difficulty=2)
    arm(draft, (2.5, 1.6), ((0, 0.95, "none"), (60, 0.85, "green")))
    draft.ball((0.95, 2.6), 0.26, "blue", fixed=True)
    draft.ball((3.9, 3.0), 0.3, "red", fixed=True)
    return draft


def back_scratcher() -> Draft:
    """Shoulder on Left and Right, elbow on Up and Down: only the blue hand may touch the green
    itch.
    """
    draft = Draft("arm", "reach", difficulty=3)
    arm(draft, (2.5, 2.2), ((180, 1.0, "red"), (200, 0.9, "blue")))
    draft.ball((3.15, 2.75), 0.2, "green", fixed=True)
    return draft


def salute() -> Draft:
    """Raise the green forearm to the blue star with Left, Right, Up and Down; the floor is
    deadly.
    """
    draft = Draft("arm", "reach", "hazard", difficulty=2, floor="red")
    arm(draft, (2.2, 2.0), ((-10, 0.9, "none"), (20, 0.9, "green")), power=1.5)
    draft.ball((2.2, 3.7), 0.28, "blue", fixed=True)
    return draft


def sunday_drive() -> Draft:
    """Drive the green car with Left and Right to the blue garage, not into the red barrel."""
    draft = Draft("wheels", "hazard", difficulty=1)
    car(draft, 2.6, 0.4)
    draft.box((0.35, 0.8), 0.5, 0.8, "blue")
    draft.ball((4.4, 0.7), 0.3, "red")
    return draft


def speed_bump() -> Draft:
    """Drive right with Right, over the bump, and bring the green car to the blue ball."""
    draft = Draft("wheels", "ramp", difficulty=1)
    car(draft, 0.8, 0.4, speed=2.5, power=2.0)
    draft.shape(((2.1, 0.4), (3.3, 0.4), (2.8, 0.68), (2.6, 0.68)), fixed=True)
    draft.ball((4.5, 0.72), 0.32, "blue", fixed=True)
    return draft


def interceptor() -> Draft:
    """Hold 1 at the right moment: the blue rocket must meet the green crate before it hits the
    floor.
    """
    draft = Draft("thruster", "timing", "hazard", difficulty=2, floor="red")
    draft.box((3.6, 4.5), 0.4, 0.4, "green")
    rocket = draft.box((0.6, 3.4), 0.6, 0.24, "blue", density=0.6)
    draft.thruster(rocket, (0.3, 3.4), 0, 0.14, KEY_1)
    draft.thruster(rocket, (0.6, 3.28), 90, 0.1, KEY_2)
    return draft


def tee_off() -> Draft:
    """Swing the club with Left and Right: hit the green ball off its tee and onto the blue one."""
    draft = Draft("bat", "throw", difficulty=2)
    hub = draft.ball((1.0, 1.9), 0.12, fixed=True)
    club = draft.box((0.72, 1.42), 0.12, 1.1, turn=-30)
    draft.hinge(hub, club, (1.0, 1.9), control=LEFT_RIGHT, speed=2.0, power=1.5)
    draft.box((1.22, 0.6), 0.34, 0.4, fixed=True)
    draft.ball((1.22, 0.96), 0.15, "green", density=0.4)
    draft.ball((4.3, 0.95), 0.45, "blue", fixed=True)
    return draft


def leapfrog() -> Draft:
    """Thruster 1 lifts and 2 pushes right: hop the green crate over the red ball to the blue
    one.
    """
    draft = Draft("thruster", "jump", "hazard", difficulty=1)
    crate = draft.box((0.7, 0.6), 0.4, 0.4, "green")
    draft.thruster(crate, (0.7, 0.42), 90, 0.25, KEY_1)
    draft.thruster(crate, (0.52, 0.6), 0, 0.12, KEY_2)
    draft.ball((2.4, 0.95), 0.55, "red", fixed=True)
    draft.ball((4.2, 0.75), 0.35, "blue", fixed=True)
    return draft


def turnabout() -> Draft:
    """Flip the car with 1 and 2 and drive with Left and Right: blue wheel to the green crate, not
    red.
    """
    draft = Draft("wheels", "thruster", difficulty=3)
    made = car(draft, 2.1, 0.4, role="none", wheel_roles=("blue", "red"), length=1.0)
    draft.thruster(made.chassis, (1.65, 0.6), 90, 0.45, KEY_1)
    draft.thruster(made.chassis, (2.55, 0.6), 90, 0.45, KEY_2)
    draft.box((4.4, 1.0), 0.5, 1.2, "green", fixed=True)
    return draft


def stumbler() -> Draft:
    """Left and Right turn both joints at once: stumble and roll the green head to the blue ball."""
    draft = Draft("crawler", "rhythm", difficulty=3)
    base = draft.box((1.0, 0.5), 1.0, 0.2)
    neck = draft.box((1.0, 0.95), 0.14, 0.9)
    draft.hinge(base, neck, (1.0, 0.55), control=LEFT_RIGHT, speed=1.0, power=2.0)
    head = draft.ball((1.0, 1.45), 0.22, "green")
    draft.hinge(neck, head, (1.0, 1.35), control=LEFT_RIGHT, speed=1.0, power=2.0)
    draft.ball((4.2, 0.75), 0.35, "blue", fixed=True)
    return draft


def batter_up() -> Draft:
    """A green ball drops in over the red floor: spin the bat with Left or Right to hit it onto
    blue.
    """
    draft = Draft("bat", "timing", "hazard", difficulty=2, floor="red")
    hub = draft.ball((2.0, 1.7), 0.14, fixed=True)
    bat = draft.box((2.0, 1.7), 1.5, 0.14, turn=80)
    draft.hinge(hub, bat, (2.0, 1.7), control=LEFT_RIGHT, speed=1.2, power=1.5)
    draft.ball((1.75, 4.6), 0.2, "green", density=0.5)
    draft.ball((4.2, 1.8), 0.5, "blue", fixed=True)
    return draft


def bee_line() -> Draft:
    """Thruster 1 lifts and 2 pushes right: fly the green bee to the blue hive in the corner."""
    draft = Draft("thruster", "flight", difficulty=1)
    bee = draft.box((0.8, 0.56), 0.44, 0.32, "green")
    draft.thruster(bee, (0.8, 0.42), 90, 0.22, KEY_1)
    draft.thruster(bee, (0.6, 0.56), 0, 0.1, KEY_2)
    draft.box((4.2, 4.3), 0.9, 0.7, "blue", fixed=True)
    return draft


def mayfly() -> Draft:
    """Thruster 1 lifts and 2 pushes left: carry the green mayfly to the blue leaf before it
    tires.
    """
    draft = Draft("thruster", "flight", difficulty=1, steps=128)
    fly = draft.shape(((3.9, 0.42), (4.6, 0.42), (4.25, 0.9)), "green")
    draft.thruster(fly, (4.25, 0.5), 90, 0.28, KEY_1)
    draft.thruster(fly, (4.4, 0.6), 180, 0.1, KEY_2)
    draft.box((0.9, 3.6), 1.0, 0.2, "blue", fixed=True, turn=20)
    return draft


def fork_in_the_air() -> Draft:
    """The green crate falls onto a wedge: push it with 1 and 2 to the blue side, away from red."""
    draft = Draft("thruster", "timing", "hazard", difficulty=1)
    crate = draft.box((2.5, 4.4), 0.4, 0.36, "green")
    draft.thruster(crate, (2.7, 4.4), 180, 0.08, KEY_1)
    draft.thruster(crate, (2.3, 4.4), 0, 0.08, KEY_2)
    draft.shape(((2.1, 1.6), (2.9, 1.6), (2.5, 2.2)), fixed=True)
    draft.ball((1.3, 0.9), 0.5, "red", fixed=True)
    draft.ball((3.7, 0.9), 0.5, "blue", fixed=True)
    return draft


def catcher() -> Draft:
    """Slide the blue glove over the red floor with 1 and 2 to catch the green ball off its peg."""
    draft = Draft("thruster", "timing", "hazard", difficulty=2, floor="red", friction=0.3)
    glove = draft.box((1.0, 0.52), 0.9, 0.22, "blue")
    draft.thruster(glove, (0.6, 0.52), 0, 0.15, KEY_1)
    draft.thruster(glove, (1.4, 0.52), 180, 0.15, KEY_2)
    draft.ball((2.55, 4.6), 0.2, "green")
    draft.ball((2.45, 2.9), 0.25, fixed=True)
    return draft


def shove() -> Draft:
    """Hold 1 to shove the green ball up the ramp and over its edge, down onto the blue cushion."""
    draft = Draft("thruster", "ramp", "throw", difficulty=2, friction=0.3)
    draft.shape(((0.0, 0.4), (1.75, 0.4), (1.75, 1.15)), fixed=True)
    tug = draft.box((0.4, 0.72), 0.36, 0.26, turn=23.2)
    draft.thruster(tug, (0.26, 0.66), 23.2, 0.24, KEY_1)
    draft.ball((0.84, 1.0), 0.22, "green", density=0.4)
    draft.ball((3.6, 0.8), 0.4, "blue", fixed=True)
    return draft


def keyhole() -> Draft:
    """Thruster 1 lifts, 2 pushes right: thread the green crate between the ball and the red bar."""
    draft = Draft("thruster", "flight", "hazard", difficulty=3)
    crate = draft.box((0.7, 0.56), 0.34, 0.3, "green")
    draft.thruster(crate, (0.7, 0.43), 90, 0.17, KEY_1)
    draft.thruster(crate, (0.55, 0.56), 0, 0.07, KEY_2)
    draft.box((2.5, 4.05), 0.3, 1.8, "red", fixed=True)
    draft.ball((2.5, 1.1), 0.7, fixed=True)
    draft.ball((4.3, 3.6), 0.3, "blue", fixed=True)
    return draft


def torch_bearer() -> Draft:
    """Balance with Left and Right: roll the green torch to the blue lamp without dropping it on
    red.
    """
    draft = Draft("unicycle", "balance", "hazard", difficulty=4, floor="red")
    pole = draft.box((1.2, 1.2), 0.12, 1.1)
    wheel = draft.ball((1.2, 0.65), 0.25)
    torch = draft.ball((1.2, 1.85), 0.17, "green", density=0.4)
    draft.hinge(pole, wheel, (1.2, 0.65), control=LEFT_RIGHT, speed=2.0, power=1.5)
    draft.weld(pole, torch, (1.2, 1.75))
    draft.ball((4.1, 1.85), 0.3, "blue", fixed=True)
    return draft


def juggling_sled() -> Draft:
    """Push the sled with 1 and 2 to keep the green pole upright until it leans on the blue lamp."""
    draft = Draft(
        "cart-pole", "thruster", "balance", "hazard", difficulty=4, floor="red", friction=0.1
    )
    sled = draft.box((1.2, 0.54), 0.7, 0.24, density=2.0)
    pole, _ = draft.rod((1.2, 0.6), 92, 1.1, "green")
    draft.hinge(sled, pole, (1.2, 0.6))
    draft.thruster(sled, (0.9, 0.54), 0, 0.6, KEY_1)
    draft.thruster(sled, (1.5, 0.54), 180, 0.6, KEY_2)
    draft.ball((3.0, 1.4), 0.35, "blue", fixed=True)
    return draft


def segway() -> Draft:
    """Left and Right swing the pole against the sliding cart: tip the green pole onto the blue
    ball.
    """
    draft = Draft("cart-pole", "motor", "hazard", difficulty=3, floor="red", friction=0.2)
    cart = draft.box((2.5, 0.56), 0.8, 0.28, density=1.5)
    pole = draft.box((2.5, 1.15), 0.12, 1.1, "green")
    draft.hinge(cart, pole, (2.5, 0.65), control=LEFT_RIGHT, speed=1.0, power=0.6, limits=(-75, 75))
    draft.ball((4.35, 0.95), 0.28, "blue", fixed=True)
    draft.ball((0.65, 0.95), 0.28, "red", fixed=True)
    return draft


def acrobat() -> Draft:
    """Only the hip has a motor: swing with Left and Right until the green legs kick the blue
    ball.
    """
    draft = Draft("swing-up", "rhythm", difficulty=3)
    body = draft.box((2.5, 4.5), 0.14, 0.9)
    legs = draft.box((2.5, 3.66), 0.14, 0.9, "green")
    draft.hinge("ceiling", body, (2.5, 4.9))
    draft.hinge(
        body, legs, (2.5, 4.08), control=LEFT_RIGHT, speed=1.0, power=0.5, limits=(-110, 110)
    )
    draft.ball((4.15, 4.3), 0.24, "blue", fixed=True)
    return draft


def tray() -> Draft:
    """Tilt the tray gently with Left and Right: roll the green ball to blue, not to red."""
    draft = Draft("balance", "beam", "hazard", difficulty=1)
    hub = draft.ball((2.5, 1.6), 0.05, fixed=True)
    beam = draft.box((2.5, 1.6), 1.95, 0.12, density=2.0)
    draft.hinge(hub, beam, (2.5, 1.6), control=LEFT_RIGHT, speed=0.1, power=0.5)
    draft.ball((2.35, 1.86), 0.18, "green", density=0.3)
    draft.ball((4.0, 0.8), 0.4, "blue", fixed=True)
    draft.box((1.1, 0.8), 0.7, 0.8, "red", fixed=True)
    return draft


def grasshopper() -> Draft:
    """Snap the two legs apart with Left and Right: jump until the green thigh taps the blue
    lamp.
    """
    draft = Draft("jump", "rhythm", difficulty=3)
    shin, knee = draft.rod((1.9, 0.5), 0, 0.95, density=1.5)
    thigh, _ = draft.rod(knee, 152, 0.95, "green")
    draft.hinge(shin, thigh, knee, control=LEFT_RIGHT, speed=3.0, power=4.0, limits=(-120, 15))
    draft.ball((2.2, 2.35), 0.26, "blue", fixed=True)
    return draft


def rollers() -> Draft:
    """Left and Right turn the first roller, Up and Down the second: throw the green crate onto
    blue.
    """
    draft = Draft("rollers", "throw", difficulty=2)
    first = draft.ball((1.0, 1.5), 0.34)
    second = draft.ball((1.8, 1.5), 0.34)
    draft.hinge("floor", first, (1.0, 1.5), control=LEFT_RIGHT, speed=1.5, power=1.0)
    draft.hinge("floor", second, (1.8, 1.5), control=UP_DOWN, speed=1.5, power=1.0)
    draft.box((1.15, 2.0), 0.7, 0.3, "green", density=0.5)
    draft.ball((4.1, 0.72), 0.32, "blue", fixed=True)
    return draft


LEVELS = {
    each.__name__: each
    for each in (
        high_five,
        back_scratcher,
        salute,
        sunday_drive,
        speed_bump,
        interceptor,
        tee_off,
        leapfrog,
        turnabout,
        stumbler,
        batter_up,
        bee_line,
        mayfly,
        fork_in_the_air,
        catcher,
        shove,
        keyhole,
        torch_bearer,
        juggling_sled,
        segway,
        acrobat,
        tray,
        grasshopper,
        rollers,
    )
}
