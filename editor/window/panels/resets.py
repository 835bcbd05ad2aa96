"""Rows that the arrows beside fields set back."""

import contextlib
from collections.abc import Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

from editor.base.memoise import remembers
from editor.documents.commands.base import EntityId, Selection
from editor.documents.commands.fields import alike, read_field, selected_records
from kinetix.errors import CommandError
from kinetix.level.model import Level

if TYPE_CHECKING:
    from editor.session import Session

SAVED: Final = object()
"""In the place of a default: what the level's file says."""


def reset_rows(
    session: "Session", ids: Selection, paths: Sequence[str], default: Any
) -> tuple[tuple[EntityId, str, Any], ...]:
    """Return entity, field and value of everything that an arrow would set back.

    Args:
        session: The app.
        ids: What is selected.
        paths: Dotted names of the fields.
        default: What they go back to; `SAVED`: what the level's file says of each.
    """
    document = session.document
    known = _reset_rows_of(document.shown, document.saved)
    key = (ids, tuple(paths), default)
    if key not in known:
        known[key] = tuple(_reset_rows(document.shown, document.saved, *key))
    return known[key]


@remembers(2)
def _reset_rows_of(
    shown: Level, saved: Level | None
) -> dict[Hashable, tuple[tuple[EntityId, str, Any], ...]]:
    """Return the rows that were worked out for two levels; empty for new ones."""
    del shown, saved
    return {}


def _reset_rows(
    shown: Level, saved: Level | None, ids: Selection, paths: Sequence[str], default: Any
) -> Iterator[tuple[EntityId, str, Any]]:
    for entity in ids:
        now = selected_records(shown, (entity,))
        before = selected_records(saved, (entity,)) if saved else []
        for path in paths:
            with contextlib.suppress(CommandError, IndexError):
                value = read_field(before[0], path) if default is SAVED else default
                if not alike(read_field(now[0], path), value):
                    yield entity, path, value
