"""The viewer's panels under headless imgui: buttons, fields, table, timeline, plots."""

import dataclasses
import json

import numpy as np
import pytest
from imgui_bundle import imgui, implot

from editor import actions
from editor.actions.evaluation import measure
from editor.actions.evaluation.save_table import save_table
from editor.actions.files import export
from editor.actions.watching import agents, watch
from editor.agents.evaluation import Plan, bare_summary
from editor.agents.metrics import Metrics
from editor.base.prompts import Choice, FileQuestion, MenuQuestion
from editor.drawing import agent_overlay
from editor.drawing.agent_overlay import most_entropy, value_range
from editor.drawing.futures_overlay import futures_of, outlook, paint_futures
from editor.play.mode import Mode
from editor.toolkit.widgets import px
from editor.window import canvas, play_side
from editor.window.file_choice import nothing_here
from editor.window.panels import timeline
from editor.window.panels.results_table import end_of
from editor.window.panels.timeline import marks_of
from editor.worker.requests import (
    AgentRef,
    AttemptPaths,
    EvaluatedLevel,
    ExportFilm,
    LoadAgent,
    RunNews,
    Score,
    Standing,
)
from editor.worker.snapshots import Futures, Mind
from kinetix.agents.compare import leaderboard
from kinetix.paths import checkpoints_dir
from tests.editor.core.helpers import a_level
from tests.editor.core.test_viewer import a_result, a_summary, a_trace
from tests.editor.gui.viewing import front, settle


@pytest.fixture
def gui(viewer_gui):
    return viewer_gui


def test_an_agent_is_chosen_from_the_panel_and_plays(gui):
    front(gui, "agents")
    gui.click("agents.choose.a")
    gui.stage.agents["random"] = a_summary("random")
    gui.click("list.random")
    settle(gui)
    assert any(request == LoadAgent(path="random") for request in gui.stage.asked)
    gui.click("agents.play")
    gui.frames(10)
    assert gui.session.mode is Mode.PLAYING
    assert gui.session.playback.player == "random"


def test_every_row_of_the_agent_menu_is_on_the_screen(with_agent):
    with_agent.click("menu.agent")
    for name in ("run.play_agent", "agent.choose_b", "level.evaluate", "agent.watch_run"):
        assert with_agent.shows(f"menu.{name}")


def test_overlays_are_switched_and_kept(with_agent):
    front(with_agent, "agents")
    with_agent.click("agents.overlay.heat")
    assert with_agent.session.settings.agent_overlay == ["numbers", "futures"]
    with_agent.click("agents.overlay.heat")
    assert with_agent.session.settings.agent_overlay == ["numbers", "futures", "heat"]


def test_the_timeline_scrubs_and_its_buttons_work(with_agent):
    session = with_agent.session
    with_agent.key("f6")
    front(with_agent, "timeline")
    with_agent.frames(60)
    low, high = (with_agent.probe("timeline.track").low, with_agent.probe("timeline.track").high)
    with_agent.click_at(low[0] + 0.5 * (high[0] - low[0]), (low[1] + high[1]) / 2)
    assert session.mode is Mode.REPLAY
    middle = session.playback.replay_index
    assert middle == pytest.approx((len(session.playback.moments) - 1) / 2, abs=1)
    with_agent.click("timeline.run.step")
    assert session.playback.replay_index == middle + 1
    with_agent.click("timeline.run.loop_from")
    assert session.playback.loop is not None
    with_agent.click("timeline.run.start_here")
    assert session.mode is Mode.PAUSED


def test_a_click_in_a_plot_moves_the_timeline(with_agent):
    with_agent.key("f6")
    with_agent.frames(90)
    front(with_agent, "plots")
    place = with_agent.probe("plots.Reward")
    with_agent.click_at(place.low[0] + 0.5 * (place.high[0] - place.low[0]), place.centre[1])
    assert with_agent.session.mode is Mode.REPLAY
    index = with_agent.session.playback.replay_index
    assert 0 < index < len(with_agent.session.playback.moments) - 1


