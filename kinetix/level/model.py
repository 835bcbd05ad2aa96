"""The level document: plain frozen values, named as in the file format (see README.md).

Every real number is an IEEE-754 binary32 value. The one place that rounds is
`Record.__post_init__`, which runs on construction, on decoding and on `replace`; it also turns
lists into tuples and minus zero into zero, so that equal documents are equal byte for byte.

Limits stand in the annotations (`msgspec.Meta`) and hold when a file is *read*; code may build a
level that breaks them (`kinetix.level.validate` then reports it), because an edit must never crash.
The same annotations carry what an inspector needs: unit, usual range (`slider`) and `step`.
"""

import functools
import math
import struct
import types
import typing
from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any, ClassVar, Final, Literal, Self

import msgspec
from msgspec import Meta

from kinetix.errors import LevelError
from kinetix.level.limits import (
    FARTHEST,
    FARTHEST_PART,
    FASTEST,
    FASTEST_MOTOR,
    FASTEST_SPIN,
    STRONGEST_GRAVITY,
    STRONGEST_MOTOR,
    STRONGEST_THRUSTER,
    WIDEST_ANGLE,
    WIDEST_LIMIT,
)
from kinetix.wording import plural

Role = Literal["none", "green", "blue", "red"]
Collision = Literal["normal", "always", "ghost"]
JointKind = Literal["revolute", "fixed"]
InertiaModel = Literal["exact", "kinetix"]
SizeName = Literal["s", "m", "l", "locomotion"]
ArenaName = Literal["floor", "left_wall", "right_wall", "ceiling"]

ROLES: Final[tuple[Role, ...]] = ("none", "green", "blue", "red")
"""In the order of the numbers 0, 1, 2, 3 that engine and observations use."""
COLLISIONS: Final[tuple[Collision, ...]] = ("ghost", "normal", "always")
"""In the order of the numbers 0, 1, 2 that the engine uses."""
ARENA_NAMES: Final[tuple[ArenaName, ...]] = ("floor", "left_wall", "right_wall", "ceiling")
"""In the order of polygon slots 0–3."""

MOTOR_BINDINGS: Final = 4
"""Number of action channels for motors."""
THRUSTER_BINDINGS: Final = 2
"""Number of action channels for thrusters."""
UNSOLVED: Final = "unsolved"
"""Tag of a level for which no solution is known."""
MAX_TAGS: Final = 100
"""Most tags of a level."""
MAX_TAG: Final = 40
"""Most characters of a tag."""
MAX_TITLE: Final = 120
"""Most characters of the name of a level."""
MAX_DESCRIPTION: Final = 4000
"""Most characters of the description of a level."""
MAX_NAME: Final = 60
"""Most characters of the name of a body, joint or thruster."""
MAX_STEPS: Final = 100_000
"""Environment steps of an episode, and so of a recorded solution."""
MAX_ENTITIES: Final = 1024
"""Most bodies, joints or thrusters in one level: a bound against hostile files, far above use."""

_BINARY32 = struct.Struct("<f")


def round_real(value: float) -> float:
    """The nearest binary32 value; minus zero becomes zero, what is too large becomes infinite."""
    try:
        return _BINARY32.unpack(_BINARY32.pack(value))[0] + 0.0
    except OverflowError:
        return math.copysign(math.inf, value)
    except struct.error:
        raise LevelError(f"{value!r:.60}: expected a number") from None


def _round_reals(values: Iterable[float]) -> tuple[float, ...]:
    return tuple(round_real(value) for value in values)


def _round_points(points: Iterable[Iterable[float]]) -> tuple[tuple[float, ...], ...]:
    return tuple(_round_reals(point) for point in points)


def _real(
    description: str,
    unit: str = "",
    limits: tuple[float, float] | None = None,
    *,
    slider: tuple[float, float] | None = None,
    step: float = 0.01,
) -> Meta:
    """Metadata of a real: meaning, unit, range in a file, usual range and step."""
    low, high = limits or (None, None)
    if low is not None and high is not None:
        # A bound such as 0.02 has no binary32 value; the nearest one must count as inside.
        low, high = min(low, round_real(low)), max(high, round_real(high))
    extra = {"unit": unit, "slider": slider or limits, "step": step}
    schema = {"x-unit": unit} if unit else {}
    return Meta(ge=low, le=high, description=description, extra=extra, extra_json_schema=schema)


