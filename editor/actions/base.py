"""User actions: one row of the table that menus, keys, palette, help and replays share."""

import dataclasses
import enum
from collections.abc import Callable

from editor.session import Session


class Context(enum.Enum):
    """Mode in which an action's keys count."""

    EDIT = "edit"
    PLAY = "play"
    """Playing, paused, ended and replay."""
    LEVEL = "level"
    """Wherever a level is on the screen: Edit and Play."""
    GALLERY = "gallery"
    """While the gallery is on the screen, in front of the level."""
    GLOBAL = "global"


def context_of(session: Session) -> Context:
    """Edit, Play or the gallery."""
    if session.gallery.open:
        return Context.GALLERY
    return Context.EDIT if session.editing else Context.PLAY


def contexts(session: Session) -> tuple[Context, ...]:
    """Return the contexts whose actions count now, the narrowest first."""
    here = context_of(session)
    return (here, *((Context.LEVEL,) if here is not Context.GALLERY else ()), Context.GLOBAL)


def reached(session: Session) -> tuple[Context, ...]:
    """The contexts whose actions keys and a gamepad's buttons reach now, the narrowest first.

    None while a question or the palette has the keyboard. Behind the help, the keys' window and
    the preferences nobody sees what becomes of the level, so only what works everywhere counts.
    """
    if session.prompts or session.view.palette:
        return ()
    return (Context.GLOBAL,) if session.view.covered else contexts(session)


def always(session: Session) -> bool:
    """An action that can always be done."""
    del session
    return True


def editing(session: Session) -> bool:
    """Make an action that can be used while editing."""
    return session.editing


def playing(session: Session) -> bool:
    """An action for Play and Replay."""
    return not session.editing


def selecting(session: Session) -> bool:
    """An action on what is selected, in Edit."""
    return session.editing and bool(session.selection)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Action:
    """Something a user can do, by whatever way."""

    id: str
    """Stable: replays and rebound keys name it."""
    label: str
    """Text in the menu."""
    menu: str
    """Menu it stands in: File, Edit, Tools, Arrange, View, Run, Level, Gallery, Help."""
    group: str = ""
    """Neighbours of one group stand together in the menu; a line divides them from others."""
    keys: tuple[str, ...] = ()
    """Default chords, as `KeyEvent.chord` writes them: `ctrl+shift+z`."""
    context: Context = Context.GLOBAL
    seen: bool = False
    """True if its keys do nothing while a window covers the level and the gallery."""
    tooltip: str = ""
    """A sentence more than the label."""
    variants: tuple[str, ...] = ()
    """Chords that do it too, some in another measure (`shift+left`): `run` asks the session."""
    enabled: Callable[[Session], bool] = always
    passing: bool = False
    """True if the menu has it only while it can be done."""
    refusal: str = ""
    """Reason why it is disabled; empty for `editing`, `playing`, `selecting`."""
    run: Callable[[Session], None]
    checked: Callable[[Session], bool] | None = None
    """True if it is on, for those that switch something."""
