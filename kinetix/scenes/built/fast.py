"""Nothing goes through a wall of 5 cm: one body, many, off corners, after bounces."""

import math
import random

from kinetix.level.builder import LevelBuilder
from kinetix.scenes.model import STEP, SuiteScene, Trial

WALL = 0.05
"""Thickness of what encloses [m]."""


def ring(b: LevelBuilder, radius: float, sides: int, restitution: float) -> None:
    """Add a closed ring of fixed boxes around the origin."""
    for k in range(sides):
        angle = 2 * math.pi * k / sides
        length = 2 * (radius + WALL) * math.tan(math.pi / sides)
        centre = radius + WALL / 2
        place = (centre * math.cos(angle), centre * math.sin(angle))
        b.rectangle(
            *place, WALL, length, angle=angle, fixed=True, restitution=restitution, friction=0.5
        )


def _one_disc() -> tuple[Trial, ...]:
    def trial(speed: float, restitution: float, phase: int) -> Trial:
        b = LevelBuilder("Disc in a ring", gravity=(0.0, 0.0), arena=False)
        ring(b, 1.0, 12, restitution)
        heading = 0.1 + 0.7 * phase
        velocity = (speed * math.cos(heading), speed * math.sin(heading))
        b.circle(0.1, 0.05, 0.02, velocity=velocity, restitution=restitution)
        return Trial(
            level=b.build(),
            duration=2.0,
            name=f"{speed:g} m/s, e {restitution:g}",
            phase=phase,
            values={"reach": 1.05},
        )

    return tuple(
        trial(speed, restitution, phase)
        for speed in (30.0, 60.0, 90.0)
        for restitution in (0.0, 1.0)
        for phase in range(8)
    )


def _small_boxes() -> tuple[Trial, ...]:
    def trial(phase: int) -> Trial:
        b = LevelBuilder("Boxes in a ring", gravity=(0.0, 0.0), arena=False)
        ring(b, 1.0, 12, 0.5)
        for k in range(4):
            heading = 0.2 + 0.7 * phase + k * math.pi / 2
            x, y = 0.3 * math.cos(heading), 0.3 * math.sin(heading)
            velocity = (30 * math.cos(heading + 0.5), 30 * math.sin(heading + 0.5))
            b.rectangle(x, y, 0.04, 0.04, angle=phase, velocity=velocity, restitution=0.5)
        return Trial(level=b.build(), duration=2.0, phase=phase, values={"reach": 1.05})

    return tuple(trial(phase) for phase in range(16))


def _many() -> tuple[Trial, ...]:
    """A thousand bodies in all, 25 in each ring or box."""

    def trial(number: int) -> Trial:
        rng = random.Random(number)
        sides = 4 if number % 2 else 12
        b = LevelBuilder("Many in a ring", gravity=(0.0, -9.81), arena=False)
        ring(b, 1.0, sides, 0.8)
        for k in range(25):
            x, y = 0.24 * (k % 5 - 2), 0.24 * (k // 5 - 2)
            speed, heading = rng.uniform(20, 100), rng.uniform(0, 2 * math.pi)
            velocity = (speed * math.cos(heading), speed * math.sin(heading))
            size = rng.uniform(0.02, 0.08)
            if k % 2:
                b.circle(x, y, size, velocity=velocity, restitution=0.8)
            else:
                b.rectangle(x, y, size, size, velocity=velocity, restitution=0.8)
        reach = 1.05 * (math.sqrt(2) if sides == 4 else 1.04)
        return Trial(level=b.build(), duration=1.0, phase=number, values={"reach": reach})

    return tuple(trial(number) for number in range(40))


def _off_a_corner() -> tuple[Trial, ...]:
    """A bullet grazes the corner of a block that stands before a thin wall."""

    def trial(kind: str, speed: float, phase: int) -> Trial:
        b = LevelBuilder("Off a corner", gravity=(0.0, 0.0), arena=False)
        b.rectangle(WALL / 2, 0.0, WALL, 60.0, fixed=True)
        b.rectangle(-0.5, -0.3, 0.3, 0.6, fixed=True)
        # Its middle passes from below to above the block's upper edge, by phases.
        x, y = -2.0 - phase * speed * STEP / 16, -0.04 + 0.005 * phase
        if kind == "disc":
            b.circle(x, y, 0.05, velocity=(speed, 0.0))
        else:
            b.rectangle(x, y, 0.1, 0.1, angle=0.4, velocity=(speed, 0.0))
        return Trial(
            level=b.build(),
            duration=-x / speed + 0.3,
            name=f"{kind}, {speed:g} m/s",
            phase=phase,
            values={"wall": WALL},
        )

    return tuple(
        trial(kind, speed, phase)
        for kind in ("disc", "box")
        for speed in (50.0, 100.0)
        for phase in range(16)
    )


def _between_walls() -> tuple[Trial, ...]:
    """A bouncing bullet meets several walls in one step."""

    def trial(kind: str, gap: float, phase: int) -> Trial:
        b = LevelBuilder("Between two walls", gravity=(0.0, 0.0), arena=False)
        for side in (-1, 1):
            b.rectangle(side * (gap + WALL) / 2, 0, WALL, 60.0, fixed=True, restitution=1)
        x = gap * 0.02 * (phase - 8)
        velocity = (100.0, 3.0)
        if kind == "disc":
            b.circle(x, 0, 0.05, velocity=velocity, restitution=1)
        else:
            b.rectangle(x, 0, 0.1, 0.1, velocity=velocity, restitution=1)
        return Trial(
            level=b.build(),
            duration=1.0,
            name=f"{kind}, {gap:g} m apart",
            phase=phase,
            values={"half": gap / 2 + WALL / 2},
        )

    return tuple(
        trial(kind, gap, phase)
        for kind in ("disc", "box")
        for gap in (0.3, 1.0)
        for phase in range(16)
    )


FAST = (
    SuiteScene(
        id="U16",
        name="disc in a ring",
        group="built",
        core=False,
        make_trials=_one_disc,
        note="A disc of 2 cm at up to 90 m/s stays in a ring of boxes.",
    ),
    SuiteScene(
        id="U17",
        name="boxes in a ring",
        group="built",
        core=False,
        make_trials=_small_boxes,
        note="Boxes of 4 cm at 30 m/s stay in a ring of boxes.",
    ),
    SuiteScene(
        id="U18",
        name="a thousand in rings",
        group="built",
        core=False,
        make_trials=_many,
        note="Twenty-five fast bodies at once, forty times.",
    ),
    SuiteScene(
        id="U19",
        name="off a corner",
        group="built",
        core=False,
        make_trials=_off_a_corner,
        note="What grazes a corner on its way is stopped by the wall behind all the same.",
    ),
    SuiteScene(
        id="U20",
        name="between two walls",
        group="built",
        core=False,
        make_trials=_between_walls,
        note="A bullet that bounces several times within a step stays between its walls.",
    ),
)
