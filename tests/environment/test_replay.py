"""Recorded actions and doing nothing, from a level's start."""

from kinetix.environment.episode import _play
from kinetix.environment.replay import noop_outcome, replay_solution
from kinetix.level.model import Level, Solution


def test_doing_nothing_shares_its_program_with_solutions_whatever_the_limit() -> None:
    """A size is compiled once: a program takes twenty seconds, its episodes a tenth of one."""
    level = Level(name="empty", size="s")
    solution = Solution(physics="drift", frame_skip=2, actions=((20, (0,) * 6),))
    assert replay_solution(level.replace(solution=solution)) == "timeout"
    programs = _play._cache_size()
    for limit in (1, 40, 256, 700):
        assert noop_outcome(level.replace(max_timesteps=limit), "drift") == "timeout"
    assert _play._cache_size() == programs