def test_marks_tell_contacts_changes_and_the_end():
    snapshots = list(a_trace(5).snapshots)
    snapshots[2] = dataclasses.replace(snapshots[2], touching=((1, "floor"),))
    snapshots[3] = dataclasses.replace(snapshots[3], action=(1.0, 0, 0, 0, 0, 0))
    snapshots[5] = dataclasses.replace(snapshots[5], outcome="won")
    marks = {(mark.index, mark.kind) for mark in marks_of(snapshots, {0: "motor 0"})}
    assert {(2, "contact"), (3, "flip"), (4, "flip"), (5, "end")} <= marks
    assert (5, "contact") not in marks


def test_changes_of_controls_that_the_level_lacks_are_no_marks():
    snapshots = list(a_trace(3).snapshots)
    snapshots[2] = dataclasses.replace(snapshots[2], action=(1.0, 0, 0, 0, 0, 0))
    snapshots[3] = dataclasses.replace(snapshots[3], action=(0.0, 0, 0, 0, 0, 1))
    (mark,) = [m for m in marks_of(snapshots, {5: "thruster 1"}) if m.kind == "flip"]
    assert (mark.index, mark.words) == (3, "the action changes: thruster 1")


def test_the_timeline_and_the_canvas_show_the_same_step(with_agent, monkeypatch):
    words = []
    show = timeline.widgets.text
    monkeypatch.setattr(timeline.widgets, "text", lambda w, *a: (words.append(w), show(w, *a)))
    with_agent.key("f6")
    front(with_agent, "timeline")
    for _ in range(6):
        words.clear()
        with_agent.frames(1)
        step = with_agent.session.playback.step_count
        assert any(word.startswith(f"step {step} of ") for word in words)


def test_the_bars_of_the_plate_are_as_long_as_their_numbers_need():
    assert (value_range(0.3), value_range(1.2), value_range(2.01)) == (1.0, 1.5, 2.5)
    assert most_entropy((0, 5)) == pytest.approx(np.log(3) + np.log(2))


def test_what_the_agent_thinks_and_the_ghost_are_drawn_without_error(with_agent):
    session = with_agent.session
    with_agent.key("f6")
    with_agent.frames(20)
    mind = Mind(
        intention=(0.5, -0.5, 0.0, 0.0, 1.0, 0.0),
        own_action=(1.0, -1.0, 0.0, 0.0, 1.0, 0.0),
        value=-0.4,
        entropy=2.0,
        by_hand=True,
    )
    shown = dataclasses.replace(
        session.playback.snapshot,
        mind=mind,
        motor=np.ones(1, np.float32),
        thruster=np.ones(1, np.float32),
    )
    session.playback.pause()
    session.viewer.slots["b"].summary = a_summary("Other")
    for kind in ("ghost", "side", "off"):
        session.viewer.compare = kind
        session.playback.current.snapshot = shown
        with_agent.frames(4)
    session.playback.failure = "The physics broke down at step 3."
    with_agent.frames(3)
    assert not session.log.lines[-1].startswith("Traceback")
    assert not [toast for toast in session.toasts if toast.kind == "error"]


def a_fan(*ends):
    ways = np.linspace((1.0, 1.0), (3.0, 2.0), 32)[None].repeat(len(ends), axis=0)
    ways[:, :, 1] += np.linspace(0, 1, len(ends))[:, None]
    return Futures(ways=ways, ends=ends, steps=tuple(range(20, 20 + len(ends))))


def test_the_futures_of_a_planner_are_drawn_and_can_be_switched_off(with_agent, monkeypatch):
    session = with_agent.session
    with_agent.key("f6")
    with_agent.frames(20)
    drawn = []
    monkeypatch.setattr(
        "editor.window.canvas.paint_futures",
        lambda painter, snapshot: drawn.append(1) or paint_futures(painter, snapshot),
    )
    session.playback.pause()
    for futures in (a_fan("won", "", "lost"), a_fan("", ""), a_fan("lost"), None):
        mind = Mind(
            intention=(0.0,) * 6,
            own_action=(0.0,) * 6,
            value=0.0,
            entropy=0.0,
            scripted=True,
            futures=futures,
        )
        session.playback.current.snapshot = dataclasses.replace(
            session.playback.snapshot, mind=mind
        )
        with_agent.frames(3)
    assert drawn
    assert not session.log.lines[-1].startswith("Traceback")
    mind = dataclasses.replace(mind, futures=a_fan("won"))
    ahead = dataclasses.replace(session.playback.snapshot, mind=mind)
    assert futures_of(ahead) is mind.futures
    assert futures_of(dataclasses.replace(ahead, outcome="won")) is None
    session.settings.agent_overlay = ["heat", "numbers"]
    drawn.clear()
    with_agent.frames(3)
    assert not drawn


