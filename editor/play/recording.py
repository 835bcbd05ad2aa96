"""What is shown while a film is recorded: parts of episodes, one after the other."""

import dataclasses

from editor.play.show import Show
from editor.worker.recording import Trace
from kinetix.level.model import Level


@dataclasses.dataclass(kw_only=True)
class Recording:
    """Keeps what is played from some moment on, also when it is begun again or left."""

    episode: int
    """Number of the episode that was on show last."""
    first: int
    """Environment step of that episode at which it comes into the film."""
    parts: list[tuple[Level, Trace]] = dataclasses.field(default_factory=list)
    """What was played, the episode on show last."""
    under_way: bool = False
    """True if the last part is that of the episode on show."""

    @classmethod
    def of(cls, playback: Show) -> "Recording":
        """Begin with what is on show now."""
        first = playback.step_count if playback.active else 0
        return cls(episode=playback.episode, first=first)

    def follow(self, playback: Show) -> None:
        """Let a frame pass.

        Args:
            playback: What is on show.
        """
        trace, level = playback.trace, playback.level
        if not playback.active or playback.waiting or trace is None or level is None:
            return
        if playback.episode != self.episode:
            self.episode, self.first, self.under_way = playback.episode, 0, False
        part = (level, since(trace, self.first))
        if self.under_way:
            self.parts[-1] = part
        else:
            self.parts.append(part)
            self.under_way = True

    def films(self) -> list[tuple[Level, Trace]]:
        """What becomes a film each: all that was played of one level in a row."""
        films: list[tuple[Level, Trace]] = []
        for level, trace in self.parts:
            if films and films[-1][0] == level:
                before = films[-1][1]
                together = (*before.snapshots, *trace.snapshots)
                films[-1] = (level, dataclasses.replace(trace, snapshots=together, actions=()))
            else:
                films.append((level, trace))
        return [(level, trace) for level, trace in films if len(trace.snapshots) > 1]


def since(trace: Trace, step: int) -> Trace:
    """The part of a trace from an environment step on; all of it when nothing follows."""
    start = next((k for k, s in enumerate(trace.snapshots) if s.step >= step), 0)
    return dataclasses.replace(
        trace, snapshots=trace.snapshots[start:], actions=trace.actions[start:]
    )
