"""A film under way: every episode that has been played since somebody began to record."""

import dataclasses

from editor.play.mode import Mode
from editor.play.playback_view import Show
from editor.worker.snapshots import Trace
from kinetix.level.model import Level


@dataclasses.dataclass(frozen=True, kw_only=True)
class Recording:
    """Keeps the episodes that are played, also when they are begun again or left."""

    episode: int
    """Number of the episode during which recording began."""
    first: int
    """Environment step of that episode at which it began."""
    ended: bool = False
    """True if that episode had ended by then: without more of it, it is no part of the film."""
    parts: dict[int, tuple[Level, Trace]] = dataclasses.field(default_factory=dict)
    """Level and trace of each episode by its number, in the order of play."""

    @classmethod
    def of(cls, playback: Show) -> "Recording":
        """Begin with what is on show now, but for an episode that has ended."""
        first = playback.step_count if playback.active else 0
        ended = playback.mode is Mode.ENDED
        return cls(episode=playback.episode, first=first, ended=ended)

    def follow(self, playback: Show) -> None:
        """Let a frame pass.

        Args:
            playback: What is on show.
        """
        trace, level = playback.trace, playback.level
        if playback.active and not playback.waiting and trace is not None and level is not None:
            self.parts[playback.episode] = level, trace

    def films(self) -> list[tuple[Level, Trace]]:
        """Return one level and trace for each film: successive episodes of a level are joined."""
        films: list[tuple[Level, Trace]] = []
        for episode, (level, whole) in self.parts.items():
            own = episode == self.episode
            if own and self.ended and whole.snapshots[-1].step == self.first:
                continue
            trace = _since(whole, self.first) if own else whole
            if films and films[-1][0] == level:
                together = (*films.pop()[1].snapshots, *trace.snapshots)
                trace = dataclasses.replace(trace, snapshots=together, actions=())
            films.append((level, trace))
        return [(level, trace) for level, trace in films if len(trace.snapshots) > 1]


def _since(trace: Trace, step: int) -> Trace:
    """Return the part of a trace from an environment step on; all of it when nothing follows."""
    start = next((k for k, s in enumerate(trace.snapshots) if s.step >= step), 0)
    return trace.part(start, len(trace.snapshots) - 1)
