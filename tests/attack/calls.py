"""Calls from Python with nasty values: refused by a sentence, or the level is sound."""

import contextlib
import math
import random
from typing import Any

from kinetix.errors import LevelError
from kinetix.level.builder import LevelBuilder
from kinetix.level.codec import dumps, loads
from kinetix.level.model import Limits, Motor
from kinetix.level.validate import validate
from tests.attack.mutate import NASTY

_USUAL = (0, 0.5, 1.0, -0.3, 2.5, math.pi, 3)
_FIELDS = (
    "angle",
    "velocity",
    "angular_velocity",
    "density",
    "friction",
    "restitution",
    "fixed",
    "role",
    "collision",
)


def _value(random_: random.Random) -> Any:
    return random_.choice(NASTY if random_.random() < 0.15 else _USUAL)


def _point(random_: random.Random) -> Any:
    if random_.random() < 0.1:
        return _value(random_)
    return tuple(_value(random_) for _ in range(random_.choice((2, 2, 2, 2, 3, 1))))


def _fields(random_: random.Random) -> dict[str, Any]:
    names = random_.sample(_FIELDS, random_.choice((0, 0, 1, 2)))
    roles = {"role": ("green", "blue", "red", "none", 3), "velocity": (_point(random_),)}
    return {name: random_.choice((_value(random_), *roles.get(name, ()))) for name in names}


def _call(builder: LevelBuilder, random_: random.Random, ids: list[Any]) -> Any:
    value, point = lambda: _value(random_), lambda: _point(random_)
    body = lambda: random_.choice((*ids, "floor", "left_wall", _value(random_)))  # noqa: E731
    match random_.randrange(7):
        case 0:
            return builder.rectangle(value(), value(), value(), value(), **_fields(random_))
        case 1:
            return builder.circle(value(), value(), value(), **_fields(random_))
        case 2:
            return builder.polygon(
                [point() for _ in range(random_.randrange(6))], **_fields(random_)
            )
        case 3:
            limits = random_.choice((None, (-1, 1), point(), Limits(min=-1.0, max=1.0)))
            motor = random_.choice((None, Motor(), value()))
            return builder.hinge(body(), body(), point(), motor=motor, limits=limits)
        case 4:
            return builder.weld(body(), body(), point())
        case 5:
            return builder.thruster(
                body(), point(), angle=value(), power=value(), binding=random_.choice((0, value()))
            )
    return builder.rectangle(2.0 + len(ids), 2.0, 0.5, 0.5)


def build(random_: random.Random) -> None:
    """Build a level by calls drawn at random; what is refused is left out."""
    builder, ids = LevelBuilder(), []
    for _ in range(random_.choice((2, 5, 20))):
        with contextlib.suppress(LevelError):
            ids.append(_call(builder, random_, ids))
    level = builder.build()
    repr(builder)
    validate(level)
    # Files have narrower bounds than the builder; the reader says so, in a sentence.
    assert loads(dumps(level)) == loads(dumps(loads(dumps(level))))
