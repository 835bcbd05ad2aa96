"""Seams must not be felt: floors of tiles, steps, valleys and hills of segments."""

import itertools
import math

from kinetix.level.builder import LevelBuilder
from kinetix.level.model import Motor
from kinetix.scenes.model import GRAVITY, SuiteScene, Trial

TILES = 16
"""Tiles of a floor."""
SPEEDS = (1.0, 5.0, 20.0, 60.0)
"""Speeds of the body at the start [m/s]."""
SEGMENTS = 14
"""Segments of a valley or hill."""


def _slider(b: LevelBuilder, kind: str, x: float, y: float, speed: float, friction: float) -> int:
    """Return a body that slides or rolls: its lowest point at (x, y); .3 m wide."""
    velocity = (speed, 0.0)
    if kind == "disc":
        spin = -speed / 0.15 if friction else 0.0
        return b.circle(
            x, y + 0.15, 0.15, velocity=velocity, angular_velocity=spin, friction=friction
        )
    if kind == "box":
        return b.rectangle(x, y + 0.15, 0.3, 0.3, velocity=velocity, friction=friction)
    corners = ((x - 0.15, y), (x + 0.15, y), (x, y + 0.26))
    return b.polygon(corners, velocity=velocity, friction=friction)


def over_tiles(
    kind: str,
    speed: float,
    name: str,
    *,
    friction: float = 0.0,
    free: bool = False,
) -> Trial:
    """Something that moves over sixteen tiles.

    Args:
        kind: box, disc or triangle.
        speed: Of it [m/s].
        name: Of the trial.
        friction: Of everything; a disc then rolls.
        free: The tiles are boxes that lie on a floor.
    """
    tile = max(0.25, speed / 20)
    b = LevelBuilder("Floor of tiles", arena=False)
    if free:
        b.rectangle(tile * TILES / 2, -0.7, tile * TILES + 2, 1, fixed=True, friction=friction)
    for k in range(TILES):
        b.rectangle((k + 0.5) * tile, -0.1, tile, 0.2, fixed=not free, friction=friction)
    start = min(tile, 0.4) / 2 + 0.15
    _slider(b, kind, start, 0.0, speed, friction)
    seconds = (tile * (TILES - 1) - start) / speed
    return Trial(level=b.build(), duration=min(seconds, 4.0), name=name, values={"speed": speed})


def _flush() -> tuple[Trial, ...]:
    return tuple(
        over_tiles(kind, speed, f"{kind}, {speed:g} m/s")
        for kind in ("box", "disc", "triangle")
        for speed in SPEEDS
    )


def _rolling() -> tuple[Trial, ...]:
    return tuple(
        over_tiles("disc", speed, f"{speed:g} m/s", friction=1.0) for speed in (1.0, 5.0, 20.0)
    )


def _free_tiles() -> tuple[Trial, ...]:
    return tuple(
        over_tiles(kind, speed, f"{kind}, {speed:g} m/s", free=True)
        for kind in ("box", "disc")
        for speed in (1.0, 5.0, 20.0)
    )


def _lower() -> tuple[Trial, ...]:
    """Place a tile, then a lower one."""

    def trial(kind: str, drop: float, speed: float) -> Trial:
        b = LevelBuilder("Lower neighbour", arena=False)
        for x, top in ((0.0, 0.0), (4.0, -drop)):
            b.rectangle(x, top - 0.1, 4.0, 0.2, fixed=True, friction=0.0)
        _slider(b, kind, 1.0, 0.0, speed, 0.0)
        return Trial(
            level=b.build(),
            duration=3.0 / speed,
            name=f"{kind}, {1000 * drop:g} mm lower, {speed:g} m/s",
            values={"speed": speed},
        )

    return tuple(
        trial(kind, drop, speed)
        for kind in ("box", "disc")
        for drop in (0.001, 0.003)
        for speed in (2.0, 20.0)
    )


def _step_up() -> tuple[Trial, ...]:
    """Too slow to tumble over: that takes 2.7 m/s with a blow that sticks."""

    def trial(speed: float) -> Trial:
        b = LevelBuilder("Step", arena=False)
        b.rectangle(0.0, -0.5, 4.0, 1.0, fixed=True, friction=0.0)
        b.rectangle(4.0, -0.45, 4.0, 1.0, fixed=True, friction=0.0)
        _slider(b, "box", 1.0, 0.0, speed, 0.0)
        return Trial(level=b.build(), duration=3.0 / speed, name=f"{speed:g} m/s")

    return tuple(trial(speed) for speed in (0.5, 1.0, 2.0))


def _sticking() -> tuple[Trial, ...]:
    """Boxes on a ramp of tiles, each over a seam: tan .4 is three quarters of the coefficient."""
    slope = 0.4
    c, s = math.cos(slope), math.sin(slope)
    b = LevelBuilder("Ramp of tiles", arena=False)
    for k in range(8):
        along, above = 0.4 * k, -0.1
        b.rectangle(
            along * c + above * s, -along * s + above * c, 0.4, 0.2, angle=-slope, fixed=True
        )
    for k in (1, 3, 5):
        along, above = 0.4 * k + 0.2, 0.1
        b.rectangle(along * c + above * s, -along * s + above * c, 0.3, 0.2, angle=-slope)
    return (Trial(level=b.build(), duration=10.0),)


