"""Modes of the app, as buttons, commands and records name them."""

import enum

from editor.play.states import Editing, Ended, Live, Paused, Replaying, Starting, State


class Mode(enum.Enum):
    """Mode of the app; the values stand in the record of a `state` event."""

    EDIT = "edit"
    PLAYING = "playing"
    PAUSED = "paused"
    ENDED = "ended"
    REPLAY = "replay"


def mode_of(state: State) -> Mode:
    """Return the mode that a state of playback belongs to."""
    match state:
        case Editing():
            return Mode.EDIT
        case Starting(paused=paused):
            return Mode.PAUSED if paused else Mode.PLAYING
        case Live():
            return Mode.PLAYING
        case Paused():
            return Mode.PAUSED
        case Ended():
            return Mode.ENDED
        case Replaying():
            return Mode.REPLAY
