"""User actions and the two calls of every frame: `handle` for events, `update` for time.

The window does, in this order: `handle(session, event)` for every event that the toolkit does not
keep for itself, draw, `update(session, seconds)`.
"""

from editor.actions.base import Action, Context
from editor.actions.dispatch import available, chords, find, handle, run, update
from editor.actions.table import ACTIONS, BY_ID

__all__ = [
    "ACTIONS",
    "BY_ID",
    "Action",
    "Context",
    "available",
    "chords",
    "find",
    "handle",
    "run",
    "update",
]
