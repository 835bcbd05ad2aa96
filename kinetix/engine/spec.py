"""The only static configuration of the engine: how many slots there are and what a scene uses."""

import dataclasses
from typing import Any, Final

ARENA_BODIES: Final = 4
"""Floor, left wall, right wall, ceiling: polygons 0–3, fixed, never paired with each other."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Capacity:
    """Slots of each kind in a compiled step."""

    polygons: int
    """Polygons, the four arena bodies included."""
    circles: int
    joints: int
    thrusters: int

    @property
    def bodies(self) -> int:
        """Polygons and circles together."""
        return self.polygons + self.circles

    def covers(self, other: "Capacity") -> bool:
        """Return whether everything that fits `other` fits here too."""
        return all(
            mine >= theirs
            for mine, theirs in zip(
                dataclasses.astuple(self), dataclasses.astuple(other), strict=True
            )
        )

    def union(self, other: "Capacity") -> "Capacity":
        """Return the smallest capacity that covers both."""
        pairs = zip(dataclasses.astuple(self), dataclasses.astuple(other), strict=True)
        return Capacity(
            **dict(
                zip(
                    ("polygons", "circles", "joints", "thrusters"),
                    (max(p) for p in pairs),
                    strict=True,
                )
            )
        )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Used:
    """Slots that a scene fills, in order; no other ever holds anything."""

    bodies: tuple[int, ...]
    """Global indices, those of the arena included."""
    joints: tuple[int, ...]
    thrusters: tuple[int, ...]

    def union(self, other: "Used") -> "Used":
        """Return the slots that either of two scenes fills."""
        kinds = zip(self._kinds, other._kinds, strict=True)
        bodies, joints, thrusters = (tuple(sorted({*mine, *theirs})) for mine, theirs in kinds)
        return Used(bodies=bodies, joints=joints, thrusters=thrusters)

    def covers(self, other: "Used") -> bool:
        """True if another scene fills none but these slots."""
        kinds = zip(self._kinds, other._kinds, strict=True)
        return all(set(theirs) <= set(mine) for mine, theirs in kinds)

    @property
    def _kinds(self) -> tuple[tuple[int, ...], ...]:
        return self.bodies, self.joints, self.thrusters


@dataclasses.dataclass(frozen=True, kw_only=True)
class Features:
    """Features of a scene: only those are compiled. The defaults leave everything in."""

    pairs: tuple[tuple[int, int], ...] | None = None
    """The pairs (global indices, a < b) that can ever push each other; None: all candidates."""
    used: Used | None = None
    """The slots to compile a step for; None: all."""
    restitution: bool = True
    triangles: bool = True
    limits: bool = True
    welds: bool = True
    motors: bool = True
    thrusters: bool = True

    def lacks(self, needed: "Features") -> tuple[str, ...]:
        """Return the names of those among some features that are not among these."""
        return tuple(
            field.name
            for field in dataclasses.fields(self)
            if not _covers(getattr(self, field.name), getattr(needed, field.name))
        )


def _covers(mine: Any, theirs: Any) -> bool:
    match mine:
        case bool():
            return mine or not theirs
        case None:
            return True
        case Used():
            return theirs is not None and mine.covers(theirs)
        case _:
            return theirs is not None and set(theirs) <= set(mine)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SceneSpec:
    """Sizes and features: frozen and hashable, so that it can be a static argument of jit."""

    capacity: Capacity
    features: Features = Features()
