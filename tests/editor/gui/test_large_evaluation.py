"""A thousand attempts on a hundred levels by eight policies leave the window its frames."""

import statistics
import time

import pytest
from imgui_bundle import imgui

from editor.agents.evaluation import Plan
from editor.base.settings import Settings
from editor.session import Session
from editor.toolkit import widgets
from editor.worker.requests import EvaluatedLevel, Score, Standing
from kinetix.agents.results import EpisodeResult, LevelResult
from tests.editor.core.test_viewer import a_summary

POLICIES, LEVELS, ATTEMPTS = 8, 100, 1000


@pytest.fixture
def evaluated(make_gui):
    """Returns the app after such an evaluation, in a window of a size."""

    def make(size, levels=LEVELS, attempts=ATTEMPTS):
        gui = make_gui(session=Session(settings=Settings()), size=size)
        return _with_results(gui, levels, attempts)

    return make


def _with_results(gui, levels, attempts):
    session = gui.session
    gui.frames(40)
    won = EpisodeResult(outcome="won", total_reward=1.0, length=90)
    lost = EpisodeResult(outcome="lost", total_reward=-1.0, length=40)
    names = [f"set/level_{k}" for k in range(levels)]
    plan = Plan(
        agents=tuple(a_summary(f"/agents/{k}") for k in range(POLICIES)),
        levels=tuple(EvaluatedLevel(name=name, source=name) for name in names),
        hashes=tuple(str(k) * 4 for k in range(levels)),
        attempts=attempts,
    )
    scores = tuple(
        Score(
            agent=agent,
            result=LevelResult.of(
                name, [won if (k + agent + i) % (i % 7 + 2) else lost for i in range(attempts)]
            ),
        )
        for agent in range(POLICIES)
        for k, name in enumerate(names)
    )
    evaluation = session.viewer.evaluation
    evaluation.plan = plan
    total = POLICIES * levels * attempts
    evaluation.standing = Standing(done=total, total=total, scores=scores)
    session.view.front = "evaluate"
    gui.frames(20)
    return gui


def test_the_heads_of_a_heat_map_are_the_agents_and_its_first_row_the_means(
    evaluated, monkeypatch
) -> None:
    gui = evaluated((1024, 640))
    heads, words = [], []
    draw_head, draw_text = imgui.table_header, widgets.text
    monkeypatch.setattr(imgui, "table_header", lambda one: (heads.append(one), draw_head(one)))
    monkeypatch.setattr(
        widgets, "text", lambda one, *more: (words.append(one), draw_text(one, *more))
    )
    gui.frames(1)
    assert [head.split("###")[0][-2:] for head in heads[1:]] == [f"/{k}" for k in range(POLICIES)]
    means = [gui.session.viewer.evaluation.summary(k)["mean_solve_rate"] for k in range(POLICIES)]
    assert [f"{mean:.3f}" for mean in means[:3]] == [w for w in words if w[:2] == "0."][:3]
    # In a small window it scrolls sideways; no cell is narrower than what it says.
    cell = gui.session.probe["evaluate.set/level_0.0"]
    assert cell.high[0] - cell.low[0] >= 50


def test_the_table_of_a_large_evaluation_costs_no_more_a_frame_than_a_small_one(evaluated) -> None:
    """Results that stay the same are summed up once, and only what is in sight is drawn."""
    few, many = evaluated((1600, 1000), levels=30, attempts=200), evaluated((1600, 1000))
    small, large = [], []
    for gui in (few, many):
        gui.click("evaluate.set/level_0.0")
        gui.frames(5)
    for _ in range(60):  # By turns: a machine that slows down slows both.
        small.append(_processor_time_of_a_frame(few))
        large.append(_processor_time_of_a_frame(many))
    assert statistics.median(large) < 1.5 * statistics.median(small)


def _processor_time_of_a_frame(gui):
    began = time.thread_time()
    gui.frames(1)
    return time.thread_time() - began
