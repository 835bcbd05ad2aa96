"""Entries of the command palette besides actions and files: settings, fields, single drawings."""

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from editor.actions import view
from editor.actions.files import examples
from editor.documents.commands.fields import field_name
from editor.drawing.debug_draw import LAYERS
from editor.window.panels.preferences import PAGES, choose
from kinetix.level.model import Body, Circle, Joint, Record, Thruster

if TYPE_CHECKING:
    from editor.session import Session

_LEVEL_FIELDS: Final = (
    *((field_name(name), f"level.{name}") for name in ("gravity.0", "gravity.1", "max_timesteps")),
    ("Name of the level", "level.name"),
    ("Tags", "level.tags"),
)
_BODY: Final = (
    *("position.x", "position.y", "angle", "density", "friction", "restitution"),
    *("velocity.x", "velocity.y", "angular_velocity"),
)
_JOINT: Final = ("motor.speed", "motor.power", "limits.min", "limits.max", "reference_angle")
_FIELDS: Final[tuple[tuple[type[Record], str, str], ...]] = (
    *((Body, field_name(name), name) for name in _BODY),
    (Circle, field_name("shape.radius"), "shape.radius"),
    *((Joint, field_name(name), name) for name in _JOINT),
    (Thruster, "Thruster power", "power"),
    (Thruster, "Thruster direction", "angle"),
)
"""Record type, words and dotted name of each field."""
_WANTED: Final[dict[type[Record], str]] = {
    Body: "Select a shape first.",
    Circle: "Select a circle first.",
    Joint: "Select a hinge first.",
    Thruster: "Select a thruster first.",
}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Entry:
    """Something that can be chosen."""

    label: str
    group: str
    keys: str = ""
    refusal: str = ""
    """Reason why it is disabled; empty when it is not."""
    run: Callable[[], None]


_SCATTERED: Final = 4.0
"""Penalty of letters that only follow each other somewhere."""


def score(words: str, typed: str) -> float | None:
    """Return how well words fit what was typed; None where they do not. Less is better.

    Words that begin so come first, in any order, then what lies within words, and last what has
    the letters one after the other.
    """
    lower = words.lower()
    ratings = [_score_word(lower, word) for word in typed.lower().split()]
    known = [rating for rating in ratings if rating is not None]
    if len(known) == len(ratings):
        return sum(known) + 0.01 * len(words)
    scattered = _score_letters(lower, typed.lower().replace(" ", ""))
    return None if scattered is None else _SCATTERED + scattered + 0.01 * len(words)


def _score_word(lower: str, word: str) -> float | None:
    """Rate the best place of a typed word: a whole word, the begin of one, or within one."""
    best, at = None, lower.find(word)
    while at >= 0:
        end = at + len(word)
        starts = at == 0 or not lower[at - 1].isalnum()
        whole = end == len(lower) or not lower[end].isalnum()
        rating = (0.3 if at else 0.0) + (0.0 if whole else 0.2) + (0.0 if starts else 1.5)
        best = rating if best is None else min(best, rating)
        at = lower.find(word, at + 1)
    return best


def _score_letters(lower: str, letters: str) -> float | None:
    """Rate letters that follow each other with others between."""
    at, total = -1, 0.0
    for letter in letters:
        following = lower.find(letter, at + 1)
        if following < 0:
            return None
        starts = following == 0 or lower[following - 1] in " -_/"
        total += (following - at - 1) * (0.3 if starts else 1.0)
        at = following
    return total


def settings_entries(session: "Session") -> list[Entry]:
    """Return the settings and the single debug drawings."""
    settings = session.settings
    found = []
    for row in (row for rows in PAGES.values() for row in rows):
        now = getattr(settings, row.name)
        for value, words in row.options or ((not now, ""),):
            state = "chosen" if row.options and value == now else "on" if now is True else "off"
            found.append(
                Entry(
                    label=f"{row.label}: {words}" if words else row.label,
                    group="Setting" if row.options and value != now else state,
                    run=lambda row=row, value=value: choose(session, row, value),
                )
            )
    for name, label in LAYERS.items():
        on = session.view.debug_draw and name in settings.debug_draw
        found.append(
            Entry(
                label=f"Debug drawing: {label}",
                group="on" if on else "off",
                run=lambda name=name: view.toggle_drawing(session, name),
            )
        )
    return found


def template_entries(session: "Session") -> list[Entry]:
    """Return what a new level can begin with."""
    return [
        Entry(
            label=f"New from: {label}",
            group="File",
            run=lambda template=template: examples.new_from(session, template),
        )
        for template, (label, _) in examples.TEMPLATES.items()
    ]


def field_entries(session: "Session") -> list[Entry]:
    """Return the fields of the level and of what is selected; choosing one types into it."""
    if not session.editing:
        return []
    found = [
        Entry(
            label=label,
            group="Level",
            run=lambda name=name: _type_into(session, "level", name),
        )
        for label, name in _LEVEL_FIELDS
    ]
    records = session.document.level.entities()
    selected = [record for record in records if record.id in session.selection]
    for kind, label, path in _FIELDS:
        fits = any(
            isinstance(record.shape if isinstance(record, Body) else None, Circle)
            if kind is Circle
            else isinstance(record, kind)
            for record in selected
        )
        found.append(
            Entry(
                label=label,
                group="Inspector",
                refusal="" if fits else _WANTED[kind],
                run=lambda path=path: _type_into(session, "inspector", f"inspector.{path}"),
            )
        )
    return found


def _type_into(session: "Session", panel: str, field: str) -> None:
    session.view.interface = True
    session.view.front, session.view.field = panel, field
