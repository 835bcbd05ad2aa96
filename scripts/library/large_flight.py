"""Levels of size l in the air."""

from scripts.library.draft import KEY_1, KEY_2, Draft


def open_sky() -> Draft:
    """Thruster 1 lifts and 2 pushes right: fly the green kite from its perch to the blue cloud."""
    draft = Draft("thruster", "flight", "hazard", difficulty=1, floor="red")
    draft.box((0.8, 1.0), 1.0, 1.2, fixed=True)
    kite = draft.box((0.8, 1.78), 0.36, 0.36, "green")
    draft.thruster(kite, (0.8, 1.62), 90, 0.2, KEY_1)
    draft.thruster(kite, (0.64, 1.78), 0, 0.1, KEY_2)
    draft.box((4.2, 4.0), 1.0, 0.5, "blue", fixed=True)
    return draft


def letterbox() -> Draft:
    """Thruster 1 flaps, 2 flies on: post the green letter through both red slots to the blue
    box.
    """
    draft = Draft("thruster", "flight", "hazard", difficulty=3, floor="red")
    letter = draft.box((0.6, 2.4), 0.34, 0.24, "green")
    draft.thruster(letter, (0.6, 2.3), 90, 0.14, KEY_1)
    draft.thruster(letter, (0.45, 2.4), 0, 0.05, KEY_2)
    draft.box((1.8, 0.9), 0.24, 1.0, "red", fixed=True)
    draft.box((1.8, 3.85), 0.24, 1.9, "red", fixed=True)
    draft.box((3.2, 1.3), 0.24, 1.8, "red", fixed=True)
    draft.box((3.2, 4.3), 0.24, 1.2, "red", fixed=True)
    draft.box((4.5, 2.4), 0.5, 0.9, "blue", fixed=True)
    return draft


def zigzag() -> Draft:
    """Thrusters 1 and 2 push right and left: slide the green crate down the shelves to the blue
    mat.
    """
    draft = Draft("thruster", "maze", "hazard", difficulty=2, friction=0.3, steps=320)
    crate = draft.box((0.6, 4.2), 0.36, 0.36, "green")
    draft.thruster(crate, (0.42, 4.2), 0, 0.1, KEY_1)
    draft.thruster(crate, (0.78, 4.2), 180, 0.1, KEY_2)
    for x in (0.9, 2.7):
        draft.box((x, 3.5), 1.8, 0.14, fixed=True)
    for x in (4.1, 2.3):
        draft.box((x, 2.0), 1.8, 0.14, fixed=True)
    draft.box((0.7, 0.48), 1.2, 0.16, "blue", fixed=True)
    draft.box((3.6, 0.5), 0.3, 0.2, "red", fixed=True)
    return draft


def red_cellar() -> Draft:
    """1 pushes up and left, 2 up and right: climb between the red shelves to the blue hatch."""
    draft = Draft("thruster", "maze", "hazard", difficulty=4, steps=320)
    crate = draft.box((4.2, 0.57), 0.36, 0.34, "green")
    draft.thruster(crate, (4.2, 0.57), 120, 0.16, KEY_1)
    draft.thruster(crate, (4.2, 0.57), 60, 0.16, KEY_2)
    for x in (4.15, 2.65):
        draft.box((x, 1.8), 1.7 if x > 4 else 1.3, 0.14, "red", fixed=True)
    for x in (0.85, 2.35):
        draft.box((x, 3.3), 1.7 if x < 1 else 1.3, 0.14, "red", fixed=True)
    draft.box((0.7, 4.6), 0.8, 0.4, "blue", fixed=True)
    return draft


