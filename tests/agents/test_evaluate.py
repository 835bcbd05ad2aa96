"""Evaluation: protocol, equal seeds, refusals, and the published agent's published numbers."""

import dataclasses
import json
import re

import jax
import numpy as np
import pytest

from kinetix.agents.agent import Agent, load_agent, save_agent
from kinetix.agents.card import (
    AgentCard,
    CapacityCard,
    EnvironmentCard,
    NormalisationCard,
    ObservationCard,
)
from kinetix.agents.evaluate import NamedLevel, Settings, evaluate, record
from kinetix.agents.from_card import init_parameters
from kinetix.agents.networks.config import NetworkConfig
from kinetix.agents.results import summarise
from kinetix.agents.scripted import ScriptedPlayer
from kinetix.cli import main
from kinetix.level.codec import save_level
from kinetix.level.model import Body, Circle, Joint, Level, Motor, Polygon
from kinetix.level.sets import build_set, gather_levels, save_set

_FAST = Settings(attempts=3, physics="jax2d")


def _falling(height: float, goal: str = "blue") -> Level:
    """A green ball above a plate: it falls onto it by itself."""
    plate = Polygon(vertices=((-0.5, -0.1), (0.5, -0.1), (0.5, 0.1), (-0.5, 0.1)))
    return Level(
        name=f"falling {height} {goal}",
        max_timesteps=40,
        next_id=3,
        bodies=(
            Body(id=1, shape=Circle(radius=0.2), position=(2.5, height), role="green"),
            Body(id=2, shape=plate, position=(2.5, 0.5), fixed=True, role=goal),
        ),
    )


LEVELS = [
    NamedLevel(name="a/near", source=_falling(1.5)),
    NamedLevel(name="a/deadly", source=_falling(1.6, "red")),
    NamedLevel(name="a/nothing", source=_falling(1.7, "none")),
]


def _last(progress):
    *_, last = progress
    return last


def test_outcomes_of_episodes():
    results = _last(evaluate(ScriptedPlayer("noop"), LEVELS, _FAST)).results
    assert [result.solve_rate for result in results] == [1.0, 0.0, 0.0]
    near, deadly, nothing = results
    assert nothing.mean_length == 40
    assert near.mean_length < deadly.mean_length < 40
    assert near.mean_return > 0.9
    assert deadly.mean_return < -0.9


def test_progress_grows_and_can_be_stopped():
    generator = evaluate(ScriptedPlayer("noop"), LEVELS, _FAST)
    first = next(generator)
    assert (first.done, first.total, first.results) == (0, 9, ())
    generator.close()
    assert list(generator) == []


_CRANE = Level(
    name="crane",
    max_timesteps=60,
    next_id=5,
    bodies=(
        Body(id=1, shape=Circle(radius=0.3), position=(2.0, 1.5), fixed=True),
        Body(id=2, shape=Circle(radius=0.2), position=(2.5, 1.5), role="green"),
        Body(id=3, shape=Circle(radius=0.2), position=(2.0, 2.2), fixed=True, role="blue"),
    ),
    joints=(
        Joint(
            id=4,
            kind="revolute",
            a=1,
            b=2,
            anchor_a=(0.0, 0.0),
            anchor_b=(-0.5, 0.0),
            motor=Motor(binding=0),
        ),
    ),
)


def test_equal_seeds_give_equal_results_whatever_else_is_played():
    player = ScriptedPlayer("random")
    crane = NamedLevel(name="crane", source=_CRANE)
    settings = Settings(attempts=30, physics="jax2d", seed=4)
    alone = _last(evaluate(player, [crane], settings)).results[0]
    among = _last(evaluate(player, [*LEVELS, crane], settings)).results[3]
    other = Settings(attempts=30, physics="jax2d", seed=5)
    assert alone == among
    assert _last(evaluate(player, [crane], other)).results[0] != alone


