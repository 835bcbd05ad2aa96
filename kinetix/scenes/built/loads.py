"""Loads through several bodies, and machines: plates, chains, arms, rows of balls, rocking."""

import math

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes.everyday.chains import draped
from kinetix.scenes.model import SuiteScene, Trial


def _plate() -> tuple[Trial, ...]:
    def trial(ratio: float) -> Trial:
        b = LevelBuilder("Plate under a load", arena=False)
        b.rectangle(0, -0.5, 10, 1, fixed=True)
        b.rectangle(0, 0.1, 0.2, 0.2)
        plate = b.rectangle(0, 0.225, 0.6, 0.05)
        # The load has `ratio` times the mass of the light box.
        load = b.rectangle(0, 0.4, 0.3, 0.3, density=ratio * 0.04 / 0.09)
        b.weld(plate, load, (0, 0.25))
        return Trial(level=b.build(), duration=10.0, name=f"{ratio:g}:1")

    return tuple(trial(ratio) for ratio in (20.0, 150.0, 500.0))


def _chain() -> tuple[Trial, ...]:
    def trial(load: float, other: float, name: str) -> Trial:
        b = LevelBuilder("Chain round a post", arena=False)
        draped(b, 10, 0.2, 0.2, (load, other))
        return Trial(level=b.build(), duration=3.0, name=name)

    return tuple(
        trial(load, load * share, f"{load:g}:1{name}")
        for load in (20.0, 50.0, 100.0, 200.0)
        for share, name in ((1.0, ""), (0.5, ", uneven"))
    )


def _held_ball() -> tuple[Trial, ...]:
    b = LevelBuilder("Held ball", arena=False)
    for side in (-1, 1):
        foot = (side * 0.25, 0.0)
        post = b.rectangle(*foot, 0.1, 0.1, fixed=True, collision="ghost")
        arm = b.rectangle(side * 0.25, 0.4, 0.1, 0.8)
        b.hinge(post, arm, foot, motor=Motor(speed=side * 1.0, power=5.0))
    b.circle(0.0, 0.6, 0.2)
    return (Trial(level=b.build(), duration=5.0, motor=1.0),)


def _pinned_row() -> tuple[Trial, ...]:
    b = LevelBuilder("Row of pinned balls", arena=False)
    for k in range(5):
        x = 0.401 * k
        angle = -math.pi / 4 if k == 0 else 0.0
        at = (x + math.sin(angle), -math.cos(angle))
        post = b.rectangle(x, 0.0, 0.1, 0.1, fixed=True, collision="ghost")
        b.hinge(post, b.circle(*at, 0.2, friction=0.0, restitution=1.0), (x, 0.0))
    return (Trial(level=b.build(), duration=5.0),)


def _rocking() -> tuple[Trial, ...]:
    def trial(width: float, height: float) -> Trial:
        alpha = math.atan(width / height)
        theta = 0.5 * alpha
        # It stands on its lower left corner at the origin, leaning to the left.
        reach = math.hypot(width, height) / 2
        centre = (reach * math.sin(alpha - theta), reach * math.cos(alpha - theta))
        b = LevelBuilder("Rocking block", arena=False)
        b.rectangle(0, -0.5, 10, 1, fixed=True, friction=2.0)
        b.rectangle(*centre, width, height, angle=theta, friction=2.0)
        values = {"width": width, "height": height}
        return Trial(level=b.build(), duration=3.0, name=f"{width:g}×{height:g} m", values=values)

    return trial(0.4, 1.2), trial(0.4, 1.6)


def _spun_joint() -> tuple[Trial, ...]:
    """A rotor with a bob pinned to its end, both at 25 rad/s from the start: nothing whips."""
    b = LevelBuilder("Fast rotor", gravity=(0.0, 0.0), arena=False)
    post = b.rectangle(0, 0, 0.1, 0.1, fixed=True, collision="ghost")
    spin = 25.0
    arm = b.rectangle(0.4, 0, 0.8, 0.1, angular_velocity=spin, velocity=(0, 0.4 * spin))
    bob = b.rectangle(1.0, 0, 0.4, 0.1, angular_velocity=spin, velocity=(0, 1.0 * spin))
    b.hinge(post, arm, (0, 0), motor=Motor(speed=spin / 6, power=3.0))
    b.hinge(arm, bob, (0.8, 0))
    return (Trial(level=b.build(), duration=5.0, motor=1.0),)


def _dominoes() -> tuple[Trial, ...]:
    height, thickness, pitch = 0.4, 0.05, 0.2
    b = LevelBuilder("Dominoes", arena=False)
    b.rectangle(4.0, -0.5, 14.0, 1, fixed=True, friction=5.0)
    for k in range(40):
        spin = -3.0 if k == 0 else 0.0
        velocity = (-spin * height / 2, -spin * thickness / 2)
        b.rectangle(
            k * pitch,
            height / 2,
            thickness,
            height,
            friction=0.0,
            angular_velocity=spin,
            velocity=velocity,
        )
    return (Trial(level=b.build(), duration=4.0, values={"pitch": pitch}),)


def _bucket() -> tuple[Trial, ...]:
    b = LevelBuilder("Bucket")
    b.rectangle(2.5, 0.45, 1.0, 0.1, fixed=True)
    for x in (1.95, 3.05):
        b.rectangle(x, 1.0, 0.1, 1.2, fixed=True)
    for k in range(12):
        b.circle(2.2 + 0.2 * (k % 4) + 0.03 * (k // 4), 0.7 + 0.25 * (k // 4), 0.09)
    for k in range(4):
        b.rectangle(2.2 + 0.2 * k, 1.5, 0.16, 0.1)
    return (Trial(level=b.build(), duration=5.0),)


LOADS = (
    SuiteScene(
        id="U21",
        name="plate under a load",
        group="built",
        core=False,
        make_trials=_plate,
        note="A light box carries a plate with up to 500 times its mass welded on.",
    ),
    SuiteScene(
        id="U22",
        name="chain round a post",
        group="built",
        core=False,
        make_trials=_chain,
        note="Ten links over a disc, loads of up to 200 links at the ends.",
    ),
    SuiteScene(
        id="U23",
        name="held ball",
        group="built",
        core=False,
        make_trials=_held_ball,
        note="Two strong arms hold a ball by friction.",
    ),
    SuiteScene(
        id="U24",
        name="pinned row",
        group="built",
        core=False,
        make_trials=_pinned_row,
        note="Five balls on rods pass blows on and keep their energy.",
    ),
    SuiteScene(
        id="U25",
        name="rocking block",
        group="built",
        core=False,
        make_trials=_rocking,
        note="Each impact of a slender block takes the share that Housner gives.",
    ),
    SuiteScene(
        id="U26",
        name="fast rotor",
        group="built",
        core=False,
        make_trials=_spun_joint,
        note="Joints stay closed at 25 rad/s.",
    ),
    SuiteScene(
        id="U27",
        name="dominoes",
        group="built",
        core=False,
        make_trials=_dominoes,
        note="The wave in a row of dominoes runs as van Leeuwen's formula says.",
    ),
    SuiteScene(
        id="U28",
        name="bucket",
        group="built",
        core=False,
        sized=True,
        make_trials=_bucket,
        note="Sixteen things that are poured into a bucket come to rest in it.",
    ),
)