def asteroids() -> Draft:
    """No weight out here: 1 pushes up and 2 right; drift past the red rocks to the blue station."""
    draft = Draft("thruster", "flight", "space", "hazard", difficulty=2, gravity=0.0)
    ship = draft.shape(((0.4, 0.6), (0.9, 0.6), (0.65, 1.0)), "green")
    draft.thruster(ship, (0.65, 0.733), 90, 0.01, KEY_1)
    draft.thruster(ship, (0.65, 0.733), 0, 0.01, KEY_2)
    draft.ball((2.0, 1.3), 0.4, "red", fixed=True)
    draft.ball((1.2, 2.9), 0.35, "red", fixed=True)
    draft.shape(((2.6, 2.5), (3.3, 2.3), (3.2, 3.0)), "red", fixed=True)
    draft.shape(((3.4, 0.9), (4.2, 1.1), (3.6, 1.6)), "red", fixed=True)
    draft.ball((2.3, 4.1), 0.3, "red", fixed=True)
    draft.box((4.3, 4.2), 0.8, 0.5, "blue", fixed=True)
    return draft


def stepping_stones() -> Draft:
    """Thruster 1 jumps and 2 pushes right: hop from stone to stone between red lava and red roof
    to the blue ball.
    """
    draft = Draft("thruster", "platforms", "jump", "hazard", difficulty=3, floor="red")
    for x, top in ((0.6, 0.9), (1.9, 1.2), (3.1, 0.8)):
        draft.box((x, top / 2 + 0.2), 0.6, top - 0.4, fixed=True)
    # So low that one flight over everything does not do.
    for x in (1.4, 3.3):
        draft.box((x, 2.0), 1.9, 0.14, "red", fixed=True)
    hopper = draft.box((0.6, 1.06), 0.3, 0.32, "green")
    draft.thruster(hopper, (0.6, 0.92), 90, 0.16, KEY_1)
    draft.thruster(hopper, (0.47, 1.06), 0, 0.05, KEY_2)
    draft.ball((4.4, 1.3), 0.32, "blue", fixed=True)
    return draft


def leap_of_faith() -> Draft:
    """Thruster 1 lifts and 2 pushes left: drop off the ledge and glide past the red spikes to
    blue.
    """
    draft = Draft("thruster", "platforms", "hazard", difficulty=3, floor="red")
    draft.box((4.3, 3.2), 1.2, 0.16, fixed=True)
    glider = draft.box((4.3, 3.44), 0.4, 0.3, "green")
    draft.thruster(glider, (4.3, 3.31), 90, 0.15, KEY_1)
    draft.thruster(glider, (4.48, 3.44), 180, 0.06, KEY_2)
    draft.shape(((2.6, 5.0), (2.3, 3.2), (2.9, 5.0)), "red", fixed=True)
    draft.shape(((1.9, 0.42), (2.5, 0.42), (2.2, 1.9)), "red", fixed=True)
    draft.box((3.3, 1.9), 0.5, 0.14, fixed=True)
    draft.box((0.8, 0.9), 0.9, 0.2, "blue", fixed=True)
    return draft


def falling_star() -> Draft:
    """Thruster 1 lifts and 2 pushes right: catch the blue star with the green wing as it falls."""
    draft = Draft("thruster", "timing", "hazard", difficulty=2, floor="red")
    draft.box((0.7, 0.9), 1.0, 1.0, fixed=True)
    wing = draft.box((0.7, 1.5), 0.9, 0.18, "green")
    draft.thruster(wing, (0.7, 1.42), 90, 0.26, KEY_1)
    draft.thruster(wing, (0.3, 1.5), 0, 0.16, KEY_2)
    draft.box((4.3, 4.7), 0.34, 0.34, "blue", velocity=(-1.0, 2.5))
    draft.box((2.4, 2.9), 0.8, 0.16, "red", fixed=True)
    return draft