@pytest.mark.parametrize(("size", "shown"), [((1600, 1000), True), ((340, 1000), False)])
def test_the_plate_covers_no_narrow_canvas(with_agent, monkeypatch, size, shown):
    drawn = []
    monkeypatch.setattr(canvas, "paint_numbers", lambda *_, **__: drawn.append(1))
    with_agent.host.size = size
    with_agent.key("f6")
    with_agent.frames(20)
    assert bool(drawn) is shown


@pytest.mark.parametrize("compare", ["off", "side"])
def test_the_plate_stands_at_the_right_of_its_players_arena(with_agent, monkeypatch, compare):
    session, plates = with_agent.session, []
    monkeypatch.setattr(canvas, "paint_numbers", lambda *args, room: plates.append((args[2], room)))
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = compare
    with_agent.key("f6")
    with_agent.frames(20)
    edge = session.camera.origin[0] + session.camera.size[0]  # of its part of the canvas
    nearest = session.camera.to_screen((5.0, 5.0))
    (right, _), room = plates[-1]
    assert 0 < edge - right < 15
    assert 0 < edge - nearest[0] - room.beside < 30
    assert 0 < room.across < session.camera.size[0]
    assert abs(session.camera.origin[1] + room.above - nearest[1]) < 15


@pytest.mark.parametrize("size", [(1280, 800), (800, 600), (720, 500)])
def test_the_bars_of_the_plate_can_be_read(with_agent, monkeypatch, size):
    session, bars = with_agent.session, []
    bar = agent_overlay._Row.bar
    monkeypatch.setattr(agent_overlay._Row, "bar", lambda row: bars.append(bar(row)) or bars[-1])
    with_agent.host.size = size
    with_agent.key("f6")
    with_agent.frames(20)
    mind = Mind(intention=(0.0,) * 6, own_action=(0.0,) * 6, value=0.4, entropy=1.0)
    session.playback.pause()
    session.playback.current.snapshot = dataclasses.replace(session.playback.snapshot, mind=mind)
    with_agent.frames(3)
    assert bars
    assert min(right - left for left, right, _ in bars) >= px(60)


def test_the_plate_says_what_the_plan_leads_to():
    assert outlook(a_fan("won", "lost")) == "plans: a win 20 steps ahead"
    assert "no win" in outlook(a_fan("", "won"))
    assert "no way out" in outlook(a_fan("lost", "lost"))


def test_one_half_becomes_all_beside_panels_that_came_meanwhile(with_agent):
    session = with_agent.session
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = "side"
    with_agent.key("f6")
    with_agent.frames(6)
    with_agent.key("f8")
    with_agent.frames(8)
    session.viewer.compare = "off"
    with_agent.frames(8)
    camera = session.camera
    (left, top), (width, height) = camera.origin, camera.size
    for corner in ((0.0, 0.0), (5.0, 5.0)):
        x, y = camera.to_screen(corner)
        assert left <= x <= left + width and top <= y <= top + height


def test_the_camera_comes_back_after_side_by_side(with_agent):
    session = with_agent.session
    session.viewer.slots["b"].summary = a_summary("Other")
    before = session.camera
    session.viewer.compare = "side"
    with_agent.key("f6")
    with_agent.frames(6)
    assert session.camera.size[0] < before.size[0]
    with_agent.key("escape")
    with_agent.frames(4)
    assert (session.camera.zoom, session.camera.centre) == (before.zoom, before.centre)
    assert session.camera.size == before.size