def _flat_agent():
    card = AgentCard(
        name="flat",
        observation=ObservationCard(type="symbolic_flat"),
        network=NetworkConfig(kind="flat_mlp", actor_depth=1, critic_depth=1, actor_width=8),
        capacity=CapacityCard(polygons=5, circles=2, joints=1, thrusters=1),
    )
    return Agent(card, init_parameters(card, jax.random.key(0)))


def test_a_level_that_is_too_large_is_named_and_the_others_are_played(tmp_path, capsys):
    crane = NamedLevel(name="crane", source=_CRANE)
    missing = NamedLevel(name="gone", source="s/gone")
    last = _last(evaluate(_flat_agent(), [crane, missing, LEVELS[0]], _FAST))
    assert [result.level for result in last.results] == ["a/near"]
    assert (last.done, last.total) == (3, 3)
    large, gone = last.failures
    assert re.search(r"sees exactly 5 polygons, 2 circles.*crane with 6", large.error)
    assert gone.level == "gone"
    names = ["crane", "gone", "a/near"]
    assert [one.level for one in last.in_order(names)] == names


def test_the_command_goes_on_after_a_level_that_is_too_large(tmp_path, capsys):
    save_agent(_flat_agent(), tmp_path / "agent")
    (tmp_path / "levels").mkdir()
    save_level(_CRANE, tmp_path / "levels" / "crane.json")
    save_level(LEVELS[0].source, tmp_path / "levels" / "near.json")
    arguments = ["--agent", str(tmp_path / "agent"), "--levels", str(tmp_path / "levels")]
    assert main(["eval", *arguments, "--attempts", "2", "--physics", "jax2d", "--json"]) == 1
    crane, near, summary = map(json.loads, capsys.readouterr().out.splitlines())
    assert set(crane) == {"level", "error"}
    assert near["solve_rate"] == 1.0
    assert summary["levels"] == 1


def test_an_agent_is_measured_under_its_own_physics_unless_told():
    flat = _flat_agent()
    flat.card = flat.card.replace(environment=EnvironmentCard(physics="jax2d"))
    own = Settings().provenance(flat)
    assert (own.physics, own.digest) == ("jax2d", flat.digest)
    assert Settings(physics="fast").provenance(flat).physics == "fast"
    assert Settings().provenance(ScriptedPlayer("noop")).physics == "balanced"


@pytest.mark.parametrize(
    "change",
    [
        {"environment": EnvironmentCard(frame_skip=4)},
        {"environment": EnvironmentCard(dense_reward_scale=0.1)},
        {"environment": EnvironmentCard(dt=1 / 120)},
        {"normalisation": NormalisationCard(count=2, mean={"": [0.5]}, variance={"": [1.0]})},
    ],
)
def test_what_changes_results_is_in_what_they_depend_on(change):
    agent = _flat_agent()
    before = Settings().provenance(agent)
    assert (before.frame_skip, before.dense_reward_scale) == (2, 0.2)
    agent.card = agent.card.replace(name="other", description="x", training={"seed": 1})
    assert dataclasses.replace(Settings().provenance(agent), agent=before.agent) == before
    agent.card = agent.card.replace(name=before.agent, **change)
    after = Settings().provenance(agent)
    assert after.digest == before.digest and after != before


def test_the_agent_of_a_run_is_named_by_run_and_step(tmp_path):
    save_agent(_flat_agent(), tmp_path / "my_run" / "checkpoints" / "40960")
    agent = load_agent(tmp_path / "my_run")
    assert agent.card.name == "my_run@40960"
    text = (tmp_path / "my_run" / "checkpoints" / "40960" / "agent.json").read_text()
    assert agent.digest == json.loads(text)["digest"] == _flat_agent().digest


def test_a_flat_agent_plays_with_its_own_sizes():
    result = _last(evaluate(_flat_agent(), LEVELS[:1], _FAST)).results[0]
    assert result.solve_rate == 1.0


