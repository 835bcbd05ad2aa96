"""Agents measured in the window: whose physics, which numbers are what, what exports tell."""

import dataclasses
import functools
import re

import numpy as np
import pytest
from imgui_bundle import imgui

from editor import actions
from editor.actions.evaluation.comparison import about_comparison, ask_comparison
from editor.actions.evaluation.save_table import save_table
from editor.actions.files import export
from editor.actions.watching import agents
from editor.agents.evaluation import Plan
from editor.agents.metrics import Metrics
from editor.base import language
from editor.base.prompts import FileQuestion
from editor.base.settings import Settings
from editor.play.mode import Mode
from editor.play.trace_files import read_trace, write_trace
from editor.session import Session
from editor.toolkit import widgets
from editor.window.file_choice import nothing_here
from editor.window.panels import evaluate
from editor.window.panels.training import title_of
from editor.worker.requests import (
    AttemptPaths,
    Ending,
    Evaluate,
    EvaluatedLevel,
    ExportFilm,
    RunNews,
    Score,
    Standing,
)
from kinetix.level.codec import level_hash, save_level
from kinetix.paths import checkpoints_dir, levels_dir
from tests.editor.core.test_gallery import playable
from tests.editor.core.test_viewer import a_result, a_summary
from tests.editor.gui.test_language import ALLOWED
from tests.editor.gui.viewing import front, settle


@pytest.fixture
def said(monkeypatch):
    """The words that widgets draw."""
    words = []
    for name in ("text", "muted", "small", "wrapped"):
        draw = getattr(widgets, name)
        monkeypatch.setattr(
            widgets, name, lambda one, *more, draw=draw: (words.append(one), draw(one, *more))
        )
    return words


def evaluated(gui):
    """The last evaluation that the worker was asked for, after a click on the button."""
    gui.click("evaluate.run")
    settle(gui)
    return [request for request in gui.stage.asked if isinstance(request, Evaluate)][-1]


def test_an_agent_is_measured_under_its_own_physics_and_the_table_says_which(with_agent, said):
    session = with_agent.session
    session.playback.physics = "fast"  # of the window; the agent was trained under jax2d
    front(with_agent, "evaluate")
    assert evaluated(with_agent).physics == ""
    assert session.viewer.evaluation.summary(0)["physics"] == "jax2d"
    assert any("Tester under jax2d: 0.500" in words for words in said)
    with_agent.click("evaluate.physics")
    with_agent.click("evaluate.physics.accurate")
    assert evaluated(with_agent).physics == "accurate"
    assert any("Tester under accurate: 0.500" in words for words in said)


def test_the_form_names_each_agent_that_is_measured_once(with_agent, said):
    viewer = with_agent.session.viewer
    viewer.contenders = (*viewer.agents, a_summary("Other"))
    front(with_agent, "evaluate")
    assert "Agents: Tester, Other" in said
    assert len(evaluated(with_agent).agents) == 2


def test_the_form_names_what_the_gallery_measures(with_agent):
    session = with_agent.session
    assert actions.run(session, "level.gallery")
    session.library.look([levels_dir() / "s"])
    assert session.library.wait(20)
    card = next(card for card in session.library.cards if card.path.endswith("hang_on.json"))
    session.gallery.selection = (card.path,)
    assert actions.run(session, "gallery.evaluate")
    settle(with_agent)
    with_agent.frames(4)
    # A second click measures the same levels, not the one in front.
    assert [level.name for level in evaluated(with_agent).levels] == ["s/hang_on"]


def test_every_number_of_the_form_has_its_name_beside_it(with_agent, monkeypatch):
    drawn = []
    label = evaluate._label
    monkeypatch.setattr(evaluate, "_label", lambda words: (label(words), drawn.append(words)))
    probe = widgets.probe

    def noted(session, name, **more):
        probe(session, name, **more)
        drawn.append(name)

    monkeypatch.setattr(widgets, "probe", noted)
    front(with_agent, "evaluate")
    for words, field in (("Attempts", "evaluate.attempts"), ("Seed", "evaluate.seed")):
        assert drawn[drawn.index(field) - 1] == words


def test_after_the_end_nobody_takes_over(with_agent):
    session = with_agent.session
    session.playback.simulator.ends_at = 5
    with_agent.key("f6")
    with_agent.frames(60)
    assert session.mode is Mode.ENDED
    with_agent.key("t")
    assert not session.viewer.by_hand
    told = [toast.text for toast in session.toasts]
    assert not any("You drive" in words for words in told)
    assert any(words.startswith("The episode is over") for words in told)
    with_agent.key("backspace")
    with_agent.frames(4)
    assert session.playback.snapshot.action[0] == -1.0  # the agent's, not the person's


