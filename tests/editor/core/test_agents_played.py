"""Real agents behind the bridge: played, measured, opened again, filmed; broken ones refused."""

import dataclasses
import json
import shutil

import numpy as np
import pytest
from PIL import Image as Picture

from editor.worker.requests import (
    Advance,
    AgentRef,
    Casting,
    Evaluate,
    EvaluatedLevel,
    ExportFilm,
    LoadAgent,
    Observe,
    OpenEpisode,
    ReadRun,
    Restore,
    StartEpisode,
)
from kinetix.errors import CheckpointError, KinetixError
from kinetix.level.codec import load_level
from kinetix.paths import checkpoints_dir, levels_dir
from kinetix.training.logging import STEPS, UPDATE

pytestmark = pytest.mark.slow

KEEPER = str(checkpoints_dir() / "goalkeeper")
GOAL = EvaluatedLevel(name="s/goalkeeper", source=str(levels_dir() / "s" / "goalkeeper.json"))


class Quiet:
    def __init__(self):
        self.shared = []

    def report(self, fraction, message):
        pass

    def share(self, partial):
        self.shared.append(partial)


@pytest.fixture(scope="module")
def perform():
    from editor.worker import simulation

    return lambda request, progress=None: simulation.perform(request, progress or Quiet())


@pytest.fixture(scope="module")
def keeper(perform):
    return perform(LoadAgent(path=KEEPER))


@pytest.fixture(scope="module")
def level():
    return load_level("s/goalkeeper")


@pytest.fixture(scope="module")
def watched(perform, keeper, level):
    """A whole episode as it is watched, its start included."""
    casting = Casting(agent=keeper.ref)
    first = perform(StartEpisode(run=1, level=level, physics="balanced", casting=casting))
    rest = perform(Advance(run=1, actions=(None,) * 60))
    return [first, *rest]


@pytest.fixture(scope="module")
def standing(perform, keeper):
    progress = Quiet()
    request = Evaluate(
        agents=(keeper.ref, AgentRef(path="/no/such/agent")),
        levels=(GOAL,),
        attempts=4,
        seed=0,
        physics="balanced",
        deterministic=False,
    )
    return perform(request, progress), progress


def test_the_summary_says_what_the_agent_is(keeper):
    assert (keeper.name, keeper.observation, keeper.action) == (
        "Goalkeeper",
        "symbolic_flat",
        "multi_discrete",
    )
    assert keeper.capacity == (5, 2, 1, 1) and not keeper.any_size
    assert keeper.parameters == 86_289


def test_the_agent_solves_its_level_while_it_is_watched(watched):
    last = watched[-1]
    assert last.outcome == "won"
    assert [snapshot.step for snapshot in watched] == list(range(len(watched)))
    assert all(s.mind.entropy > 0 and s.frame_skip == 2 for s in watched[1:])
    assert last.total_reward == pytest.approx(sum(s.reward for s in watched), abs=1e-5)


def test_going_on_from_a_moment_gives_the_same_to_the_bit(perform, watched):
    perform(Restore(run=1, snapshot=watched[9]))
    again = perform(Advance(run=1, actions=(None,) * 8))
    assert len(again) == min(8, len(watched) - 10) > 0
    for one, other in zip(watched[10:18], again, strict=True):
        np.testing.assert_array_equal(one.position, other.position)
        assert one.mind == other.mind