@pytest.mark.parametrize(
    ("compare", "told"),
    [
        ("side", [("won", "after 5 steps"), ("lost", "after 8 steps")]),
        ("ghost", [("lost", "Other: won after 5 steps")]),
    ],
)
def test_each_of_two_players_has_its_own_verdict(with_agent, monkeypatch, compare, told):
    session = with_agent.session
    mine, theirs = session.playback.simulator, session.viewer.rival.simulator
    mine.ends_at, mine.ends, theirs.ends_at, theirs.ends = 8, "lost", 5, "won"
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = compare
    shown = []
    draw = play_side.write_verdict

    def verdict(column, outcome, details):
        shown.append((outcome, details[-1]))
        draw(column, outcome, details)

    monkeypatch.setattr(play_side, "write_verdict", verdict)
    with_agent.key("f6")
    with_agent.frames(60)
    assert session.mode is Mode.ENDED
    shown.clear()
    with_agent.frames(1)
    assert [outcome for outcome, _ in shown] == [outcome for outcome, _ in told]
    for (_, detail), (_, words) in zip(shown, told, strict=True):
        assert detail.startswith(words)


@pytest.mark.parametrize("size", [(1600, 1000), (640, 480)])
def test_what_is_said_of_the_end_covers_no_more_than_a_third_of_an_arena(
    with_agent, monkeypatch, size
):
    session, plates = with_agent.session, []
    session.playback.simulator.ends_at = session.viewer.rival.simulator.ends_at = 5
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = "side"
    underlay = play_side._Column.underlay

    def noted(column, top):
        plates.append((column.reach[0] - column.x) * (column.reach[1] - top))
        underlay(column, top)

    monkeypatch.setattr(play_side._Column, "underlay", noted)
    with_agent.host.size = size
    with_agent.key("f6")
    with_agent.frames(60)
    assert session.mode is Mode.ENDED
    left, right = (session.camera.to_screen((x, 0.0))[0] for x in (0.0, 5.0))
    assert max(plates[-2:]) < (right - left) ** 2 / 3


def test_it_is_said_in_its_half_how_far_the_second_player_is_that_plays_on(with_agent, monkeypatch):
    session = with_agent.session
    session.playback.simulator.ends_at = 5
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = "side"
    written = []
    lines = play_side._Column.lines

    def noted(column, words, *style):
        written.append((column.x, words))
        lines(column, words, *style)

    monkeypatch.setattr(play_side._Column, "lines", noted)
    with_agent.key("f6")
    with_agent.frames(60)
    assert session.mode is Mode.ENDED
    middle = session.camera.origin[0] + session.camera.size[0]
    theirs = [words for x, words in written if x > middle]
    steps = [int(words.split()[4]) for words in theirs if words.startswith("Other goes on: step")]
    assert len(set(steps)) > 5 and steps[-1] > 8


def test_the_second_half_shows_the_level_until_the_second_player_is_ready(with_agent, monkeypatch):
    session, drawn, said = with_agent.session, [], []
    rival = session.viewer.rival
    monkeypatch.setattr(rival.simulator, "take", list)  # it is being compiled
    monkeypatch.setattr(canvas, "paint_level", lambda painter, where, **_: drawn.append(where))
    monkeypatch.setattr(canvas, "paint_reason", lambda *words: said.append(words[2:]))
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = "side"
    with_agent.key("f6")
    with_agent.frames(30)
    drawn.clear()
    with_agent.frames(1)
    assert rival.waiting and len(drawn) == 2
    assert drawn[1].level == session.playback.level and not said
    assert session.playback.step_count == 0  # the first player waits for it
    rival.failure = "No memory."
    with_agent.frames(1)
    assert said == [("It cannot play", "No memory.")]
    with_agent.frames(10)
    assert session.playback.step_count > 0


def test_a_clip_of_two_players_films_both(with_agent, tmp_path):
    session = with_agent.session
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = "side"
    with_agent.key("f6")
    with_agent.frames(30)
    trace, level = session.playback.trace, session.playback.level
    export.film(session, level, trace, tmp_path / "a.gif")
    settle(with_agent)
    (request,) = [r for r in with_agent.stage.asked if isinstance(r, ExportFilm)]
    assert request.rival.player == "Other"
    assert len(request.rival.snapshots) > 5