def test_the_dialog_for_agents_speaks_of_agents(with_agent, said):
    agents.browse(with_agent.session, "a")
    with_agent.frames(6)
    assert any(words.startswith("Go into the folder of an agent") for words in said)
    assert not any("level" in words for words in said if "see it here" in words or "No " in words)
    with_agent.text(str(checkpoints_dir() / "goalkeeper"))  # the field takes a path
    with_agent.key("return")
    said.clear()
    with_agent.frames(6)
    assert any(words.startswith("Goalkeeper") for words in said)


def test_the_dialog_for_comparisons_speaks_of_comparisons(with_agent, said, tmp_path):
    gui, session = with_agent, with_agent.session
    front(gui, "evaluate")
    evaluated(gui)
    save_table(session, tmp_path / "mine.json")
    (tmp_path / "other.json").write_text("{}")
    ask_comparison(session)
    session.prompts[0] = dataclasses.replace(session.prompts[0], folder=tmp_path)
    said.clear()
    gui.frames(6)
    assert not any("level" in words and "see it" in words for words in said)
    for name, told in (("mine", "1 policy on 1 level.\n\nTester"), ("other", "This is no")):
        gui.click(f"browser.{name}.json")
        gui.frames(3)
        assert any(words.startswith(told) for words in said), name
    empty = FileQuestion(
        purpose="open", title="", folder=tmp_path, answer=print, about=about_comparison
    )
    assert nothing_here(empty) == "No folders and no .json files here."


def with_results(
    gui, *names, level=None, levels=("s/a", "s/b"), outcomes=("won", "lost"), first=()
):
    """Puts an evaluation that has ended on the screen; the first agent's outcomes may differ."""
    evaluation = gui.session.viewer.evaluation
    evaluation.plan = Plan(
        agents=tuple(map(a_summary, names)),
        levels=tuple(EvaluatedLevel(name=name, source=level or name) for name in levels),
        hashes=levels if level is None else (level_hash(level),) * len(levels),
        attempts=len(outcomes),
    )
    evaluation.standing = Standing(
        done=4,
        total=4,
        scores=tuple(
            Score(agent=agent, result=a_result(name, *(outcomes if agent else first or outcomes)))
            for agent in range(len(names))
            for name in levels
        ),
    )
    front(gui, "evaluate")


def test_a_table_of_one_agent_is_not_sorted_by_the_second_of_an_earlier_table(with_agent):
    gui = with_agent
    gui.host.endures = True
    with_results(gui, "Tester")
    with_results(gui, "Tester", "Other")
    cell = gui.probe("evaluate.s/a.1")
    gui.click_at(cell.low[0] + 20, cell.low[1] - (cell.high[1] - cell.low[1]))
    with_results(gui, "Tester")
    assert gui.shows("evaluate.s/a.0") and gui.shows("evaluate.s/b.0")
    assert not any("went wrong" in toast.text for toast in gui.session.toasts)


def test_a_table_of_more_agents_than_it_has_columns_shows_some_and_says_so(with_agent, said):
    with_results(with_agent, *(f"Agent {k}" for k in range(600)), levels=("s/a",))
    assert with_agent.shows("evaluate.s/a.0")
    assert "The table shows the first 200 of 600 agents; a saved one has all." in said


def test_all_mean_solve_rates_are_inside_a_small_window(make_gui, monkeypatch):
    gui = make_gui(session=Session(settings=Settings()), size=(640, 480))
    gui.frames(40)
    with_results(gui, "An agent of a long name", "Another one of a long name")
    ends = []

    def noted(draw, words, *more):
        edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
        draw(words, *more)
        if words.startswith("Mean solve rate"):
            ends.append((imgui.get_item_rect_max().x, edge))

    for name in ("text", "wrapped"):
        monkeypatch.setattr(widgets, name, functools.partial(noted, getattr(widgets, name)))
    gui.frames(1)
    ((end, edge),) = ends
    assert end <= edge + 1


def test_a_tie_is_not_called_a_lead(with_agent, said):
    with_results(with_agent, "One", "Two")
    (told,) = {words for words in said if " over " in words}
    assert told.startswith("No difference is certain. One: +0.00 (") and told.endswith("over Two")
    said.clear()
    lost = ("lost",) * 20
    with_results(with_agent, "One", "Two", outcomes=lost, first=("won",) * 20)
    (told,) = {words for words in said if " over " in words}
    assert told.startswith("One leads: +1.00 (")