def _note(description: str, *, optional: bool = False) -> Meta:
    """Metadata of anything else; `optional`: None is written by leaving the key out."""
    return Meta(description=description, extra={"optional": optional})


Point = tuple[float, float]
"""Two reals, x and y [m]."""
_Coordinate = Annotated[
    float,
    _real(
        "Place of the frame's origin; of a free body its centre of mass",
        "m",
        (-FARTHEST, FARTHEST),
        slider=(0.0, 5.0),
    ),
]
_WITHIN_BODY: Final = (-FARTHEST_PART, FARTHEST_PART)
_ANGLES: Final = (-WIDEST_ANGLE, WIDEST_ANGLE)
_Anchor = Annotated[
    float, _real("Attachment in the body's own frame", "m", _WITHIN_BODY, slider=(-2.0, 2.0))
]
_Speed = Annotated[
    float,
    _real("Velocity at the start", "m/s", (-FASTEST, FASTEST), slider=(-20.0, 20.0), step=0.1),
]
_AngularVelocity = Annotated[
    float,
    _real(
        "Angular velocity at the start",
        "rad/s",
        (-FASTEST_SPIN, FASTEST_SPIN),
        slider=(-20.0, 20.0),
        step=0.1,
    ),
]
_Gravity = Annotated[
    float,
    _real(
        "Acceleration of gravity",
        "m/s²",
        (-STRONGEST_GRAVITY, STRONGEST_GRAVITY),
        slider=(-20.0, 20.0),
        step=0.1,
    ),
]
_Angle = Annotated[
    float, _real("Angle, counter-clockwise", "rad", _ANGLES, slider=(-math.pi, math.pi))
]
_Density = Annotated[
    float, _real("Mass per area", "kg/m²", (1e-3, 1000.0), slider=(0.05, 10.0), step=0.05)
]
_Friction = Annotated[
    float,
    _real(
        "Friction value of the surface; a pair has the coefficient 0.4·√(f₁² + f₂²)",
        "",
        (0.0, 10.0),
        slider=(0.0, 1.0),
    ),
]
_Restitution = Annotated[
    float, _real("Bounciness of the surface; of two the smaller counts", "", (0.0, 1.0))
]
_Corner = Annotated[
    float, _real("Corner in the body's own frame", "m", _WITHIN_BODY, slider=(-2.0, 2.0))
]
_Vertices = Annotated[tuple[tuple[_Corner, _Corner], ...], Meta(min_length=3, max_length=4)]
_ArenaCoordinate = Annotated[
    float, _real("Place of an arena body's frame", "m", _WITHIN_BODY, slider=(-10.0, 10.0))
]
_Id = Annotated[int, Meta(ge=1, le=2**53)]
_Role = Annotated[Role, _note("Part in the game: green must reach blue and shun red")]
_Collision = Annotated[
    Collision, _note("What it touches: two bodies collide when one is always or both are normal")
]
_Name = Annotated[
    Annotated[str, Meta(min_length=1, max_length=MAX_NAME)] | None,
    _note("What people call it", optional=True),
]
Tag = Annotated[str, Meta(min_length=1, max_length=MAX_TAG, pattern="^[a-z0-9_-]*$")]
BodyReference = int | ArenaName
"""A body's id, or the name of an arena body."""