def _arc(b: LevelBuilder, radius: float, half: float, sign: int) -> float:
    """Segments on a circle around the origin, below it (−1) or above (1); returns their apothem."""
    angles = [half * (2 * k / SEGMENTS - 1) for k in range(SEGMENTS + 1)]

    def at(angle: float, distance: float) -> tuple[float, float]:
        return distance * math.sin(angle), sign * distance * math.cos(angle)

    for start, end in itertools.pairwise(angles):
        inner = radius - sign * 0.2
        corners = (at(start, inner), at(end, inner), at(end, radius), at(start, radius))
        b.polygon(corners, fixed=True, friction=0.0)
    return radius * math.cos(half / SEGMENTS)


def _valley() -> tuple[Trial, ...]:
    def trial(radius: float, half: float, name: str) -> Trial:
        b = LevelBuilder("Valley", arena=False)
        path = _arc(b, radius, half, -1) - 0.1
        first = -half * (1 - 1 / SEGMENTS)
        b.circle(path * math.sin(first), -path * math.cos(first), 0.1, friction=0.0)
        # A pendulum of that length turns after half a period.
        seconds = 1.3 * math.pi * math.sqrt(path / GRAVITY)
        values = {"path": path, "turned": _turning_height(path, half)}
        return Trial(level=b.build(), duration=seconds, name=name, values=values)

    return trial(3.0, 0.25, "shallow"), trial(2.0, 0.6, "steep")


def _turning_height(path: float, half: float) -> float:
    """Return the height that a disc without bounce reaches on the far side of a valley [m].

    At each corner it loses the part of its velocity that points into the next segment.
    """
    bend = 2 * half / SEGMENTS
    corners = [half * (2 * k / SEGMENTS - 1) for k in range(1, SEGMENTS)]
    corner_radius = path / math.cos(bend / 2)
    height = path * (1 - math.cos(half - bend / 2))
    energy = 0.0
    for angle in corners:
        next_height = path - corner_radius * math.cos(angle)
        if energy + height - next_height <= 0:
            break
        energy = (energy + height - next_height) * math.cos(bend) ** 2
        height = next_height
    return height + energy


def _hill() -> tuple[Trial, ...]:
    def trial(size: float, name: str) -> Trial:
        b = LevelBuilder("Hill", arena=False)
        radius, half = 4.0, 0.3
        path = _arc(b, radius, half, 1) + size
        first = -half * (1 - 1 / SEGMENTS)
        speed = 2.5
        velocity = (speed * math.cos(first), -speed * math.sin(first))
        x, y = path * math.sin(first), path * math.cos(first)
        b.circle(x, y, size, velocity=velocity, friction=0.0)
        values = {"speed": speed, "follows": float(speed**2 / size < GRAVITY * math.cos(half))}
        return Trial(level=b.build(), duration=0.8, name=name, values=values)

    return trial(0.8, "wide disc"), trial(0.1, "narrow disc")


def _car_over_tiles() -> tuple[Trial, ...]:
    def trial(pieces: int, name: str) -> Trial:
        b = LevelBuilder("Car over tiles", arena=False)
        for k in range(pieces):
            b.rectangle(-1 + (k + 0.5) * 8 / pieces, -0.1, 8 / pieces, 0.2, fixed=True)
        chassis = b.rectangle(0.0, 0.342, 1.24, 0.284)
        for x in (-0.37, 0.37):
            b.hinge(chassis, b.circle(x, 0.2, 0.2), (x, 0.2), motor=Motor(speed=3.0))
        return Trial(level=b.build(), duration=1.6, name=name, motor=-1.0)

    return trial(16, "tiles"), trial(1, "slab")


def _scene(number: int, name: str, make: object, note: str) -> SuiteScene:
    return SuiteScene(
        id=f"U{number}",
        name=name,
        group="built",
        core=False,
        make_trials=make,  # pyright: ignore[reportArgumentType]
        note=note,
    )


SURFACES = (
    _scene(7, "flush tiles", _flush, "Box, disc and triangle slide over tiles at 1 to 60 m/s."),
    _scene(8, "rolling over tiles", _rolling, "A rolling disc does not feel seams."),
    _scene(9, "tiles that lie", _free_tiles, "The same over boxes that lie beside each other."),
    _scene(10, "lower neighbour", _lower, "A tile that is 1 or 3 mm lower does not trip."),
    _scene(11, "step up", _step_up, "A tile that is 5 cm higher stops."),
    _scene(12, "ramp of tiles", _sticking, "Boxes over the seams of a ramp stay where they are."),
    _scene(13, "valley", _valley, "Fourteen segments carry a disc as high as it came from."),
    _scene(14, "hill", _hill, "Over a hill of segments a disc keeps its energy."),
    _scene(15, "car over tiles", _car_over_tiles, "A car on tiles drives as on one slab."),
)
