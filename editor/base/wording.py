"""Words for entities: what menus, lists and messages call them."""

from collections.abc import Mapping, Sequence
from typing import Final

from editor.base.language import tr
from editor.base.memoise import remembers
from kinetix.level.model import ArenaBody, Body, Entity, Joint, Level, Record, Thruster
from kinetix.level.validate import issue
from kinetix.level.validate.issue import capital
from kinetix.wording import plural

_NOUNS: Final = {Body: "shape", Joint: "joint", Thruster: "thruster", ArenaBody: "arena part"}

ARENA_LABELS: Final = {
    "floor": "Floor",
    "left_wall": "Left wall",
    "right_wall": "Right wall",
    "ceiling": "Ceiling",
}


UNTITLED: Final = "Untitled"
"""Name of every new level, which the app shows in its language."""


def title_of(level: Level) -> str:
    """Return what a level is called in the language of the app: by the name that it was given."""
    return tr(UNTITLED) if level.name == UNTITLED else level.name


def counts(records: Sequence[Record]) -> str:
    """Count the entities of each kind: `3 shapes, 1 joint`; nothing for none."""
    parts = []
    for kind, noun in _NOUNS.items():
        count = sum(isinstance(record, kind) for record in records)
        if count:
            parts.append(plural(count, noun))
    return ", ".join(parts)


def describe(level: Level, entity_id: int | str) -> str:
    """Return what to call an entity: its own name, or "Green circle 3", "Floor", "Weld 7"."""
    if isinstance(entity_id, str):
        return ARENA_LABELS.get(entity_id, entity_id)
    entity = entities_by_id(level).get(entity_id)
    return f"Missing {entity_id}" if entity is None else entity.name or plain_name(entity)


def spoken(level: Level, entity_id: int | str) -> str:
    """Return the same in the language of the app: its own name is nobody's to translate."""
    entity = None if isinstance(entity_id, str) else entities_by_id(level).get(entity_id)
    own = None if entity is None else entity.name
    return own or tr(describe(level, entity_id))


@remembers(8)
def entities_by_id(level: Level) -> Mapping[int, Entity]:
    """Return bodies, joints and thrusters by their ids."""
    return {entity.id: entity for entity in level.entities()}


def plain_name(entity: Entity) -> str:
    """Return what an entity without a name is called: "Green circle 3", "Weld 7"."""
    return capital(issue.plain_name(entity))