def test_a_person_drives_and_the_agent_goes_on_thinking(perform, watched):
    perform(Restore(run=1, snapshot=watched[9]))
    (taken,) = perform(Advance(run=1, actions=((1, 0, 0, 0, 0, 0),)))
    assert taken.action == (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert taken.mind.by_hand
    assert taken.mind.own_action == watched[10].mind.own_action
    assert taken.mind.value == watched[10].mind.value


def test_the_table_is_what_the_command_prints_to_the_bit(standing, capsys):
    from kinetix.cli import main

    result, _ = standing
    command = ["eval", "--agent", KEEPER, "--levels", "s/goalkeeper", "--attempts", "4", "--json"]
    assert main(command) == 0
    line = json.loads(capsys.readouterr().out.splitlines()[0])
    (score,) = result.scores
    assert score.result.as_dict() == line


def test_an_agent_that_is_missing_is_reported_and_the_others_go_on(standing):
    result, progress = standing
    ((agent, sentence),) = result.errors
    assert agent == 1
    assert sentence.startswith("/no/such/agent: there is no such directory, nor a bundled agent")
    assert result.scores[0].agent == 0
    done = [step.done for step in progress.shared]
    assert done == sorted(done) and len(done) > 3


def test_an_attempt_opens_as_it_was_to_the_bit(perform, keeper, standing):
    result, _ = standing
    casting = Casting(agent=keeper.ref, attempt=2)
    opened = perform(OpenEpisode(level=GOAL, casting=casting, physics="balanced"))
    told = result.scores[0].result.episodes[2]
    last = opened.trace.snapshots[-1]
    assert (last.outcome, last.step) == (told.outcome, told.length)
    assert last.total_reward == pytest.approx(told.total_reward, abs=1e-5)
    assert len(opened.trace.actions) == told.length
    assert opened.trace.player == "Goalkeeper"
    # It can be played on from: the memory and the state are there.
    middle = opened.trace.snapshots[5]
    start = StartEpisode(run=7, level=opened.level, physics="balanced", casting=casting)
    perform(start)
    perform(Restore(run=7, snapshot=middle))
    (after,) = perform(Advance(run=7, actions=(None,)))
    assert after.step == 6
    assert after.action == opened.trace.snapshots[6].action


def test_a_film_has_the_overlay_and_a_picture_a_step(perform, keeper, standing, tmp_path):
    casting = Casting(agent=keeper.ref, attempt=2)
    opened = perform(OpenEpisode(level=GOAL, casting=casting, physics="balanced"))
    frames = {}
    for overlay in (False, True):
        path = tmp_path / f"film{overlay}.gif"
        film = ExportFilm(
            level=opened.level, trace=opened.trace, path=path, pixels=200, overlay=overlay
        )
        perform(film)
        with Picture.open(path) as picture:
            assert picture.n_frames == len(opened.trace.snapshots)
            picture.seek(5)
            frames[overlay] = np.asarray(picture.convert("RGB"), np.int32)
    changed = np.abs(frames[True] - frames[False]).sum(axis=-1) > 60
    # A GIF chooses its colours anew, so a few other pixels change as well.
    assert changed[:20].mean() > 0.1 > 0.01 > changed[40:].mean()


def test_a_film_of_two_players_has_both_with_their_names(perform, keeper, tmp_path):
    casting = Casting(agent=keeper.ref, attempt=2)
    opened = perform(OpenEpisode(level=GOAL, casting=casting, physics="balanced"))
    film = ExportFilm(
        level=opened.level,
        trace=dataclasses.replace(opened.trace, snapshots=opened.trace.snapshots[:6]),
        rival=dataclasses.replace(opened.trace, player="other"),
        path=tmp_path / "two.gif",
        pixels=200,
    )
    perform(film)
    with Picture.open(film.path) as picture:
        assert picture.size == (404, 200)
        assert picture.n_frames == 6  # the first player's episode goes on: what was asked for
    ended = dataclasses.replace(opened.trace.snapshots[5], outcome="won")
    moments = (*opened.trace.snapshots[:5], ended)
    perform(dataclasses.replace(film, trace=dataclasses.replace(opened.trace, snapshots=moments)))
    with Picture.open(film.path) as picture:
        assert picture.n_frames == len(opened.trace.snapshots)  # to the second player's end


def test_what_the_agent_sees_has_names_and_the_numbers_of_the_network(perform, keeper, watched):
    view = perform(
        Observe(level=load_level("s/goalkeeper"), state=watched[3].state, agent=keeper.ref)
    )
    assert view.pixels.shape == (125, 125, 3)
    (table,) = view.tables
    assert len(table.rows) == table.values.shape[0]
    row = table.rows.index("circle[0].position_x [m]")
    circles = [
        k
        for k, b in enumerate(load_level("s/goalkeeper").bodies)
        if not hasattr(b.shape, "vertices")
    ]
    assert table.values[row, 0] == pytest.approx(watched[3].position[circles[0], 0], abs=1e-5)


def test_an_agent_of_one_size_refuses_a_larger_level(perform, keeper):
    large = load_level("l/rover_ridge")
    with pytest.raises(CheckpointError, match="sees exactly 5 polygons"):
        perform(
            StartEpisode(run=3, level=large, physics="balanced", casting=Casting(agent=keeper.ref))
        )


def broken_copy(tmp_path, change):
    folder = tmp_path / "broken"
    shutil.copytree(KEEPER, folder)
    change(folder)
    return str(folder)


def test_damaged_agents_are_refused_with_one_sentence(perform, tmp_path):
    with pytest.raises(KinetixError, match="there is no such directory, nor a bundled agent"):
        perform(LoadAgent(path=str(tmp_path / "nothing")))

    def cut(folder):
        text = (folder / "agent.json").read_text()
        (folder / "agent.json").write_text(text[: len(text) // 2])

    path = broken_copy(tmp_path, cut)
    with pytest.raises(CheckpointError, match=r"agent\.json: not JSON, line \d+") as caught:
        perform(LoadAgent(path=path))
    assert "\n" not in str(caught.value)

    shutil.rmtree(path)
    path = broken_copy(tmp_path, lambda folder: shutil.rmtree(folder / "params"))
    with pytest.raises(CheckpointError, match="params"):
        perform(LoadAgent(path=path))


def test_an_agent_that_gives_no_numbers_is_said_to(perform, keeper, level, monkeypatch):
    import jax
    import jax.numpy as jnp

    from editor.worker.simulation import cast
    from kinetix.agents.agent import load_agent

    sick = load_agent(KEEPER)
    sick.params["params"] = jax.tree.map(lambda x: jnp.full_like(x, jnp.nan), sick.params["params"])
    ref = AgentRef(path="sick", stamp="sick")
    monkeypatch.setitem(cast._MEMORY, ref, sick)
    perform(StartEpisode(run=5, level=level, physics="balanced", casting=Casting(agent=ref)))
    with pytest.raises(KinetixError, match="'Goalkeeper' gave NaN"):
        perform(Advance(run=5, actions=(None,)))


def test_a_training_run_is_read(perform, tmp_path):
    rows = [{UPDATE: n, STEPS: 64 * n, "loss": 1.5 - 0.5 * n} for n in (1, 2)]
    text = "".join(json.dumps(row) + "\n" for row in rows) + '{"lo'
    (tmp_path / "metrics.jsonl").write_text(text)
    news = perform(ReadRun(path=str(tmp_path)))
    assert (news.rows, news.total, news.newest) == (tuple(rows), 2, None)
    with pytest.raises(KinetixError, match="expected the folder of a training run"):
        perform(ReadRun(path=str(tmp_path / "gone")))


@pytest.mark.peer
def test_the_published_agent_opens_and_plays(perform, peer, level):
    path = str(peer / "agents" / "paper-general")
    summary = perform(LoadAgent(path=path))
    assert (summary.parameters, summary.physics, summary.any_size) == (786_369, "jax2d", True)
    casting = Casting(agent=summary.ref)
    perform(StartEpisode(run=9, level=level, physics="jax2d", casting=casting))
    played = perform(Advance(run=9, actions=(None,) * 5))
    assert played[-1].step == 5
    assert all(abs(snapshot.mind.value) < 10 for snapshot in played)


@pytest.mark.peer
def test_the_table_of_the_published_agent_is_what_the_command_prints(perform, peer, capsys):
    from kinetix.cli import main

    path = str(peer / "agents" / "paper-general")
    request = Evaluate(
        agents=(AgentRef(path=path),),
        levels=(GOAL,),
        attempts=4,
        seed=0,
        physics="jax2d",
        deterministic=False,
    )
    (score,) = perform(request, Quiet()).scores
    command = ["eval", "--agent", path, "--levels", "s/goalkeeper", "--attempts", "4", "--json"]
    assert main([*command, "--physics", "jax2d"]) == 0
    assert score.result.as_dict() == json.loads(capsys.readouterr().out.splitlines()[0])
