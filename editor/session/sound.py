"""Sounds of an episode, between who hears them and who plays them."""

import dataclasses

from editor.play.cues import Cue, Ears
from editor.play.playback import Playback


@dataclasses.dataclass(kw_only=True)
class Sound:
    """Sounds to be played; the host takes them."""

    ears: Ears = dataclasses.field(default_factory=Ears)
    cues: list[Cue] = dataclasses.field(default_factory=list)
    fault: str = ""
    """Reason why nothing can be heard, as the host found."""

    def listen(self, playback: Playback, time: float, *, audible: bool) -> None:
        """Hear what has happened in an episode; where sound is off it is forgotten."""
        heard = self.ears.hear(playback, time)
        self.cues = heard if audible else []

    def take(self) -> list[Cue]:
        """Return what is to be played, once."""
        cues, self.cues = self.cues, []
        return cues
