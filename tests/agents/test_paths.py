"""Ways of attempts: those of an evaluation, and where wins leave losses."""

import numpy as np
import pytest

from kinetix.agents.evaluate import evaluate
from kinetix.agents.paths import Paths, attempt_paths, parting
from kinetix.agents.results import EpisodeResult
from kinetix.agents.scripted import ScriptedPlayer
from tests.agents.test_evaluate import _FAST, LEVELS


def _paths(ways, outcomes):
    position = np.array(ways, np.float32)
    return Paths(
        step=np.arange(position.shape[1]) * 2,
        position=position,
        results=tuple(EpisodeResult(outcome=o, total_reward=0.0, length=3) for o in outcomes),
    )


_LEFT = [(0.0, 0.0), (0.0, 1.0), (-1.0, 2.0), (-2.0, 2.0)]
_RIGHT = [(0.0, 0.0), (0.0, 1.0), (1.0, 2.0), (2.0, 2.0)]


def test_wins_and_losses_part_where_they_stay_apart():
    ways = _paths([_LEFT, _LEFT, _RIGHT], ["won", "won", "lost"])
    assert parting(ways) == 4
    assert parting(_paths([_LEFT, _RIGHT], ["won", "won"])) is None
    assert parting(_paths([_LEFT, _RIGHT, _LEFT, _RIGHT], ["won", "won", "lost", "lost"])) is None


@pytest.mark.slow
def test_the_attempts_are_those_of_the_evaluation():
    player, level = ScriptedPlayer("noop"), LEVELS[0]
    *_, last = evaluate(player, [level], _FAST)
    *_, paths = attempt_paths(player, level, _FAST)
    assert paths.results == last.results[0].episodes
    start, end = paths.position[0][0], paths.position[0][-1]
    np.testing.assert_allclose(start, level.source.bodies[0].position, atol=1e-6)
    assert end[1] < start[1] - 0.5  # it fell
    assert len(paths.step) == paths.position.shape[1]
