"""The agents that come with the program."""

import pytest

from kinetix.agents.agent import load_agent
from kinetix.agents.evaluate import NamedLevel, Settings, evaluate
from kinetix.paths import checkpoints_dir

_AGENTS = sorted(path.parent for path in checkpoints_dir().glob("*/agent.json"))


@pytest.mark.parametrize("directory", _AGENTS, ids=lambda path: path.name)
def test_every_bundled_agent_loads_and_says_where_it_is_from(directory):
    card = load_agent(directory).card
    assert card.description
    assert card.training["environment_steps"] > 0
    assert f"`{directory.name}`" in (checkpoints_dir() / "README.md").read_text()


@pytest.mark.slow
def test_the_goalkeeper_saves():
    agent = load_agent(checkpoints_dir() / "goalkeeper")
    level = NamedLevel(name="s/goalkeeper", source="s/goalkeeper")
    *_, last = evaluate(agent, [level], Settings(attempts=50))
    assert last.results[0].solve_rate >= 0.9