def test_any_number_of_agents_is_compared_and_saved_as_a_page(with_agent, tmp_path):
    session = with_agent.session
    for name in ("one", "two"):
        with_agent.stage.agents[f"/agents/{name}"] = a_summary(name)
        measure.add_contender(session, f"/agents/{name}")
    settle(with_agent)
    assert [agent.name for agent in session.viewer.contenders] == ["one", "two"]
    with_agent.stage.evaluate = _as_good_as_their_number
    front(with_agent, "evaluate")
    with_agent.click("evaluate.run")
    settle(with_agent)
    name = session.document.level.name
    assert with_agent.shows(f"evaluate.{name}.2")
    board = leaderboard(session.viewer.evaluation.contenders())
    assert [row["label"] for row in board] == ["two", "one", "Tester"]
    for suffix in (".html", ".json"):
        save_table(session, tmp_path / f"table{suffix}")
    page = (tmp_path / "table.html").read_text()
    assert page.index(">two<") < page.index(">one<") < page.index(">Tester<")
    stored = json.loads((tmp_path / "table.json").read_text())
    assert stored["format"] == "kinetix-comparison"
    assert stored["differences"][0]["levels"] == 1


def _as_good_as_their_number(request, progress):
    (level,) = request.levels
    total = request.attempts
    scores = tuple(
        Score(agent=k, result=a_result(level.name, *["won"] * k, *["lost"] * (total - k)))
        for k in range(len(request.agents))
    )
    return Standing(done=1, total=1, scores=scores)


def test_the_checkpoints_of_a_run_are_in_order(tmp_path):
    for step in ("100", "20", "x", "3"):
        (tmp_path / "checkpoints" / step).mkdir(parents=True)
    assert [path.name for path in measure.steps_in(tmp_path)] == ["3", "20", "100"]
    assert measure.steps_in(tmp_path / "gone") == []


def test_of_a_run_with_very_many_checkpoints_some_are_measured(tmp_path):
    steps = [tmp_path / str(step) for step in range(1023)]
    some = measure.spread(steps)
    assert len(set(some)) == measure.MOST_CHECKPOINTS
    assert (some[0], some[-1]) == (steps[0], steps[-1])
    assert measure.spread(steps[:40]) == steps[:40]


def test_runs_are_drawn_beside_each_other_smoothed_and_as_a_band(gui):
    session, viewer = gui.session, gui.session.viewer
    name = "eval_avg/hand_designed_episode_solve_rate_s/goalkeeper"
    row = {"timing/num_env_steps": 10.0, "loss/entropy": 1.0, name: 0.5}
    gui.stage.news = RunNews(rows=(row, row | {name: 0.7}), total=2, newest=None)
    watch.watch_run(session, "/runs/one")
    watch.add_run(session, "/runs/two")
    watch.add_run(session, "/runs/one")  # is there already
    (other,) = viewer.other_runs
    settle(gui)
    assert len(other.metrics) == len(viewer.run.metrics) == 2
    front(gui, "training")
    assert gui.shows(f"training.plot.{name}")  # so few levels are shown at once
    gui.click("training.log")
    gui.click("training.band")
    gui.frames(4)
    assert not [toast for toast in session.toasts if toast.kind == "error"]
    gui.click("training.drop.1")
    gui.frames(3)
    assert viewer.other_runs == ()


def a_run(gui, values):
    rows = [{"timing/num_env_steps": float(k), "timing/sps": v} for k, v in enumerate(values)]
    gui.stage.news = RunNews(rows=tuple(rows), total=len(rows), newest=None)
    watch.watch_run(gui.session, "/runs/one")
    settle(gui)
    front(gui, "training")


def test_the_metrics_to_choose_from_are_one_line_each(gui):
    a_run(gui, [1.0])
    gui.click("training.metrics")
    gui.frames(3)
    box = gui.probe("training.metric.timing/sps")
    assert box.high[1] - box.low[1] <= 1.1 * imgui.get_frame_height()


def test_a_logarithmic_axis_reaches_from_the_least_to_the_greatest(gui, monkeypatch):
    ends = []
    end_plot = implot.end_plot

    def noted():
        ends.append(implot.get_plot_limits().y)
        end_plot()

    a_run(gui, [3.0, 8000.0, 7000.0])
    gui.click("training.log")
    monkeypatch.setattr(implot, "end_plot", noted)
    gui.frames(3)
    assert ends and 1.0 <= ends[-1].min <= 3.0 and ends[-1].max < 1e5


