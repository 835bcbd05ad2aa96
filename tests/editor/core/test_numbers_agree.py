"""One evaluation said five ways: the app's table, two commands, and the files of all three."""

import csv
import io
import json
import re

import pytest

from editor.actions.evaluation import comparison
from editor.actions.evaluation.save_table import save_table
from editor.agents.evaluation import Plan, bare_summary
from editor.session import Session
from editor.worker.requests import (
    AgentRef,
    Casting,
    Evaluate,
    EvaluatedLevel,
    LoadAgent,
    OpenEpisode,
)
from editor.worker.trace_pages import film_of_trace
from kinetix.level.codec import level_hash, load_level
from kinetix.pages.film import packed
from kinetix.paths import checkpoints_dir, levels_dir
from tests.editor.core.helpers import Unheard

pytestmark = pytest.mark.slow(seconds=120)

KEEPER = str(checkpoints_dir() / "goalkeeper")
LEVELS = ("s/goalkeeper", "s/hang_on")
ATTEMPTS = 4
NUMBERS = ("solve_rate", "low", "high", "mean_return", "mean_length")


class Sharing(Unheard):
    def share(self, partial):
        """Nobody looks."""


@pytest.fixture(scope="module")
def app():
    """A session whose evaluation of two agents on two levels is done."""
    from editor.worker import simulation

    session = Session()
    levels = tuple(
        EvaluatedLevel(name=name, source=str(levels_dir() / f"{name}.json")) for name in LEVELS
    )
    keeper = simulation.perform(LoadAgent(path=KEEPER), Sharing())
    plan = Plan(
        agents=(keeper, bare_summary("random")),
        levels=levels,
        hashes=tuple(level_hash(load_level(name)) for name in LEVELS),
        attempts=ATTEMPTS,
    )
    request = Evaluate(
        agents=tuple(agent.ref for agent in plan.agents),
        levels=levels,
        attempts=ATTEMPTS,
        seed=0,
        physics="",
        deterministic=False,
    )
    evaluation = session.viewer.evaluation
    evaluation.plan = plan
    evaluation.standing = simulation.perform(request, Sharing())
    yield session
    session.worker.stop()
    session.evaluator.stop()


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """The folder in which `kinetix compare` wrote the same as .json, .csv and .html."""
    from kinetix.cli import main

    folder = tmp_path_factory.mktemp("compared")
    for suffix in ("json", "csv", "html"):
        words = ["compare", "--agents", KEEPER, "random", "--levels", *LEVELS]
        words += ["--attempts", str(ATTEMPTS), "--out", str(folder / f"table.{suffix}")]
        assert main(words) == 0
    return folder


def shown(session):
    """The numbers of the table on the screen, by agent and level."""
    return {
        (agent, row.name): {name: row.results[agent].as_dict()[name] for name in NUMBERS}
        for row in session.viewer.evaluation.rows()
        for agent in range(2)
    }


def of_lines(lines, agent):
    return {
        (agent, line["level"]): {name: line[name] for name in NUMBERS}
        for line in lines
        if "level" in line
    }


@pytest.mark.parametrize(("agent", "name"), [(0, KEEPER), (1, "random")])
def test_the_table_is_what_kinetix_eval_says(app, capsys, agent, name):
    from kinetix.cli import main

    command = ["eval", "--agent", name, "--levels", *LEVELS, "--attempts", str(ATTEMPTS), "--json"]
    assert main(command) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    table = {key: row for key, row in shown(app).items() if key[0] == agent}
    assert of_lines(lines, agent) == table
    assert lines[-1] == app.viewer.evaluation.summary(agent)


def test_the_saved_lines_and_the_saved_sheet_say_the_same(app, tmp_path):
    save_table(app, tmp_path / "table.jsonl")
    lines = [json.loads(line) for line in (tmp_path / "table.jsonl").read_text().splitlines()]
    half = len(lines) // 2
    assert of_lines(lines[:half], 0) | of_lines(lines[half:], 1) == shown(app)
    save_table(app, tmp_path / "table.csv")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "table.csv").read_text())))
    read = {
        (k // len(LEVELS), row["level"]): {name: float(row[name]) for name in NUMBERS}
        for k, row in enumerate(rows)
    }
    assert read == shown(app)


def test_the_files_of_kinetix_compare_are_the_apps_to_the_byte(app, compared, tmp_path):
    for suffix in (".json", ".html"):
        save_table(app, tmp_path / f"table{suffix}")
        mine, theirs = ((folder / f"table{suffix}").read_bytes() for folder in (tmp_path, compared))
        assert mine == theirs, suffix
    sheet = list(csv.DictReader(io.StringIO((compared / "table.csv").read_text())))
    rates = [row["solve_rate"] for key, row in sorted(shown(app).items())]
    assert sorted(float(row["solve_rate"]) for row in sheet) == sorted(rates)


def test_one_attempt_is_the_same_in_the_app_by_command_and_as_a_page(app, capsys, tmp_path):
    from editor.worker import simulation
    from kinetix.cli import main

    attempt, (level, _) = 2, app.viewer.evaluation.plan.levels
    told = app.viewer.evaluation.results(1)[0].episodes[attempt]
    words = [level.name, "--agent", "random", "--attempt", str(attempt)]
    assert main(["play", *words, "--json"]) == 0
    played = json.loads(capsys.readouterr().out)
    assert (played["steps"], played["outcome"]) == (told.length, told.outcome)
    assert played["return"] == round(told.total_reward, 6)
    casting = Casting(agent=AgentRef(path="random"), attempt=attempt)
    request = OpenEpisode(level=level, casting=casting, physics="balanced")
    opened = simulation.perform(request, Sharing())
    last = opened.trace.snapshots[-1]
    assert (last.step, last.outcome) == (told.length, told.outcome)
    assert last.total_reward == pytest.approx(told.total_reward, abs=1e-5)
    # Page and film show these very poses, and say which attempt it is.
    assert main(["render", *words[:1], str(tmp_path / "a.html"), *words[1:]]) == 0
    data = re.search(r'id="data">(.*?)</script>', (tmp_path / "a.html").read_text(), re.S)
    (film,) = json.loads(data[1])["films"]
    mine = packed(film_of_trace(opened.trace, opened.level))
    assert film["outcome"] == told.outcome
    for name in ("start", "moving", "shown", "places", "angles"):
        assert film[name] == mine[name], name
    assert film["facts"] == [list(fact) for fact in mine["facts"]]
    assert ["draws", "attempt 2, seed 0, actions drawn from the policy"] in film["facts"]


def test_the_file_opened_again_shows_the_same_table(app, compared):
    other = Session()
    assert comparison.open_comparison(other, compared / "table.json")
    assert shown(other) == shown(app)
    assert other.viewer.evaluation.differences() == app.viewer.evaluation.differences()
    other.worker.stop()
    other.evaluator.stop()
