"""How each mode is called and coloured: the badge and the frame around the canvas."""

from typing import Final

from editor.look import COLOURS, Rgba
from editor.playback import Mode

MODE_LOOK: Final[dict[Mode, tuple[str, Rgba]]] = {
    Mode.EDIT: ("EDIT", COLOURS.accent),
    Mode.PLAYING: ("PLAY", COLOURS.play),
    Mode.PAUSED: ("PAUSED", COLOURS.warn),
    Mode.ENDED: ("ENDED", COLOURS.info),
    Mode.REPLAY: ("REPLAY", COLOURS.replay),
}
"""Word and colour of each mode."""