def eagle() -> Draft:
    """Engines 1 and 2 burn left and right: straddle the blue pad with the green lander, clear of
    the rocks.
    """
    draft = Draft(
        "thruster", "lander", "hazard", difficulty=3, floor="red", gravity=-4.0, steps=320
    )
    hull = draft.box((1.0, 4.2), 0.6, 0.3, "green")
    for side in (-1, 1):
        x = 1.0 + side * 0.3
        leg = draft.box((x, 3.97), 0.1, 0.34, turn=side * 20)
        draft.weld(hull, leg, (1.0 + side * 0.26, 4.07))
    draft.thruster(hull, (0.78, 4.08), 70, 0.08, KEY_1)
    draft.thruster(hull, (1.22, 4.08), 110, 0.08, KEY_2)
    draft.box((3.5, 0.6), 0.4, 0.4, "blue", fixed=True)
    draft.shape(((1.5, 0.42), (2.5, 0.42), (2.1, 1.7)), "red", fixed=True)
    draft.shape(((4.5, 0.42), (4.98, 0.42), (4.85, 1.3)), "red", fixed=True)
    return draft


def rope_dancer() -> Draft:
    """Thrusters 1 and 2 swing the rope right and left: kiss the blue bell with its green end, not
    the red.
    """
    draft = Draft("chain", "thruster", "swing-up", "hazard", difficulty=2)
    last, at = "ceiling", (2.5, 4.95)
    for index in range(5):
        link, end = draft.rod(at, -90, 0.5, "green" if index == 4 else "none", width=0.1)
        draft.hinge(last, link, at)
        last, at = link, end
    draft.thruster(last, (2.45, 2.6), 0, 0.06, KEY_1)
    draft.thruster(last, (2.55, 2.6), 180, 0.06, KEY_2)
    draft.ball((4.4, 3.6), 0.26, "blue", fixed=True)
    draft.ball((0.6, 3.6), 0.26, "red", fixed=True)
    return draft


def silver_service() -> Draft:
    """Engines 1 and 2 lift the tray left and right: raise the green ball to blue without spilling
    it.
    """
    draft = Draft("thruster", "balance", "hazard", difficulty=3, floor="red")
    draft.box((2.5, 0.7), 0.8, 0.6, fixed=True)
    tray = draft.box((2.5, 1.06), 1.3, 0.12, density=1.5)
    for side in (-1, 1):
        rim = draft.box((2.5 + side * 0.6, 1.23), 0.1, 0.22)
        draft.weld(tray, rim, (2.5 + side * 0.6, 1.12))
    draft.thruster(tray, (2.0, 1.0), 90, 0.22, KEY_1)
    draft.thruster(tray, (3.0, 1.0), 90, 0.22, KEY_2)
    draft.ball((2.45, 1.3), 0.18, "green", density=0.5)
    draft.ball((2.9, 3.4), 0.4, "blue", fixed=True)
    return draft


def plinko() -> Draft:
    """Nudge the falling green crate with 1 and 2 past the pegs into the blue bin, not a red one."""
    draft = Draft("thruster", "timing", "hazard", difficulty=2)
    crate = draft.box((2.6, 4.6), 0.28, 0.28, "green")
    draft.thruster(crate, (2.74, 4.6), 180, 0.05, KEY_1)
    draft.thruster(crate, (2.46, 4.6), 0, 0.05, KEY_2)
    for x, y in ((2.5, 3.6), (1.7, 2.6), (3.3, 2.6), (2.5, 1.7)):
        draft.ball((x, y), 0.16, fixed=True)
    for x, role in ((0.75, "blue"), (2.5, "red"), (4.25, "red")):
        draft.box((x, 0.5), 1.3, 0.2, role, fixed=True)
    for x in (1.62, 3.38):
        draft.box((x, 0.7), 0.1, 0.6, fixed=True)
    return draft


LEVELS = {
    each.__name__: each
    for each in (
        open_sky,
        letterbox,
        zigzag,
        red_cellar,
        asteroids,
        stepping_stones,
        leap_of_faith,
        falling_star,
        eagle,
        rope_dancer,
        silver_service,
        plinko,
    )
}
