"""How each mode is called and coloured: the badge and the frame around the canvas."""

from typing import Final

from editor.play.playback import Mode

MODE_LOOK: Final[dict[Mode, tuple[str, str]]] = {
    Mode.EDIT: ("EDIT", "accent"),
    Mode.PLAYING: ("PLAY", "play"),
    Mode.PAUSED: ("PAUSED", "warn"),
    Mode.ENDED: ("ENDED", "info"),
    Mode.REPLAY: ("REPLAY", "replay"),
}
"""Word and name of the colour of each mode."""