def test_differences_are_in_one_language(with_agent, said):
    with_agent.session.settings.language = "de"
    try:
        with_results(with_agent, "One", "Two", "Three", "Four")
        (told,) = {language.tr(words) for words in said if "certain" in words}
    finally:
        language.use("en")
    assert told.startswith("Kein Unterschied ist sicher. Four: +0.00 (")
    assert told.count(" bis ") == told.count(" vor ") == 2 and " over " not in told
    assert told.endswith(", und 1 weitere")


def test_it_is_said_why_nothing_can_be_evaluated(viewer_gui, monkeypatch):
    told = {}
    monkeypatch.setattr(
        widgets, "tooltip", lambda title, detail="", *_, **__: told.update({title: detail})
    )
    front(viewer_gui, "evaluate")
    assert "Choose an agent first" in told["Evaluate"]
    viewer_gui.click("evaluate.noop")
    told.clear()
    viewer_gui.frames(2)
    assert "Evaluate" not in told


def test_the_ways_of_another_level_are_not_shown_for_its_attempts(with_agent):
    gui, session = with_agent, with_agent.session
    with_results(gui, "Tester", level=session.document.level)
    gui.stage.paths = AttemptPaths(
        level_hash=session.document.hash,
        step=np.arange(3),
        position=np.zeros((2, 3, 2), np.float32),
        outcomes=("won", "lost"),
        parting=2,
        endings=(Ending(outcome="lost", attempts=(1,), place=(1, 1), length=9, parting=3),),
    )
    gui.click("evaluate.s/a.0")
    gui.click("evaluate.ways")
    settle(gui)
    assert gui.shows("evaluate.ending.0")
    gui.click("evaluate.s/b.0")
    assert gui.shows("evaluate.attempt.1") and not gui.shows("evaluate.ending.0")
    gui.click("evaluate.attempt.1")
    settle(gui)
    assert session.playback.running  # It plays from the start: no parting of its own is known.
    # Another evaluation has neither ways nor a chosen result.
    with_results(gui, "Tester", level=session.document.level)
    assert session.viewer.ways is None and not gui.shows("evaluate.attempt.1")


def test_ways_are_forgotten_where_another_result_is_chosen(with_agent, monkeypatch):
    gui, session = with_agent, with_agent.session
    told = {}
    monkeypatch.setattr(
        widgets, "tooltip", lambda title, detail="", *_, **__: told.update({title: detail})
    )
    with_results(gui, "Tester", "Other", level=session.document.level)
    gui.stage.paths = AttemptPaths(
        level_hash=session.document.hash,
        step=np.arange(3),
        position=np.zeros((2, 3, 2), np.float32),
        outcomes=("won", "lost"),
        parting=2,
    )
    gui.click("evaluate.s/a.0")
    gui.click("evaluate.ways")
    settle(gui)
    gui.frames(2)
    assert session.viewer.ways_of(0, 0) is not None
    assert told["Hide Paths"] != told["Show Paths"]
    gui.click("evaluate.s/a.1")
    gui.frames(2)
    assert session.viewer.ways is None
    # Ways that come when another result is chosen already are not drawn over it.
    gui.click("evaluate.ways")
    gui.click("evaluate.s/a.0")
    settle(gui)
    gui.frames(2)
    assert session.viewer.ways is None


def compared(gui, suffix, path):
    """The file of an episode of two players, attempt 2 under seed 7, the likeliest actions."""
    session = gui.session
    for slot, name, digest in (("a", "Tester", "a" * 64), ("b", "Other", "b" * 64)):
        session.viewer.slots[slot].summary = a_summary(name, digest=digest)
    session.viewer.seed, session.viewer.attempt, session.viewer.deterministic = 7, 2, True
    session.viewer.compare = "side"
    gui.key("f6")
    gui.frames(30)
    trace, level = session.playback.trace, session.playback.level
    if suffix == ".npz":
        write_trace(trace, level, path)
    elif suffix == ".html":
        export.write_page(session, level, trace, path)
    else:
        export.film(session, level, trace, path)
        settle(gui)
    return trace, level


