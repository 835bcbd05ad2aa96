"""User actions and the calls of every frame: `handle` for events, `advance` for time, `work`.

The window does, in this order: `handle(session, event)` for every event that the toolkit does not
keep for itself, `advance(session, seconds)`, draw the panels, `work(session)` for what these asked
for, paint the canvas. `update` is `work`, then `advance`, for whoever has no panels.
"""

from editor.actions.base import Action, Context
from editor.actions.dispatch import (
    advance,
    available,
    chords,
    find,
    handle,
    open_menu_of,
    refusal,
    run,
    update,
    work,
)
from editor.actions.table import ACTIONS, BY_ID

__all__ = [
    "ACTIONS",
    "BY_ID",
    "Action",
    "Context",
    "advance",
    "available",
    "chords",
    "find",
    "handle",
    "open_menu_of",
    "refusal",
    "run",
    "update",
    "work",
]
