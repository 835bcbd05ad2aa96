"""Edits of a level as a whole: another content, the state of a simulation."""

import dataclasses
import random
from collections.abc import Hashable

from editor.documents.commands.bodies import Poses, posed
from kinetix.level.model import Circle, Level, Solution


@dataclasses.dataclass(frozen=True, kw_only=True)
class ReplaceLevel:
    """Puts another level in the place of this one (mutation, reload).

    Where ids are the same in both, they mean the same entity.
    """

    level: Level
    label: str
    merge_key: Hashable | None = None

    def apply(self, level: Level) -> Level:
        """Return the other level; the id counter never falls."""
        return self.level.replace(next_id=max(level.next_id, self.level.next_id))


def renumbered(level: Level, new: dict[int, int]) -> Level:
    """Return the level with other ids; `new` names every old one."""

    def end(reference: int | str) -> int | str:
        return reference if isinstance(reference, str) else new[reference]

    return level.replace(
        bodies=tuple(body.replace(id=new[body.id]) for body in level.bodies),
        joints=tuple(j.replace(id=new[j.id], a=end(j.a), b=end(j.b)) for j in level.joints),
        thrusters=tuple(t.replace(id=new[t.id], body=new[t.body]) for t in level.thrusters),
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class TakePoses:
    """Starts the level from where a simulation has taken its bodies."""

    poses: Poses
    label: str = "Edit from here"
    merge_key: Hashable | None = None

    def apply(self, level: Level) -> Level:
        """Put the bodies there."""
        return posed(level, self.poses)


@dataclasses.dataclass(frozen=True, kw_only=True)
class KeepSolution:
    """Records actions that win the level."""

    solution: Solution
    label: str = "Record solution"
    merge_key: Hashable | None = None

    def apply(self, level: Level) -> Level:
        """Put it in the place of an older one."""
        return level.replace(solution=self.solution)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Permute:
    """Puts polygons, circles, joints and thrusters into other slots, each kind by itself."""

    seed: int
    label: str = "Permute order"
    merge_key: Hashable | None = None

    def apply(self, level: Level) -> Level:
        """Shuffle the lists; ids stay, so that nothing but the order changes."""
        draw = random.Random(self.seed)
        circles = [body for body in level.bodies if isinstance(body.shape, Circle)]
        polygons = [body for body in level.bodies if not isinstance(body.shape, Circle)]
        joints, thrusters = list(level.joints), list(level.thrusters)
        for entities in (polygons, circles, joints, thrusters):
            draw.shuffle(entities)
        return level.replace(
            bodies=(*polygons, *circles), joints=tuple(joints), thrusters=tuple(thrusters)
        )
