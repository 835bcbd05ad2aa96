"""The planner drives an episode of the app: futures, its memory, a hand that takes over."""

import numpy as np
import pytest

from editor.worker.requests import Advance, AgentRef, Casting, Restore, StartEpisode
from editor.worker.snapshots import Snapshot
from kinetix.level.codec import load_level


class Silent:
    """Nobody waits."""

    def report(self, fraction, message):
        """Go on."""

    def share(self, partial):
        """Drop it."""


@pytest.mark.slow
def test_the_planner_wins_on_the_canvas_and_shows_its_futures():
    from editor.worker.simulation.cast import load
    from editor.worker.simulation.episode import Episode

    summary = load("planner")
    assert (summary.any_size, summary.network) == (True, "it knows the simulator")
    level = load_level("s/goalkeeper")
    casting = Casting(agent=AgentRef(path="planner"))
    request = StartEpisode(run=1, level=level, physics="jax2d", casting=casting)
    episode = Episode(request, Silent())
    first: Snapshot = episode.snapshot
    assert first.step == 0
    told = episode.advance(Advance(run=1, actions=(None,) * 6))
    mind = told[0].mind
    assert mind is not None and mind.scripted and mind.futures is not None
    assert mind.futures.ways.shape[1:] == (32, 2)
    assert len(mind.futures.ends) == len(mind.futures.ways) == len(mind.futures.steps)
    # A hand drives, it plans on; then it goes back, and on from its memory of then.
    episode.advance(Advance(run=1, actions=((1, 0, 0, 0, 0, 0),) * 2))
    episode.restore(Restore(run=1, snapshot=told[-1]), Silent())
    again = episode.advance(Advance(run=1, actions=(None,)))
    assert again[0].step == told[-1].step + 1
    last = episode.advance(Advance(run=1, actions=(None,) * 256))[-1]
    assert last.outcome == "won"
    assert np.isfinite(last.total_reward)