def test_the_ways_of_attempts_are_drawn_and_open_where_they_part(with_agent):
    session = with_agent.session
    front(with_agent, "evaluate")
    with_agent.click("evaluate.run")
    settle(with_agent)
    name = session.document.level.name
    with_agent.click(f"evaluate.{name}.0")
    with_agent.stage.paths = AttemptPaths(
        level_hash=session.document.hash,
        step=np.arange(4) * 2,
        position=np.random.default_rng(0).uniform(0, 5, (20, 4, 2)).astype(np.float32),
        outcomes=("won", "lost") * 10,
        parting=4,
    )
    with_agent.click("evaluate.ways")
    settle(with_agent)
    assert session.viewer.ways.paths is with_agent.stage.paths
    with_agent.frames(3)
    assert not [toast for toast in session.toasts if toast.kind == "error"]
    with_agent.click("evaluate.ways.lost")
    assert session.viewer.ways.outcomes == ("won",)
    with_agent.click("evaluate.attempt.1")
    settle(with_agent)
    assert session.mode is Mode.REPLAY
    assert (session.playback.replay_index, session.playback.running) == (4, False)
    with_agent.key("escape")
    with_agent.frames(3)
    front(with_agent, "evaluate")
    with_agent.click("evaluate.ways")
    assert session.viewer.ways is None


def test_an_episode_is_shared_as_a_page_with_both_players(with_agent, tmp_path):
    session = with_agent.session
    session.viewer.slots["b"].summary = a_summary("Other")
    session.viewer.compare = "side"
    with_agent.key("f6")
    with_agent.frames(30)
    assert actions.run(session, "file.share")
    session.prompts.pop().answer(tmp_path / "shared.html")
    page = (tmp_path / "shared.html").read_text()
    assert '"title":"Tester"' in page
    assert '"title":"Other"' in page
    assert "attempt 0, seed 0, actions drawn from the policy" in page
    assert len(page.encode()) < 200_000


def test_the_end_of_a_name_is_shown_where_there_is_no_room_for_all(gui):
    name = "published/l/h17_thrustcontrol_left"
    assert end_of(name, 10_000) == name
    shown = end_of(name, 120)
    assert shown.startswith("…")
    assert name.endswith(shown[1:])
    assert 5 < len(shown) < len(name)


def test_a_level_that_is_too_large_is_not_offered_to_be_played(with_agent):
    front(with_agent, "agents")
    flat = a_summary(any_size=False, capacity=(5, 1, 1, 1))
    with_agent.session.viewer.slots["a"].summary = flat
    with_agent.frames(3)
    with_agent.click("agents.play")
    with_agent.frames(5)
    assert with_agent.session.mode is Mode.EDIT


def test_return_takes_the_first_agent_of_the_list(gui):
    session = gui.session
    actions.run(session, "agent.choose_a")
    gui.frames(4)
    (prompt,) = session.prompts
    chosen = []
    session.prompts[0] = dataclasses.replace(prompt, answer=chosen.append)
    gui.frames(4)
    gui.key("return")
    gui.frames(4)
    assert chosen == [prompt.choices[0].id]


def an_open_list(gui, at=None):
    """A list with three rows, and the ids that were answered."""
    chosen = []
    rows = (("general", "General"), ("noop", "Does nothing (noop)"), ("planner", "Planner"))
    choices = tuple(Choice(id=name, label=label) for name, label in rows)
    gui.session.ask(MenuQuestion(title="Agents", choices=choices, at=at, answer=chosen.append))
    gui.frames(4)
    return chosen


@pytest.mark.parametrize(
    ("keys", "words", "taken"),
    [
        ((), "", "general"),
        (("down",), "", "noop"),
        (("up",), "", "planner"),
        (("end", "down", "down"), "", "noop"),
        ((), "pl", "planner"),
        ((), "noop", "noop"),
        (("down",), "xyz", "noop"),
    ],
)
def test_return_takes_the_row_of_a_list_that_keys_have_chosen(gui, keys, words, taken):
    chosen = an_open_list(gui)
    for key in keys:
        gui.key(key)
    for letter in words:
        gui.text(letter)
    gui.key("return")
    gui.frames(4)
    assert chosen == [taken]


