"""Words, icons and colours of the modes and of the ways in which an episode ends."""

from typing import Final

from editor.play.mode import Mode
from editor.toolkit.appearance import Icons
from kinetix.environment.outcome import Outcome

MODE_LOOK: Final[dict[Mode, tuple[str, str]]] = {
    Mode.EDIT: ("EDIT", "accent"),
    Mode.PLAYING: ("PLAY", "play"),
    Mode.PAUSED: ("PAUSED", "warn"),
    Mode.ENDED: ("ENDED", "info"),
    Mode.REPLAY: ("REPLAY", "replay"),
}
"""Word and name of the colour of each mode."""

OUTCOME_LOOK: Final[dict[Outcome, tuple[str, str, str]]] = {
    "won": (Icons.trophy, "Won", "good"),
    "lost": (Icons.skull, "Lost", "bad"),
    "timeout": (Icons.hourglass, "Time is up", "warn"),
    "broken": (Icons.error, "Physics broke down", "bad"),
}
"""Icon, word and name of the colour of each outcome."""
