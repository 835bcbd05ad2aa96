"""A level on its way: the dice, the colours, parts with random measures and surfaces."""

import math
import random
from typing import Any, Final

from kinetix.level.builder import LevelBuilder
from kinetix.level.geometry import FLOOR_TOP
from kinetix.level.model import ArenaName, Motor, Point, Role

FLOOR: Final = FLOOR_TOP
"""Height of the floor [m]."""


class Workshop:
    """A level on its way: a builder, the dice, and who plays which colour."""

    def __init__(self, dice: random.Random, builder: LevelBuilder) -> None:
        """Choose the colours.

        Args:
            dice: All that is random.
            builder: Empty.
        """
        self.dice, self.build = dice, builder
        self.tip: Role = dice.choice(("green", "blue"))
        """Colour of the part of the machine that has to touch."""
        self.goal: Role = "blue" if self.tip == "green" else "green"
        self.keys = dice.sample(range(4), 4)
        self.jets = dice.sample(range(2), 2)
        self.furniture = True
        """True if obstacles may stand on the floor; else they float in the air."""
        self.ledge = self.chance(0.25)
        """True if the machine begins on a ledge, where its family lets it."""
        self.ground = FLOOR + self.between(0.3, 1.6) if self.ledge else FLOOR
        """Height on which the machine stands [m]."""
        self.arena: dict[ArenaName, Role] = {}
        """Roles of floor, walls and ceiling, where they have one."""

    def between(self, low: float, high: float) -> float:
        """Draw a number between two."""
        return self.dice.uniform(low, high)

    def chance(self, share: float) -> bool:
        """True in this share of the cases."""
        return self.dice.random() < share

    def deadly(self, share: float, *names: ArenaName) -> None:
        """Let floor, walls or ceiling be red, in this share of the cases."""
        for name in names:
            if name not in self.arena and self.chance(share):
                self.arena[name] = "red"

    def motor(self, key: int, *, speed: tuple[float, float], power: tuple[float, float]) -> Motor:
        """Return a motor for the key of this number; one of five turns the other way round."""
        sign = -1 if self.chance(0.2) else 1
        return Motor(
            speed=sign * self.between(*speed),
            power=self.between(*power),
            binding=self.keys[key % 4],
        )

    def box(self, x: float, y: float, width: float, height: float, **more: Any) -> int:
        """Return a rectangle with a random surface."""
        return self.build.rectangle(x, y, width, height, **(self._surface() | more))

    def ball(self, x: float, y: float, radius: float, **more: Any) -> int:
        """Return a disc with a random surface."""
        return self.build.circle(x, y, radius, **(self._surface() | more))

    def lump(self, x: float, y: float, size: float, **more: Any) -> int:
        """Return a disc or a box of about this size."""
        if self.chance(0.5):
            return self.ball(x, y, size / 2, **more)
        return self.box(x, y, size * self.between(0.7, 1.3), size * self.between(0.7, 1.3), **more)

    def rod(self, at: Point, direction: float, length: float, **more: Any) -> tuple[int, Point]:
        """Return a bar that begins at a point, and where it ends.

        Args:
            at: Its beginning.
            direction: [rad]
            length: [m]
            more: See `BodyFields`.
        """
        x, y = at[0] + length * math.cos(direction), at[1] + length * math.sin(direction)
        width = self.between(0.08, 0.2)
        middle = ((at[0] + x) / 2, (at[1] + y) / 2)
        return self.box(*middle, length, width, angle=direction, **more), (x, y)

    def jet(self, body: int, at: Point, direction: float, mass: float, index: int) -> None:
        """A thruster that can lift about this mass [kg], somewhat more or less."""
        power = mass * self.between(0.9, 2.6)
        tilt = self.between(-0.15, 0.15) if self.chance(0.3) else 0.0
        self.build.thruster(
            body, at, angle=direction + tilt, power=max(power, 0.02), binding=self.jets[index]
        )

    def _surface(self) -> dict[str, Any]:
        return {
            "friction": self.dice.choice((1.0, 1.0, 0.5, self.between(0.0, 1.0))),
            "restitution": self.dice.choice((0.0, 0.0, 0.2, self.between(0.0, 0.8))),
            "density": self.dice.choice((1.0, 1.0, self.between(0.3, 3.0))),
        }