class Record(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of all parts of a level: frozen, keyword-only, binary32 reals, tuples."""

    def __post_init__(self) -> None:
        """Round reals and make sequences tuples."""
        for name, normalise in _normalisers(type(self)):
            value = getattr(self, name)
            if value is None:
                continue
            try:
                normal = normalise(value)
            except TypeError:
                owner = type(self).__name__
                raise LevelError(f"{owner}.{name}: expected a sequence, got {value!r}") from None
            msgspec.structs.force_setattr(self, name, normal)

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some fields changed."""
        return msgspec.structs.replace(self, **changes)


def _normaliser(hint: Any) -> Callable[[Any], Any] | None:
    if typing.get_origin(hint) is Annotated:
        return _normaliser(typing.get_args(hint)[0])
    if typing.get_origin(hint) in (types.UnionType, typing.Union):
        found = [_normaliser(part) for part in typing.get_args(hint)]
        return next((part for part in found if part), None)
    if hint is float:
        return round_real
    if typing.get_origin(hint) is tuple:
        inner = _normaliser(typing.get_args(hint)[0])
        if inner is None:
            return tuple
        return _round_reals if inner is round_real else _round_points
    return None


@functools.cache
def _normalisers(cls: type[Record]) -> tuple[tuple[str, Callable[[Any], Any]], ...]:
    hints = typing.get_type_hints(cls, include_extras=True)
    found = ((name, _normaliser(hints[name])) for name in cls.__struct_fields__)
    return tuple((name, normalise) for name, normalise in found if normalise)


class Circle(Record, frozen=True, kw_only=True, tag_field="kind", tag="circle"):
    """A disc around the origin of the body's frame."""

    kind: ClassVar[Literal["circle"]] = "circle"
    radius: Annotated[float, _real("Radius", "m", (0.02, 5.0), slider=(0.05, 1.0))]


class Polygon(Record, frozen=True, kw_only=True, tag_field="kind", tag="polygon"):
    """A convex polygon with 3 or 4 corners, counter-clockwise, in the body's frame [m]."""

    kind: ClassVar[Literal["polygon"]] = "polygon"
    vertices: _Vertices


Shape = Circle | Polygon


class MassProperties(Record, frozen=True, kw_only=True):
    """Mass and inertia that override what shape and density give (imported levels only)."""

    mass: Annotated[float, _real("Mass", "kg", (1e-12, 1e12))]
    inertia: Annotated[
        float, _real("Moment of inertia about the centre of mass", "kg m²", (1e-12, 1e12))
    ]


class Body(Record, frozen=True, kw_only=True):
    """A circle or polygon."""

    id: _Id
    name: _Name = None
    shape: Shape
    position: tuple[_Coordinate, _Coordinate]
    angle: _Angle = 0.0
    velocity: tuple[_Speed, _Speed] = (0.0, 0.0)
    angular_velocity: _AngularVelocity = 0.0
    density: _Density = 1.0
    friction: _Friction = 1.0
    restitution: _Restitution = 0.0
    role: _Role = "none"
    fixed: Annotated[bool, _note("Infinite mass: nothing moves it")] = False
    collision: _Collision = "normal"
    mass_properties: Annotated[
        MassProperties | None, _note("Overrides what shape and density give", optional=True)
    ] = None


class Geometry(Record, frozen=True, kw_only=True):
    """Place and shape of an arena body that is not the standard one; counter-clockwise."""

    position: tuple[_ArenaCoordinate, _ArenaCoordinate]
    vertices: _Vertices


class ArenaBody(Record, frozen=True, kw_only=True):
    """Floor, wall or ceiling: always present, always fixed."""

    role: _Role = "none"
    friction: _Friction = 1.0
    restitution: _Restitution = 0.0
    density: _Density = 1.0
    collision: _Collision = "always"
    geometry: Annotated[
        Geometry | None, _note("Place and shape, when not the standard ones", optional=True)
    ] = None


class Arena(Record, frozen=True, kw_only=True):
    """The four arena bodies."""

    floor: ArenaBody = ArenaBody()
    left_wall: ArenaBody = ArenaBody()
    right_wall: ArenaBody = ArenaBody()
    ceiling: ArenaBody = ArenaBody()


class Motor(Record, frozen=True, kw_only=True):
    """Motor of a joint; a joint without one counts as `Motor(on=False)`."""

    on: Annotated[bool, _note("Whether the joint answers to a control")] = True
    speed: Annotated[
        float,
        _real(
            "Target speed, in units of 6 rad/s",
            "× 6 rad/s",
            (-FASTEST_MOTOR, FASTEST_MOTOR),
            slider=(-3.0, 3.0),
            step=0.05,
        ),
    ] = 1.0
    power: Annotated[
        float,
        _real(
            "Strength, in units of 900 rad/s²",
            "× 900 rad/s²",
            (0.0, STRONGEST_MOTOR),
            slider=(0.0, 10.0),
            step=0.05,
        ),
    ] = 1.0
    binding: Annotated[
        int, Meta(ge=0, le=MOTOR_BINDINGS - 1, description="Action channel that drives it")
    ] = 0
    auto: Annotated[bool, _note("Always driven at +1, whatever the controls say")] = False


class Limits(Record, frozen=True, kw_only=True):
    """Angle limits of a joint, from its reference angle; a joint without counts as off, 0, 0."""

    on: Annotated[bool, _note("Whether the limits hold")] = True
    min: Annotated[
        float,
        _real("Least angle", "rad", (-WIDEST_LIMIT, WIDEST_LIMIT), slider=(-math.pi, math.pi)),
    ] = 0.0
    max: Annotated[
        float,
        _real("Greatest angle", "rad", (-WIDEST_LIMIT, WIDEST_LIMIT), slider=(-math.pi, math.pi)),
    ] = 0.0


class Joint(Record, frozen=True, kw_only=True):
    """Holds two bodies together at a point; a motor at +1 turns b counter-clockwise against a."""

    id: _Id
    name: _Name = None
    kind: Annotated[JointKind, _note("A hinge, or a weld that also holds the angle")]
    a: Annotated[BodyReference, _note("First body")]
    b: Annotated[BodyReference, _note("Second body")]
    anchor_a: tuple[_Anchor, _Anchor]
    anchor_b: tuple[_Anchor, _Anchor]
    reference_angle: Annotated[
        float,
        _real(
            "Angle of b minus angle of a that counts as zero",
            "rad",
            _ANGLES,
            slider=(-math.pi, math.pi),
        ),
    ] = 0.0
    motor: Annotated[Motor | None, _note("Motor")] = None
    limits: Annotated[Limits | None, _note("Angle limits")] = None


class Thruster(Record, frozen=True, kw_only=True):
    """Pushes its body along the body's angle plus its own."""

    id: _Id
    name: _Name = None
    body: Annotated[int, Meta(ge=1, le=2**53, description="Body that it pushes")]
    position: tuple[_Anchor, _Anchor]
    angle: _Angle = 0.0
    power: Annotated[
        float,
        _real(
            "Strength, in units of 10 N",
            "× 10 N",
            (0.0, STRONGEST_THRUSTER),
            slider=(0.0, 20.0),
            step=0.05,
        ),
    ] = 1.0
    binding: Annotated[
        int, Meta(ge=0, le=THRUSTER_BINDINGS - 1, description="Action channel that drives it")
    ] = 0


_Choice = Annotated[int, Meta(ge=0, le=2)]
_Channels = tuple[_Choice, _Choice, _Choice, _Choice, _Choice, _Choice]


class Solution(Record, frozen=True, kw_only=True):
    """Recorded multi-discrete actions that win the level, run-length encoded."""

    physics: Annotated[
        str, Meta(min_length=1, max_length=40, description="Physics preset that it wins under")
    ]
    frame_skip: Annotated[
        int, Meta(ge=1, le=1000, description="Physics steps per environment step")
    ]
    actions: Annotated[
        tuple[tuple[Annotated[int, Meta(ge=1, le=MAX_STEPS)], _Channels], ...],
        Meta(
            max_length=MAX_STEPS,
            description="Runs: how many environment steps, then what is driven: four motor "
            "controls (0 off, 1 counter-clockwise, 2 clockwise) and two thrusters (0 off, 1 on)",
        ),
    ]
    """At most `MAX_STEPS` steps in all."""

    def __post_init__(self) -> None:
        """Make nested sequences tuples."""
        runs = tuple((repeat, tuple(channels)) for repeat, channels in self.actions)
        msgspec.structs.force_setattr(self, "actions", runs)

    @property
    def steps(self) -> int:
        """Environment steps in all."""
        return sum(repeat for repeat, _ in self.actions)

    def unrolled(self) -> Iterator[tuple[int, ...]]:
        """One action vector per environment step."""
        for repeat, channels in self.actions:
            for _ in range(repeat):
                yield channels


class SizeHint(Record, frozen=True, kw_only=True):
    """A capacity without a name; `polygons` counts the four arena bodies."""

    polygons: Annotated[int, Meta(ge=4, le=MAX_ENTITIES)]
    circles: Annotated[int, Meta(ge=0, le=MAX_ENTITIES)]
    joints: Annotated[int, Meta(ge=0, le=MAX_ENTITIES)]
    thrusters: Annotated[int, Meta(ge=0, le=MAX_ENTITIES)]


Entity = Body | Joint | Thruster


class Level(Record, frozen=True, kw_only=True):
    """A whole level. In Python, `next_id` left at 0 becomes one more than the largest id in use."""

    name: Annotated[str, Meta(min_length=1, max_length=MAX_TITLE, description="Title for people")]
    description: Annotated[
        str, Meta(max_length=MAX_DESCRIPTION, description="What to do, hints, credits")
    ] = ""
    tags: Annotated[tuple[Tag, ...], Meta(max_length=MAX_TAGS)] = ()
    size: Annotated[
        SizeName | SizeHint | None,
        _note("Capacity to compile to; none: the smallest that fits", optional=True),
    ] = None
    gravity: tuple[_Gravity, _Gravity] = (0.0, -9.81)
    max_timesteps: Annotated[
        int, Meta(ge=1, le=MAX_STEPS, description="Episode length in environment steps")
    ] = 256
    inertia_model: Annotated[
        InertiaModel, _note("How mass properties follow from shape and density")
    ] = "exact"
    arena: Arena = Arena()
    next_id: Annotated[
        int, Meta(ge=1, le=2**53 + 1, description="Larger than every id that was ever in use")
    ] = 0
    bodies: Annotated[tuple[Body, ...], Meta(max_length=MAX_ENTITIES)] = ()
    joints: Annotated[tuple[Joint, ...], Meta(max_length=MAX_ENTITIES)] = ()
    thrusters: Annotated[tuple[Thruster, ...], Meta(max_length=MAX_ENTITIES)] = ()
    solution: Annotated[
        Solution | None, _note("Recorded actions that win the level", optional=True)
    ] = None

    def __post_init__(self) -> None:
        """Round reals, make sequences tuples, derive `next_id` where it was left out."""
        super().__post_init__()
        if self.next_id == 0:
            following = max((entity.id for entity in self.entities()), default=0) + 1
            msgspec.structs.force_setattr(self, "next_id", following)

    def __repr__(self) -> str:
        """Name, and how much there is."""
        counts = (
            plural(len(self.bodies), "body", "bodies"),
            plural(len(self.joints), "joint"),
            plural(len(self.thrusters), "thruster"),
        )
        return f"Level({self.name!r}: {', '.join(counts)})"

    def entities(self) -> Iterator[Entity]:
        """Bodies, then joints, then thrusters, each in list order."""
        yield from self.bodies
        yield from self.joints
        yield from self.thrusters

    def unnamed(self) -> "Level":
        """Return the level without the names of its entities; itself when there are none."""
        if all(entity.name is None for entity in self.entities()):
            return self
        return self.replace(
            bodies=tuple(body.replace(name=None) for body in self.bodies),
            joints=tuple(joint.replace(name=None) for joint in self.joints),
            thrusters=tuple(thruster.replace(name=None) for thruster in self.thrusters),
        )

    def entity(self, entity_id: int) -> Entity:
        """Return the body, joint or thruster with this id.

        Raises:
            KeyError: No entity has it.
        """
        for entity in self.entities():
            if entity.id == entity_id:
                return entity
        raise KeyError(entity_id)

    def body(self, body_id: int) -> Body:
        """Return the body with this id.

        Raises:
            KeyError: No body has it.
        """
        for body in self.bodies:
            if body.id == body_id:
                return body
        raise KeyError(body_id)
