"""One meaning of an outcome: every way to play an episode ends it alike."""

import dataclasses
import json

import numpy as np
import pytest

from kinetix.cli import main
from kinetix.environment import reset
from kinetix.environment.outcome import OUTCOMES, outcome_of
from kinetix.level.codec import save_level
from kinetix.level.model import Body, Circle, Level, Polygon, SizeHint

pytestmark = pytest.mark.slow

PLATE = Polygon(vertices=((0.5, 0.1), (-0.5, 0.1), (-0.5, -0.1), (0.5, -0.1)))
LIMIT = 30
GOALS = {"won": "blue", "lost": "red", "timeout": "none", "broken": "none"}


def falling(outcome: str) -> Level:
    """A green ball above a plate, onto which it falls by itself."""
    return Level(
        name=f"falling-{outcome}",
        size=SizeHint(polygons=5, circles=1, joints=0, thrusters=0),  # compiles in half the time
        max_timesteps=LIMIT,
        next_id=3,
        bodies=(
            Body(id=1, shape=Circle(radius=0.2), position=(2.5, 1.2), role="green"),
            Body(id=2, shape=PLATE, position=(2.5, 0.5), fixed=True, role=GOALS[outcome]),
        ),
    )


def breaking(level, static):
    """Start with a speed that is NaN."""
    state = plainly(level, static)
    physics = dataclasses.replace(
        state.physics, velocity=np.full_like(state.physics.velocity, np.nan)
    )
    return dataclasses.replace(state, physics=physics)


plainly = reset.level_state


@pytest.fixture(params=OUTCOMES)
def outcome(request, monkeypatch):
    if request.param == "broken":
        import editor.worker.simulation.stepping
        import kinetix.agents.evaluate
        import kinetix.environment.replay

        for module in (
            reset,
            kinetix.environment.replay,
            kinetix.agents.evaluate,
            editor.worker.simulation.stepping,
        ):
            monkeypatch.setattr(module, "level_state", breaking)
    return request.param


@pytest.fixture
def path(outcome, tmp_path):
    file = tmp_path / "level.json"
    save_level(falling(outcome), file)
    return file


def test_the_commands_agree(outcome, path, capsys):
    from kinetix.cli.render import Render, _film_of

    assert main(["play", str(path), "--json"]) == 0
    played = json.loads(capsys.readouterr().out)
    film = _film_of(Render(level=str(path), out=path.with_suffix(".html")), "noop")
    assert (played["outcome"], film.outcome) == (outcome, outcome)
    assert len(film.seconds) == played["steps"] + 1


def test_recorded_actions_agree(outcome):
    from kinetix.environment.replay import noop_outcome

    assert noop_outcome(falling(outcome)) == outcome


def test_the_evaluation_agrees(outcome, path):
    from kinetix.agents.evaluate import NamedLevel, Settings, evaluate, record
    from kinetix.agents.scripted import ScriptedPlayer

    player, level = ScriptedPlayer("noop"), NamedLevel(name="falling", source=falling(outcome))
    settings = Settings(attempts=1)
    *_, progress = evaluate(player, [level], settings)
    assert [one.outcome for one in progress.results[0].episodes] == [outcome]
    *_, last = record(player, level, 0, settings)
    assert last.result is not None and last.result.outcome == outcome


@pytest.mark.parametrize("casting", ["hand", "agent"])
def test_the_editor_agrees(outcome, casting):
    from editor.worker.requests import Advance, AgentRef, Casting, StartEpisode
    from editor.worker.simulation import perform
    from tests.editor.core.helpers import Unheard

    played_by = None if casting == "hand" else Casting(agent=AgentRef(path="noop"))
    start = StartEpisode(run=1, level=falling(outcome), physics="balanced", casting=played_by)
    perform(start, Unheard())
    action = (0,) * 6 if casting == "hand" else None
    *_, last = perform(Advance(run=1, actions=(action,) * LIMIT), Unheard())
    assert last.outcome == outcome


@pytest.mark.parametrize(
    ("flags", "expected"),
    [
        ("", None),
        ("GoalR terminated", "won"),
        ("terminated", "lost"),
        ("truncated", "timeout"),
        ("nan", "broken"),
        ("GoalR terminated nan", "won"),
        ("terminated nan", "lost"),
    ],
)
def test_a_touch_counts_before_a_breakdown(flags, expected):
    names = ("GoalR", "terminated", "truncated", "nan")
    assert outcome_of({name: np.bool_(name in flags.split()) for name in names}) == expected