def test_a_shared_page_tells_whose_episodes_these_are(with_agent, tmp_path):
    compared(with_agent, ".html", tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert page.count("attempt 2, seed 7, likeliest actions") == 2
    for player in (f"Tester {'a' * 12}", f"Other {'b' * 12}"):
        assert player in page
    assert page.count('["physics","jax2d"]') == 2


def test_a_film_of_two_players_tells_whose_episodes_these_are(with_agent, tmp_path):
    compared(with_agent, ".gif", tmp_path / "a.gif")
    (request,) = [r for r in with_agent.stage.asked if isinstance(r, ExportFilm)]
    assert request.rival is not None
    for trace, name in ((request.trace, "Tester"), (request.rival, "Other")):
        assert (trace.player, trace.physics) == (name, "jax2d")
        assert (trace.seed, trace.attempt, trace.deterministic) == (7, 2, True)
        assert trace.digest[0] == ("a" if name == "Tester" else "b")


def test_a_stored_episode_tells_whose_it_is(with_agent, tmp_path):
    trace, _ = compared(with_agent, ".npz", tmp_path / "a.npz")
    stored = read_trace(tmp_path / "a.npz").trace
    for name in ("player", "physics", "seed", "attempt", "deterministic", "digest"):
        assert getattr(stored, name) == getattr(trace, name), name
    assert (stored.player, stored.digest, stored.seed) == ("Tester", "a" * 64, 7)


def test_titles_of_curves_name_the_level():
    metric = "eval_avg/hand_designed_episode_solve_rate_s/goalkeeper"
    assert title_of(metric) == "Solved s/goalkeeper"
    assert title_of("loss/entropy") == "loss/entropy"


def test_what_measures_speaks_german(with_agent):
    """Form, table, attempts, ways, curves and overlays: no word of the app's own is English."""
    gui, session = with_agent, with_agent.session
    session.settings.language = "de"
    session.viewer.slots["b"].summary = a_summary("Other", physics="fast", steps=1000)
    gui.stage.paths = AttemptPaths(
        level_hash=session.document.hash,
        step=np.arange(4) * 2,
        position=np.zeros((20, 4, 2), np.float32),
        outcomes=("won", "lost") * 10,
        parting=4,
        endings=(
            Ending(outcome="lost", attempts=tuple(range(1, 20)), place=(1, 1), length=1, parting=4),
            Ending(outcome="won", attempts=(0,), place=(1, 2), length=9, parting=None),
        ),
    )
    gui.stage.news = RunNews(
        rows=({"timing/num_env_steps": 10.0, "loss/entropy": 1.0},), total=1, newest=100
    )
    gui.click("menu.agent")
    gui.key("escape")
    front(gui, "agents")
    front(gui, "evaluate")
    evaluated(gui)
    gui.click(f"evaluate.{session.document.level.name}.0")
    gui.click("evaluate.ways")
    settle(gui)
    for name in ("evaluate.ending.0", "evaluate.attempt.3", "evaluate.save", "evaluate.more"):
        gui.move(*gui.probe(name).centre)
        gui.frames(30)
    for action in ("agent.watch_run", "file.share", "agent.choose_a"):
        actions.run(session, action)
        gui.frames(4)
        session.prompts.clear()
    session.viewer.run.path = "/runs/one"
    session.viewer.run.metrics = Metrics(gui.stage.news.rows)
    front(gui, "training")
    front(gui, "curriculum")
    session.viewer.compare = "side"
    session.playback.simulator.ends_at = session.viewer.rival.simulator.ends_at = 5
    gui.key("f6")
    gui.frames(60)
    spoken = language.spoken()
    assert spoken is not None
    known = re.compile(
        r"symbolic entity|multi discrete|entity transformer|Tester.*|Other.*|PPO.*|loss/.*"
    )
    english = [w for w in spoken.missing if not ALLOWED.fullmatch(w) and not known.fullmatch(w)]
    assert "\n".join(sorted(english)) == ""


def test_what_is_chosen_in_the_gallery_is_asked_when_evaluate_is_pressed(with_agent, tmp_path):
    gui, session = with_agent, with_agent.session
    folder = tmp_path / "levels"
    folder.mkdir()
    paths = [str(folder / f"{name}.json") for name in ("alpha", "beta")]
    for k, path in enumerate(paths):
        save_level(playable(f"Level {k}", 1.0 + k), path)
    session.library.look([folder])
    while session.library.busy:
        session.library.poll()
    front(gui, "evaluate")
    session.viewer.form.source = "chosen"
    gui.frames(3)
    gui.click("evaluate.run")
    settle(gui)
    assert session.toasts[-1].text == "Choose levels in the gallery first (Ctrl+G)."
    for path in paths:
        session.gallery.selection = (path,)
        (level,) = evaluated(gui).levels
        assert level.source == path
