"""The clipboard: a sub-graph of a level as text, and pasting it."""

import dataclasses
import itertools
import re
from collections.abc import Collection, Hashable
from typing import Annotated, Final, Literal, TypeVar

import msgspec

from editor.documents.commands.base import Selection, count_label
from editor.documents.commands.level import renumbered
from editor.documents.commands.rigid import freed
from kinetix.errors import CommandError, KinetixError
from kinetix.files.json_text import parse_strictly
from kinetix.files.limits import LIMITS
from kinetix.level import canonical, codec
from kinetix.level.geometry import bounds_of, referenced_body, to_local, to_world
from kinetix.level.model import (
    MAX_NAME,
    Body,
    Circle,
    InertiaModel,
    Joint,
    Level,
    Point,
    Record,
    Thruster,
)

FORMAT: Final = "kinetix-clip"
VERSION: Final = 1
_NUMBERED: Final = re.compile(r"(.+) (\d{1,6})", re.DOTALL)
_LEVEL_MARKS: Final = (f'"{canonical.FORMAT}"', '"env_state"')
"""One of them is in every level file."""

Copied = TypeVar("Copied", Body, Joint, Thruster)


class Clip(Record, frozen=True, kw_only=True):
    """Content of the clipboard: bodies, joints between them or to the arena, thrusters."""

    format: Literal["kinetix-clip"] = FORMAT
    version: Annotated[int, msgspec.Meta(ge=1, le=VERSION)] = VERSION
    inertia_model: InertiaModel = "exact"
    """Of the level that it was copied from: it says where the origins of frames are."""
    bodies: tuple[Body, ...] = ()
    joints: tuple[Joint, ...] = ()
    thrusters: tuple[Thruster, ...] = ()


def copied(level: Level, selection: Selection) -> Clip:
    """Return the sub-graph of a selection: its bodies with all joints and thrusters between them.

    A selection without bodies copies the selected joints and thrusters themselves, which serve as
    the source of pasted properties.
    """
    bodies = tuple(body for body in level.bodies if body.id in selection)
    ids = {body.id for body in bodies}
    if not bodies:
        return Clip(
            joints=tuple(j for j in level.joints if j.id in selection),
            thrusters=tuple(t for t in level.thrusters if t.id in selection),
        )
    return Clip(
        inertia_model=level.inertia_model,
        bodies=bodies,
        joints=tuple(
            j for j in level.joints if all(isinstance(end, str) or end in ids for end in (j.a, j.b))
        ),
        thrusters=tuple(t for t in level.thrusters if t.body in ids),
    )


def dumps(clip: Clip) -> str:
    """Return the clip as text for the system's clipboard."""
    return msgspec.json.encode(clip).decode()


def loads(text: str) -> Clip:
    """Read a clip.

    Raises:
        CommandError: The text is no clip of ours.
    """
    try:
        clip = _read(text)
    except (KinetixError, msgspec.ValidationError) as error:
        reason = f": {error}" if FORMAT in text[:200] else ""
        raise CommandError(f"The clipboard holds nothing that can be pasted{reason}.") from None
    return clip


def loads_level(text: str) -> Level | None:
    """Read the text of a level's file; None if it is something else.

    Raises:
        CommandError: The text is a level's file that cannot be read.
    """
    if FORMAT in text[:200] or not any(mark in text for mark in _LEVEL_MARKS):
        return None
    try:
        _check_length(text)
        return codec.loads(text, "pasted")
    except KinetixError as error:
        raise CommandError(f"The level in the clipboard cannot be read. {error}") from None


def _check_length(text: str) -> None:
    if len(text) > LIMITS["level"].largest:
        raise CommandError("it is too long")


def _read(text: str) -> Clip:
    """Read a clip; what holds of a level in a file holds of it too."""
    _check_length(text)
    clip = msgspec.convert(parse_strictly(text, FORMAT), Clip)
    ends = {end for joint in clip.joints for end in (joint.a, joint.b)}
    ends |= {thruster.body for thruster in clip.thrusters}
    named = sorted({end for end in ends if not isinstance(end, str)})
    # Joints and thrusters alone: any body will do.
    any_body = Body(id=0, shape=Circle(radius=0.1), position=(0.0, 0.0))
    bodies = clip.bodies or tuple(any_body.replace(id=id) for id in named)
    if not set(named) <= {body.id for body in bodies}:
        raise CommandError("its joints do not fit its bodies")
    level = Level(
        name="clip",
        inertia_model=clip.inertia_model,
        bodies=bodies,
        joints=clip.joints,
        thrusters=clip.thrusters,
    )
    codec.loads(codec.dumps(level), FORMAT)
    return clip