def test_a_pointer_chooses_a_row_where_it_moves_and_not_where_it_lies(gui):
    chosen = an_open_list(gui)
    x, y = gui.probe("list.planner").centre
    gui.key("escape")
    gui.move(x, y)
    gui.frames(3)
    again = an_open_list(gui)  # under the pointer
    gui.key("return")
    gui.frames(4)
    assert (chosen, again) == ([None], ["general"])
    once_more = an_open_list(gui)
    gui.move(x + 3, y)
    gui.key("return")
    gui.frames(4)
    assert once_more == ["planner"]


def test_only_the_folder_of_an_agent_can_be_used(gui, tmp_path):
    (tmp_path / "empty").mkdir()
    agents.browse(gui.session, "a")
    answers = []
    prompt = dataclasses.replace(gui.session.prompts[0], folder=tmp_path, answer=answers.append)
    gui.session.prompts[0] = prompt
    gui.frames(4)
    gui.click("browser.empty")
    gui.click("browser.accept")
    gui.frames(3)
    assert answers == []
    assert prompt.describe(checkpoints_dir() / "goalkeeper").startswith("Goalkeeper")
    assert prompt.describe(tmp_path / "empty") == ""


def test_the_file_dialog_says_what_kind_of_file_is_missing(tmp_path):
    def question(**changes):
        values = {"purpose": "open", "title": "", "folder": tmp_path, "answer": print}
        return FileQuestion(**(values | changes))

    assert nothing_here(question()) == "No folders and no level files here."
    assert nothing_here(question(purpose="folder")) == "No folders here."
    clip = question(purpose="save", suffixes=(".gif", ".mp4"))
    assert nothing_here(clip) == "No folders and no .gif or .mp4 files here."


def test_the_head_of_the_training_panel_stays_in_a_small_window(make_gui):
    gui = make_gui(size=(1000, 640))
    gui.session.viewer.run.path = "/runs/one"
    gui.session.viewer.run.metrics = Metrics([{"timing/num_env_steps": 1e9, "loss/total": 1.0}] * 3)
    gui.session.viewer.run.newest = 999_999_999
    front(gui, "training")
    for name in ("training.follow", "training.metrics", "training.stop"):
        low, high = gui.probe(name).low, gui.probe(name).high
        assert 0 <= low[0] < high[0] <= 1000, name
    panel = gui.probe("training.plot.loss/total") if gui.shows("training.plot.loss/total") else None
    assert panel is None or panel.high[0] <= 1000


def test_the_form_evaluates_and_the_table_opens_attempts(with_agent):
    session = with_agent.session
    front(with_agent, "evaluate")
    with_agent.click("evaluate.run")
    settle(with_agent)
    name = session.document.level.name
    assert session.viewer.evaluation.complete
    with_agent.click(f"evaluate.{name}.0")
    assert with_agent.shows("evaluate.attempt.0")
    with_agent.click("evaluate.attempt.1")
    settle(with_agent)
    assert session.mode is Mode.REPLAY
    assert session.playback.casting.attempt == 1


def test_a_scripted_agent_that_is_measured_as_b_is_ticked(with_agent):
    session = with_agent.session
    session.viewer.slots["b"].summary = bare_summary("random")
    front(with_agent, "evaluate")
    assert not with_agent.probe("evaluate.random").enabled
    assert with_agent.probe("evaluate.noop").enabled
    with_agent.click("evaluate.random")
    assert session.viewer.form.scripted == ()
    with_agent.click("evaluate.noop")
    assert [agent.name for agent in session.viewer.measured] == ["Tester", "random", "noop"]


