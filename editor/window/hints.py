"""Hints for the status line: what can be done now, with the keys as they are bound."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from editor.actions import BY_ID, chords
from editor.base.language import tr
from editor.play.mode import Mode
from editor.toolkit.keys import label

if TYPE_CHECKING:
    from editor.session import Session

_Hint = tuple[Sequence[str], str]
"""Actions, and what their keys do."""

_MOVES: Final = tuple(f"gallery.move_{name}" for name in ("left", "right", "up", "down"))
_GALLERY: Final[tuple[_Hint, ...]] = (
    (_MOVES, "move"),
    (("gallery.open",), "opens"),
    (("gallery.search",), "searches"),
    (("gallery.add_to_set",), "adds to the set"),
    (("gallery.rename",), "renames"),
    (("gallery.close",), "leaves"),
)
_STOP: Final[_Hint] = (("run.stop",), "edits")
_RESET: Final[_Hint] = (("run.reset",), "restarts")
_ATTEMPT: Final[_Hint] = (("agent.next_attempt",), "next attempt")
_STEPS: Final = ("run.step_back", "run.step")
_REPLAY: Final[tuple[_Hint, ...]] = (
    (("run.pause",), "plays it"),
    (_STEPS, "step"),
    (("run.loop_from", "run.loop_to"), "loop"),
    (("run.start_here",), "starts here"),
    _STOP,
)


def hint(session: "Session") -> str:
    """Return the line about the keys that matter now, in the window's language."""
    if session.gallery.open:
        return _told(session, _GALLERY)
    if session.editing:
        typed = session.driver.typed
        return tr(f"{session.hint}   size: {typed}" if typed else session.hint)
    return _told(session, _of_play(session))


def _of_play(session: "Session") -> Sequence[_Hint]:
    agent = session.playback.casting is not None
    if session.mode is Mode.REPLAY:
        return _REPLAY
    if session.mode is Mode.ENDED:
        again = ((("run.play_human",), "plays again"), (("run.step_back",), "steps back"))
        return (*again, *((_ATTEMPT,) if agent else ()), _STOP)
    space = (("run.pause",), "goes on" if session.mode is Mode.PAUSED else "pauses")
    if agent:
        return space, (("agent.take_over",), "takes over"), _ATTEMPT, _RESET, _STOP
    return space, (_STEPS, "step"), (("run.slower", "run.faster"), "speed"), _RESET, _STOP


def _told(session: "Session", hints: Sequence[_Hint]) -> str:
    """Write hints beside each other; what has no key is left out."""
    parts = []
    for action_ids, does in hints:
        keys = " ".join(filter(None, (key_of(session, action_id) for action_id in action_ids)))
        if keys:
            parts.append(f"{keys} {tr(does)}")
    return "   ".join(parts)


def key_of(session: "Session", action_id: str) -> str:
    """Return the first key of an action as people read it; nothing where it has none."""
    known = chords(session, BY_ID[action_id])
    return label(known[0]) if known else ""


def pressed(session: "Session", action_id: str, does: str) -> str:
    """Return `Press Backspace to restart`, in English; nothing where the action has no key."""
    key = key_of(session, action_id)
    return f"Press {key} {does}" if key else ""