@dataclasses.dataclass(frozen=True, kw_only=True)
class Paste:
    """Adds a clip's bodies, joints and thrusters with new ids.

    Names that the level has already are numbered: of `Wheel` the copies are `Wheel 2`, `Wheel 3`.
    """

    clip: Clip
    shift: Point
    """Distance from the place where they were copied [m]."""
    verb: str = "Paste"
    merge_key: Hashable | None = None

    @property
    def label(self) -> str:
        """Label with the number of items."""
        return count_label(self.verb, len(self.clip.bodies), "shape")

    def apply(self, level: Level) -> Level:
        """Append the sub-graph; joints to the arena are anchored at their new places.

        Raises:
            CommandError: The clip holds no body.
        """
        if not self.clip.bodies:
            raise CommandError("Copy at least one shape to paste it.")
        dx, dy = self.shift
        moved = Level(
            name="clip",
            inertia_model=level.inertia_model,
            arena=level.arena,
            bodies=tuple(
                b.replace(position=(b.position[0] + dx, b.position[1] + dy))
                for b in self.clip.bodies
            ),
            thrusters=self.clip.thrusters,
            joints=self.clip.joints,
        )
        for body in moved.bodies:
            moved = freed(moved, body.id)
        moved = moved.replace(joints=tuple(_on_arena(moved, j) for j in moved.joints))
        new = {old.id: level.next_id + k for k, old in enumerate(moved.entities())}
        fresh = _named_apart(renumbered(moved, new), level)
        return level.replace(
            bodies=level.bodies + fresh.bodies,
            joints=level.joints + fresh.joints,
            thrusters=level.thrusters + fresh.thrusters,
            next_id=level.next_id + len(new),
        )


def _named_apart(clip: Level, level: Level) -> Level:
    """Return a clip's things with a number after each name that a level has already."""
    taken = {entity.name for entity in level.entities()} - {None}
    used = taken | {entity.name for entity in clip.entities()}

    def apart(entity: Copied) -> Copied:
        if entity.name not in taken:
            return entity
        name = _next_name(entity.name or "", used)
        used.add(name)
        return entity.replace(name=name)

    return clip.replace(
        bodies=tuple(map(apart, clip.bodies)),
        joints=tuple(map(apart, clip.joints)),
        thrusters=tuple(map(apart, clip.thrusters)),
    )


def _next_name(name: str, used: Collection[str | None]) -> str:
    """Return a name with the next number that is free."""
    numbered = _NUMBERED.fullmatch(name)
    stem, first = (numbered[1], int(numbered[2]) + 1) if numbered else (name, 2)
    ends = (f" {number}" for number in itertools.count(first))
    names = (stem[: MAX_NAME - len(end)].rstrip() + end for end in ends)
    return next(each for each in names if each not in used)


def _on_arena(level: Level, joint: Joint) -> Joint:
    """Let a joint's anchor on the arena follow the one on its body."""
    if isinstance(joint.a, str) == isinstance(joint.b, str):
        return joint
    arena, body = ("a", "b") if isinstance(joint.a, str) else ("b", "a")
    point = to_world(referenced_body(level, getattr(joint, body)), getattr(joint, f"anchor_{body}"))
    local = to_local(referenced_body(level, getattr(joint, arena)), point)
    return joint.replace(**{f"anchor_{arena}": local})


def free_shift(clip: Clip, shift: Point, level: Level, step: Point) -> Point:
    """The shift that covers nothing exactly: what was pasted at the same place stays in sight.

    Args:
        clip: What is pasted.
        shift: The first choice [m].
        level: Where.
        step: What is added as long as a shape of the level lies where one of the clip would [m].
    """
    taken = {_rounded(body.position) for body in level.bodies}
    wanted = [body.position for body in clip.bodies]
    for _ in range(len(level.bodies)):
        if not any(_rounded((x + shift[0], y + shift[1])) in taken for x, y in wanted):
            break
        shift = shift[0] + step[0], shift[1] + step[1]
    return shift


def _rounded(at: Point) -> Point:
    return round(at[0], 4), round(at[1], 4)


def shift_to(clip: Clip, at: Point) -> Point:
    """Return the shift that puts the middle of a clip at a point [m]."""
    if not clip.bodies:
        return (0.0, 0.0)
    left, bottom, right, top = bounds_of(clip.bodies)
    return at[0] - (left + right) / 2, at[1] - (bottom + top) / 2