def test_the_command_prints_a_line_a_level_and_the_summary(tmp_path, capsys):
    (tmp_path / "a").mkdir()
    for level in LEVELS[:2]:
        save_level(level.source, tmp_path / "a" / f"{level.name[2:]}.json")
    arguments = ["eval", "--agent", "noop", "--levels", str(tmp_path), "--attempts", "2", "--json"]
    assert main([*arguments, "--physics", "jax2d"]) == 0
    *lines, summary = map(json.loads, capsys.readouterr().out.splitlines())
    assert [line["level"] for line in lines] == ["a/deadly", "a/near"]
    assert [line["solve_rate"] for line in lines] == [0.0, 1.0]
    assert set(lines[0]) == {
        "level",
        "solve_rate",
        "low",
        "high",
        "attempts",
        "mean_return",
        "mean_length",
    }
    assert summary["mean_solve_rate"] == 0.5
    assert (summary["physics"], summary["agent"], summary["levels"]) == ("jax2d", "noop", 2)


def test_equal_levels_count_once_and_parts_of_a_set_are_told_apart(tmp_path, capsys):
    save_level(_falling(1.5), tmp_path / "near.json")
    save_level(_falling(1.5).replace(max_timesteps=2), tmp_path / "short.json")
    made = build_set(gather_levels([tmp_path]), name="own", folder=tmp_path, split=0.5)
    save_set(made, tmp_path / "own.json")
    twice = [str(tmp_path / "own.json"), str(tmp_path)]
    arguments = ["--levels", *twice, "--attempts", "2", "--physics", "jax2d"]
    assert main(["eval", "--agent", "noop", *arguments, "--json"]) == 0
    printed = capsys.readouterr()
    assert "2 levels left out: equal to others" in printed.err
    *lines, summary = map(json.loads, printed.out.splitlines())
    part = {level.name: level.split for level in made.levels}
    assert summary["parts"] == {part[line["level"]]: line["solve_rate"] for line in lines}
    assert summary["levels"] == 2
    assert main(["compare", "--agents", "noop", *arguments]) == 0
    told = [f"{name} {summary['parts'][name]:.3f}" for name in ("train", "eval")]
    assert f"by part of the set: {', '.join(told)}" in capsys.readouterr().out


@pytest.mark.peer
@pytest.mark.slow
@pytest.mark.usefixtures("optimised")
@pytest.mark.parametrize("size", ["s", "m", "l"])
def test_the_published_agent_solves_as_often_as_published(peer, size):
    agent = load_agent(peer / "agents" / "paper-general")
    with (peer / "agents" / "paper-general" / "solve_rates.json").open() as file:
        published = json.load(file)["mean"][size]
    levels = [
        NamedLevel(name=f"{size}/{path.stem}", source=str(path))
        for path in sorted((peer / "levels" / size).glob("*.json"))
    ]
    results = _last(evaluate(agent, levels, Settings(physics="jax2d"))).results
    assert len(results) == len(levels)
    assert summarise(results)["mean_solve_rate"] == pytest.approx(published, abs=0.05)


def test_attempts_are_told_one_by_one():
    results = _last(evaluate(ScriptedPlayer("noop"), LEVELS, _FAST)).results
    near, deadly, nothing = results
    assert [episode.outcome for episode in near.episodes] == ["won"] * 3
    assert (near.failures, deadly.failures, nothing.failures) == ("", "3 lost", "3 timeout")
    assert deadly.mean_length == deadly.episodes[0].length


def test_an_episode_of_an_evaluation_is_played_again_to_the_bit():
    player, crane = ScriptedPlayer("random"), NamedLevel(name="crane", source=_CRANE)
    settings = Settings(attempts=5, physics="jax2d", seed=2)
    measured = _last(evaluate(player, [*LEVELS, crane], settings, segment=7)).results[3]
    for attempt in (0, 4):
        moments = list(record(player, crane, attempt, settings))
        assert moments[-1].result == measured.episodes[attempt]
        assert len(moments) == measured.episodes[attempt].length + 1
        assert moments[0].action is None and moments[1].action.shape == (6,)
    again = list(record(player, crane, 4, settings))
    for one, other in zip(moments, again, strict=True):
        positions = one.state.physics.position, other.state.physics.position
        np.testing.assert_array_equal(*positions)
