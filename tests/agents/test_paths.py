"""Ways of attempts: those of an evaluation, and where wins leave losses."""

from types import SimpleNamespace

import jax
import numpy as np
import pytest

from kinetix.agents.evaluate import Settings, evaluate
from kinetix.agents.results import EpisodeResult
from kinetix.agents.scripted import ScriptedPlayer
from kinetix.agents.trajectories import Paths, attempt_paths, endings, parting
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


def test_the_last_place_is_that_in_which_the_attempt_ends(monkeypatch):
    """A body goes 0.1 m a step; what ended after 7 steps is stepped on, as a batch is."""

    def at(step):
        place = np.array([[[0.1 * step, 0.0]], [[0.2 * step, 0.0]]])
        physics = SimpleNamespace(position=place)
        over = np.array([step >= 7, step >= 12])
        return SimpleNamespace(step=step, over=over, state=SimpleNamespace(physics=physics))

    green = SimpleNamespace(
        labels=SimpleNamespace(role=np.array([1])),
        world=SimpleNamespace(bodies=SimpleNamespace(active=np.array([True]))),
    )
    for name, value in {
        "prepare": lambda *of: SimpleNamespace(capacity=None, key=0),
        "environment_for": lambda *of, **more: SimpleNamespace(static_env_params=None),
        "level_state": lambda *of: green,
        "rows": lambda policy: 2,
        "begin": lambda *of: at(0),
        "go_on": lambda env, player, now, steps, settings: at(now.step + steps),
        "episode_results": lambda episodes: [None, None],
    }.items():
        monkeypatch.setattr(f"kinetix.agents.trajectories.{name}", value)
    monkeypatch.setattr(jax.tree, "map", lambda function, tree: tree)
    *_, found = attempt_paths(ScriptedPlayer("noop"), LEVELS[0], Settings(attempts=2))
    assert found.step.tolist() == [0, 2, 4, 6, 8, 10, 12]
    first, second = found.position[..., 0]
    assert first == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.7, 0.7, 0.7])
    assert second == pytest.approx([0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4])


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


def test_attempts_are_grouped_by_how_they_end():
    """Outcome and place make a group; each loss has its own step at which it leaves the wins."""
    step = np.arange(4, dtype=np.int32) * 2
    ways = {
        "won": [(0, 0), (1, 0), (2, 0), (3, 0)],
        "low": [(0, 0), (0, 1), (0, 2), (0, 3)],
        "late": [(0, 0), (1, 0), (2, 2), (2, 4)],
    }
    rows = [("won", "won"), ("low", "lost"), ("low", "lost"), ("late", "lost"), ("late", "timeout")]
    paths = Paths(
        step=step,
        position=np.array([ways[way] for way, _ in rows], np.float32),
        results=tuple(EpisodeResult(outcome=end, total_reward=0.0, length=6) for _, end in rows),
    )
    found = {(one.outcome, one.attempts): one for one in endings(paths)}
    assert set(found) == {("lost", (1, 2)), ("won", (0,)), ("lost", (3,)), ("timeout", (4,))}
    assert found["lost", (1, 2)].parting == 2 and found["lost", (3,)].parting == 4
    assert found["won", (0,)].parting is None
    assert found["lost", (1, 2)].place == pytest.approx((0.0, 3.0))
    assert endings(paths)[0].attempts == (1, 2)