@pytest.mark.parametrize("size", [(1024, 640), (1280, 800)])
def test_the_form_has_a_line_for_what_for_who_and_for_how_often(with_agent, size):
    with_agent.host.size = size
    with_agent.frames(40)
    front(with_agent, "evaluate")
    rows = [
        {round(with_agent.probe(f"evaluate.{name}").centre[1]) for name in names}
        for names in (
            ("source", "physics"),
            ("more", "random", "noop", "planner"),
            ("attempts", "seed", "run", "open"),
        )
    ]
    assert [len(row) for row in rows] == [1, 1, 1]
    assert sorted(min(row) for row in rows) == [min(row) for row in rows]


def test_a_long_table_draws_only_what_is_in_sight(with_agent):
    session = with_agent.session
    front(with_agent, "evaluate")
    levels = tuple(EvaluatedLevel(name=f"l/{k:03}", source=a_level()) for k in range(300))
    session.viewer.evaluation.start(
        Plan(agents=session.viewer.agents, levels=levels, hashes=("",) * 300, attempts=2)
    )
    settle(with_agent)
    rows = [name for name in session.probe if name.startswith("evaluate.l/")]
    assert 2 < len(rows) < 60


def test_what_the_agent_sees_is_shown(with_agent):
    with_agent.frames(40)
    front(with_agent, "eye")
    settle(with_agent)
    assert with_agent.shows("eye.picture") and with_agent.shows("eye.circles")


def test_a_run_without_metrics_and_one_that_is_gone(with_agent):
    front(with_agent, "training")
    with_agent.click("training.watch")
    assert with_agent.session.prompts
    with_agent.key("escape")
    watch.watch_run(with_agent.session, "/runs/one")
    settle(with_agent)
    assert with_agent.session.viewer.run.error == ""
    with_agent.session.viewer.run.metrics = Metrics({"episode_solved": 0.1 * k} for k in range(5))
    with_agent.frames(3)
    assert with_agent.shows("training.plot.episode_solved")
    with_agent.click("training.stop")
    assert with_agent.session.viewer.run.path == ""


def test_contacts_that_were_left_out_are_told_while_it_plays(gui, monkeypatch):
    shown = []
    monkeypatch.setattr(
        play_side._Column, "lines", lambda column, words, *style: shown.append(words)
    )
    simulator = gui.session.playback.simulator
    gui.key("space")
    gui.frames(10)
    assert not any("left out" in words for words in shown)
    simulator.state = dataclasses.replace(simulator.state, dropped=3)
    gui.frames(10)
    assert any(words.startswith("contacts left out in 3 of ") for words in shown)


def test_a_slider_goes_over_the_checkpoints_of_a_run(gui, tmp_path):
    """One level over all checkpoints: each plays it from the start, with the same draws."""
    run = tmp_path / "mine"
    for step in (100, 200, 1000):
        folder = run / "checkpoints" / str(step)
        folder.mkdir(parents=True)
        (folder / "agent.json").write_text("{}")
        ref = AgentRef(path=str(folder), stamp=str(step))
        gui.stage.agents[str(folder)] = a_summary(f"mine {step}", ref=ref, folder=str(folder))
    (run / "metrics.jsonl").write_text("")
    newest = str(run / "checkpoints" / "1000")
    ref = AgentRef(path=str(run), stamp="run")
    gui.stage.agents[str(run)] = a_summary("mine 1000", ref=ref, folder=newest)
    agents.load_agent(gui.session, str(run))
    settle(gui)
    gui.session.viewer.seed = 7
    front(gui, "agents")
    gui.click("agents.play")
    gui.frames(20)
    assert gui.session.playback.player == "mine 1000" and gui.session.playback.step_count > 3
    gui.session.view.panels_in_play = True
    front(gui, "agents")
    low, high = gui.probe("agents.checkpoint.a").low, gui.probe("agents.checkpoint.a").high
    episode = gui.session.playback.episode
    for share, step in ((0.05, 100), (0.5, 200), (0.95, 1000)):
        x, y = low[0] + share * (high[0] - low[0]), (low[1] + high[1]) / 2
        gui.click_at(x, y)
        settle(gui)
        gui.frames(4)
        assert gui.session.playback.player == f"mine {step}"
        assert gui.session.mode is Mode.PLAYING
        assert gui.session.playback.casting.seed == 7
        assert gui.session.playback.episode > episode
        episode = gui.session.playback.episode
    assert not gui.session.viewer.follow_run
