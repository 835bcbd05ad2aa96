"""Other keys for actions and for driving, without two meanings for one key."""

from collections.abc import Mapping
from typing import Final

from editor.actions.base import Action, Context
from editor.actions.dispatch import chords
from editor.actions.table import ACTIONS, BY_ID
from editor.base.controls import DEFAULT_KEYS, Drive
from editor.session import Session

_TOGETHER: Final[dict[Context, frozenset[Context]]] = {
    Context.EDIT: frozenset({Context.EDIT, Context.LEVEL, Context.GLOBAL}),
    Context.PLAY: frozenset({Context.PLAY, Context.LEVEL, Context.GLOBAL}),
    Context.LEVEL: frozenset({Context.EDIT, Context.PLAY, Context.LEVEL, Context.GLOBAL}),
    Context.GALLERY: frozenset({Context.GALLERY, Context.GLOBAL}),
    Context.GLOBAL: frozenset(Context),
}
"""With which contexts' keys an action's keys can be confused."""


def conflict(session: Session, action: Action, chord: str) -> str:
    """Return the present meaning of a chord where the action is used; empty when it is free.

    Args:
        session: The app.
        action: The action that is to get the chord.
        chord: Such as `ctrl+d`.

    Returns:
        The label of the other action, or of what the key drives.
    """
    for other in ACTIONS:
        if other.id == action.id or other.context not in _TOGETHER[action.context]:
            continue
        if chord in (*chords(session, other), *other.variants):
            return other.label
    playing = action.context in _TOGETHER[Context.PLAY]
    if playing and chord in session.control_keys:
        return drive_label(session.control_keys[chord])
    return ""


def bind(session: Session, action: Action, chord: str) -> None:
    """Give an action a chord, and only that one; it is taken away from whatever had it."""
    for other in ACTIONS:
        if other.id != action.id and other.context in _TOGETHER[action.context]:
            kept = [one for one in chords(session, other) if one != chord]
            if len(kept) != len(chords(session, other)):
                session.settings.keys[other.id] = kept
    if action.context in _TOGETHER[Context.PLAY] and chord in session.control_keys:
        _store(session, {k: d for k, d in session.control_keys.items() if k != chord})
    session.settings.keys[action.id] = [chord]
    _forget_defaults(session)


def unbind(session: Session, action: Action) -> None:
    """Take every chord from an action; menus and palette still do it."""
    session.settings.keys[action.id] = []
    _forget_defaults(session)


def changed(session: Session, action: Action) -> bool:
    """Return whether an action has other chords than at first."""
    return action.id in session.settings.keys


def drive_conflict(session: Session, drive: Drive, key: str) -> str:
    """Return the present meaning of a key in Play; empty when it is free."""
    present = session.control_keys.get(key)
    if present is not None and present != drive:
        return drive_label(present)
    for action in ACTIONS:
        if action.context in _TOGETHER[Context.PLAY] and key in chords(session, action):
            return action.label
    return ""


def bind_drive(session: Session, drive: Drive, key: str) -> None:
    """Let a key drive a channel instead of the key that did; it loses its other meaning in Play."""
    for action in ACTIONS:
        if action.context in _TOGETHER[Context.PLAY] and key in chords(session, action):
            kept = [one for one in chords(session, action) if one != key]
            session.settings.keys[action.id] = kept
    rest = {k: d for k, d in session.control_keys.items() if d != drive and k != key}
    _store(session, rest | {key: drive})
    _forget_defaults(session)


def unbind_drive(session: Session, drive: Drive) -> None:
    """Take every key from what it drives."""
    _store(session, {k: d for k, d in session.control_keys.items() if d != drive})
    _forget_defaults(session)


def drive_changed(session: Session, drive: Drive) -> bool:
    """Return whether other keys drive a channel than at first."""
    return driving_keys(session.control_keys, drive) != driving_keys(DEFAULT_KEYS, drive)


def driving_keys(keys: Mapping[str, Drive], drive: Drive) -> list[str]:
    """Return which of some keys drive a channel."""
    return [key for key, does in keys.items() if does == drive]


def reset_all(session: Session) -> None:
    """All keys as they were at first."""
    session.settings.keys.clear()
    session.settings.controls.clear()


def any_changed(session: Session) -> bool:
    """Return whether any key is another than at first."""
    return bool(session.settings.keys or session.settings.controls)


def drive_label(drive: Drive) -> str:
    """Name the control that a key drives."""
    if drive.channel < 4:
        way = "forwards" if drive.value == 1 else "backwards"
        return f"Motors of group {drive.channel + 1}, {way}"
    return f"Thrusters of group {drive.channel - 3}"


def _store(session: Session, keys: dict[str, Drive]) -> None:
    session.settings.controls = {key: [d.channel, d.value] for key, d in keys.items()}


def _forget_defaults(session: Session) -> None:
    """Keep in the settings only what differs, so that later defaults reach everybody."""
    settings = session.settings
    settings.keys = {
        name: keys
        for name, keys in settings.keys.items()
        if name in BY_ID and tuple(keys) != BY_ID[name].keys
    }
    if session.control_keys == dict(DEFAULT_KEYS):
        settings.controls = {}
