"""A teacher's data and imitation: it is found, written, read, played again and learnt from."""

import dataclasses
import json
import shutil
import types
from typing import get_args

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.networks.distributions import MultiCategorical
from kinetix.cli import main
from kinetix.cli.dataset import GatherEpisodes, VerifyDataset, run
from kinetix.datasets.episode import winning_plan
from kinetix.datasets.folder import MANIFEST, add_episodes, read_dataset, writing
from kinetix.datasets.sources import episodes_of
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.generators.machines import random_machines
from kinetix.environment.params import EnvParams, static_env_params_of
from kinetix.environment.reset import static_env_params_for_levels
from kinetix.environment.search.search import solve_level
from kinetix.errors import KinetixError
from kinetix.failures import Terminated
from kinetix.level.codec import load_level, save_level
from kinetix.level.model import Solution
from kinetix.level.sets import SetLevel
from kinetix.level.sizes import SIZES
from kinetix.training.config import ActionName, BcConfig
from kinetix.training.imitation import lessons, sources, starts, teach, turns
from kinetix.training.imitation.clone import imitation_loss, in_pieces, kept_back
from kinetix.training.imitation.lessons import played_again, state_at
from kinetix.training.run import train
from kinetix.training.settings import make_config
from kinetix.training.setup import make_setup
from tests.optimised import optimised
from tests.training.tiny import rocket

_SOLVED = ("s/goalkeeper", "s/first_flight", "s/hang_on")
_SIZES = ((3, 3, 3, 3, 2, 2),)


@pytest.fixture(scope="module")
def data(tmp_path_factory, monkeypatch_module):
    """A teacher's data of some levels, and what it told."""
    monkeypatch_module.setattr(teach, "SHARD", 8)
    out = tmp_path_factory.mktemp("wins")
    config = teach.TeachConfig(size="s", rounds=2, batch=8, copies=1, physics="jax2d")
    with optimised():
        return out, config, teach.teach(config, 2, out)


@pytest.fixture(scope="module")
def monkeypatch_module():
    patch = pytest.MonkeyPatch()
    yield patch
    patch.undo()


@pytest.mark.slow
def test_the_teacher_wins_random_levels_and_says_how_many(data):
    out, _, told = data
    assert told.won >= 2
    assert told.levels == 8 * told.shards
    assert 0 < told.share <= 1
    assert told.episodes >= told.won
    stored = json.loads((out / teach.PROGRESS).read_text())
    assert stored["yield"]["won"] == told.won


def test_a_search_that_was_stopped_goes_on_as_if_it_had_not_been(monkeypatch, tmp_path):
    todo, key, calls = np.array([1, 2, 4, 5, 7, 8, 9]), jax.random.PRNGKey(0), []
    levels = np.arange(10)

    def turn(env, states, elite, key):
        calls.append(states)
        if len(calls) == 4:
            raise KeyboardInterrupt
        draw = np.random.default_rng(np.asarray(key))
        plans = elite + draw.integers(0, 9, (3, 1, 1, 1), np.int8)
        return types.SimpleNamespace(elite=plans, won=draw.random(3) < 0.4)

    monkeypatch.setattr(turns, "search_round", turn)

    def searched(name, identity="this"):
        block = turns.SearchBlock(
            levels=levels, todo=todo, key=key, batch=3, rounds=2, identity=identity
        )
        return turns.search(None, block, tmp_path / name, lambda words: None)

    with pytest.raises(KeyboardInterrupt):
        searched("a")
    found = searched("a")
    stopped = len(calls)
    whole = searched("b")
    assert len(calls) - stopped == stopped - 1
    assert 0 < len(found) < len(todo) and found.keys() == whole.keys()
    assert all(np.array_equal(found[level], whole[level]) for level in whole)
    before = len(calls)
    searched("b", "another")  # another search does not go on with it
    assert len(calls) - before == stopped - 1
    (tmp_path / "b").write_bytes(b"damaged")
    assert searched("b").keys() == whole.keys()


def test_a_search_without_hope_ends(monkeypatch, tmp_path):
    with pytest.raises(KinetixError, match="no joints and no thrusters"):
        teach.teach(teach.TeachConfig(size="4,0,0,0", batch=8), 1, tmp_path / "still")
    nothing = ([], {"trivial": 0, "won": 0})
    monkeypatch.setattr(teach._Search, "__init__", lambda self, *_: None)
    monkeypatch.setattr(teach._Search, "shard", lambda self, number: nothing)
    monkeypatch.setattr(teach, "SHARD", 256)
    with pytest.raises(KinetixError, match="none of 1 024 levels was won"):
        teach.teach(teach.TeachConfig(size="s"), 1, tmp_path / "hopeless")


@pytest.mark.slow
def test_the_teacher_wins_random_machines_as_they_are(monkeypatch, tmp_path):
    monkeypatch.setattr(teach, "SHARD", 8)
    config = teach.TeachConfig(
        size="s", rounds=2, batch=8, copies=0, physics="jax2d", machines=True
    )
    told = teach.teach(config, 3, tmp_path)
    levels = {level.name for level in random_machines(0, "s", told.levels)}
    episodes = list(read_dataset(tmp_path))
    assert {episode.level.name for episode in episodes} <= levels
    assert {episode.attempt for episode in episodes} == {0}
    assert told.won / told.levels > 0.2
    with pytest.raises(KinetixError, match="expected s, m or l"):
        dataclasses.replace(config, size="locomotion").check()


@pytest.mark.slow
def test_a_teacher_goes_on_where_it_stopped_and_refuses_other_settings(data):
    out, config, told = data
    assert teach.teach(config, told.won, out) == told
    with pytest.raises(KinetixError, match="rounds = 2, now it is 3"):
        teach.teach(dataclasses.replace(config, rounds=3), 1000, out)
    (out / "wins_foreign").mkdir(exist_ok=True)
    other = out / "wins_foreign"
    (other / "x.txt").write_text("")
    with pytest.raises(KinetixError, match="holds no data set"):
        teach.teach(config, 1, other)
    (other / "x.txt").unlink()
    other.rmdir()


@pytest.mark.slow
def test_what_a_teacher_writes_is_a_data_set_of_wins_that_replay(data):
    out, config, told = data
    episodes = list(read_dataset(out))
    assert len(episodes) == told.episodes
    assert sum(episode.length for episode in episodes) == told.steps
    assert {episode.outcome for episode in episodes} == {"won"}
    assert {episode.physics for episode in episodes} == {config.physics}
    assert len({episode.level.name for episode in episodes}) == told.won
    assert run(VerifyDataset(folder=out)) == 0
    again = GatherEpisodes(out=out.parent / "gathered", sources=(str(out), "s/goalkeeper"))
    assert run(again) == 0
    assert len(list(read_dataset(again.out))) == told.episodes + 1


@pytest.mark.slow
def test_origins_are_read_from_the_manifest_and_from_shards_without(data, tmp_path):
    out, config, _ = data
    origin = sources.origin_of([str(out)])
    assert (origin.capacity, origin.physics) == (SIZES["s"], config.physics)
    older = tmp_path / "older"
    shutil.copytree(out, older)
    manifest = json.loads((older / MANIFEST).read_text())
    for shard in manifest["shards"]:
        del shard["origins"]
    (older / MANIFEST).write_text(json.dumps(manifest))
    assert sources.origin_of([str(older)]) == origin


@pytest.mark.slow
def test_what_was_won_is_won_again_and_its_moments_are_the_episode(data):
    out, _, _ = data
    origin = sources.origin_of([str(out)])
    static = static_env_params_of(origin.capacity, physics=origin.physics)
    episodes = sources.demonstrations([str(out)], static)
    config = make_config("bc", values={"data": (str(out),), "observation_type": "symbolic_flat"})
    env = make_setup(config, gradient_steps=1).env
    played = played_again(env, episodes, gamma=0.99)
    assert len(played.lost) <= len(episodes) // 4
    lessons = played.lessons
    assert lessons.count == len(lessons.action) == len(lessons.worth)
    ends = np.flatnonzero(np.diff(lessons.episode, append=-1) != 0)
    # The last step of each episode is the winning one.
    assert (lessons.worth[ends] > 0.5).all()
    begins = np.concatenate([[0], ends[:-1] + 1])
    state = state_at(lessons, jnp.asarray(begins))
    np.testing.assert_array_equal(
        state.physics.position, np.asarray(lessons.starts.physics.position)
    )
    assert (np.asarray(state.timestep) == 0).all()


def test_wins_and_nothing_else_are_learnt_from(tmp_path):
    level = load_level("s/goalkeeper")
    won = winning_plan(level, [[1, 0, 0, 0, 0, 0]] * 3, physics="jax2d", frame_skip=2)
    lost = dataclasses.replace(won, outcome="lost", physics="balanced")
    add_episodes(tmp_path / "set", [lost])
    with pytest.raises(KinetixError, match="no win to learn from"):
        sources.origin_of([str(tmp_path)])
    add_episodes(tmp_path / "set", [won])
    origin = sources.origin_of([str(tmp_path)])
    assert origin.physics == "jax2d"
    (found,) = sources.demonstrations([str(tmp_path)], static_env_params_of(origin.capacity))
    assert np.array_equal(found.actions, won.action)


def test_recorded_solutions_are_demonstrations():
    origin = sources.origin_of(_SOLVED)
    episodes = sources.demonstrations(_SOLVED, static_env_params_of(origin.capacity))
    assert len(episodes) == len(_SOLVED)


@pytest.mark.slow
def test_imitation_learns_what_was_done(tmp_path):
    mine = tmp_path / "mine"
    add_episodes(mine / "set", [found.episode for found in episodes_of(_SOLVED[0])])
    (mine / "notes.json").write_text('{"mass": 1}')
    values = {
        "data": (*_SOLVED[1:], str(mine)),
        "observation_type": "symbolic_flat",
        "total_timesteps": 30 * 4 * 64,
        "num_minibatches": 4,
        "num_train_envs": 4,
        "minibatch_size": 64,
        "learning_rate": 3e-3,
        "label_smoothing": 0.0,
        "held_out": 0.0,
        "eval_freq": 0,
        "actor_depth": 1,
        "critic_depth": 1,
    }
    config = make_config("bc", values=values)
    assert isinstance(config, BcConfig)
    reports, said = [], []
    last = train("bc", config, tmp_path / "run", report=reports.append, say=said.append)
    assert last.is_dir()
    assert f"left out: {mine / 'notes.json'}: " in "\n".join(said)
    first, final = reports[0].metrics, reports[-1].metrics
    assert final["loss/policy"] < 0.5 * first["loss/policy"]
    assert final["loss/agreement"] > 0.85
    assert final["loss/value"] < first["loss/value"]


def test_controls_that_are_not_there_say_nothing():
    logits = jax.random.normal(jax.random.key(0), (5, 16))
    policy = MultiCategorical(logits=logits, sizes=_SIZES[0])
    live = jnp.zeros((5, 6), bool).at[:, 0].set(True)
    action = jnp.zeros((5, 6), jnp.int32)
    loss, agreement = imitation_loss(policy, action, live, smoothing=0.0)
    wanted = -jax.nn.log_softmax(logits[:, :3])[:, 0].mean()
    np.testing.assert_allclose(loss, wanted, rtol=1e-6)
    np.testing.assert_allclose(agreement, (logits[:, :3].argmax(axis=1) == 0).mean())
    other = MultiCategorical(logits=logits.at[:, 3:].add(7.0), sizes=_SIZES[0])
    np.testing.assert_allclose(imitation_loss(other, action, live, smoothing=0.0)[0], loss)


def test_of_many_levels_whole_ones_are_kept_back_and_of_few_some_episodes():
    random = np.random.default_rng(0)
    many = kept_back([f"level {k % 100}" for k in range(600)], 0.05, random)
    assert many.levels == 5 and len(many.episodes) == 30
    assert len({k % 100 for k in many.episodes}) == 5
    few = kept_back(["a", "b"] * 50, 0.05, random)
    assert few.levels == 0 and few.episodes.tolist() == [0, 1, 2, 3, 4]
    assert not len(kept_back(["a", "b"], 0.05, random).episodes)


def test_everything_that_is_kept_back_is_judged():
    for count in (1, 3, 64, 65, 129, 200):
        pieces = in_pieces(np.arange(count), 64, 8)
        assert pieces.shape[1] <= 64 and set(pieces.ravel()) == set(range(count))
        assert pieces.size - count < len(pieces)
    assert in_pieces(np.arange(10_000), 64, 8).shape == (8, 64)
    assert not in_pieces(np.arange(0), 64, 8).size


def test_smoothing_is_least_where_the_choice_is_likely_but_not_certain():
    live = jnp.zeros((1, 6), bool).at[:, 0].set(True)
    action = jnp.zeros((1, 6), jnp.int32)

    def loss(height: float) -> float:
        logits = jnp.zeros((1, 16)).at[0, 0].set(height)
        policy = MultiCategorical(logits=logits, sizes=_SIZES[0])
        return float(imitation_loss(policy, action, live, smoothing=0.3)[0])

    assert loss(1.4) < loss(0.0)
    assert loss(1.4) < loss(20.0)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"data": ()}, "expected demonstrations"),
        ({"data": _SOLVED, "action_type": "discrete"}, "multi_discrete"),
        ({"data": _SOLVED, "dummy_env": True}, "dummy_env: imitation plays"),
        ({"data": _SOLVED, "recurrent_model": True}, "recurrent_model"),
        ({"data": _SOLVED, "label_smoothing": 1.5}, "label_smoothing"),
        ({"data": _SOLVED, "teacher_coef": 0.5}, "teacher_coef: imitation does not read it"),
    ],
)
def test_settings_that_cannot_work_are_told_at_once(values, says):
    with pytest.raises(KinetixError, match=says):
        make_config("bc", values=values)


@pytest.mark.slow
@pytest.mark.parametrize("action_type", get_args(ActionName))
def test_episodes_begin_on_the_way_of_the_recorded_solution(action_type, monkeypatch):
    monkeypatch.setattr(starts, "solve_level", pytest.fail)
    name = "s/goalkeeper"
    solution = load_level(name).solution
    assert solution is not None
    steps = solution.steps
    values = {"levels": (name,), "action_type": action_type}
    config = make_config("ppo", preset="specialist", values=values)
    reset = make_setup(config, gradient_steps=1).reset_fn
    states = jax.jit(jax.vmap(reset))(jax.random.split(jax.random.key(0), 400))
    begun = np.asarray(states.timestep)
    # Half of them, less those that happen to begin at the start.
    assert 0.35 < (begun > 0).mean() < 0.6
    assert begun.max() < steps
    assert len(np.unique(begun)) > steps // 2
    apart = np.ptp(np.asarray(states.physics.position), axis=0).max()
    assert apart > 0.2


def starts_of(levels, monkeypatch, search=None, frame_skip=2):
    """Starts of levels in an environment that computes what they have."""
    monkeypatch.setattr(starts, "solve_level", search or pytest.fail)
    static = static_env_params_of(SIZES["s"], physics="jax2d", frame_skip=frame_skip)
    static = static_env_params_for_levels(levels, static)
    env = make_kinetix_env("multi_discrete", "blind", None, EnvParams(), static)
    return starts.starts_on_the_way([SetLevel(name=each.name, level=each) for each in levels], env)


def solved(level, steps):
    """The level, with the solution of burning for so many steps."""
    runs = ((steps, (0, 0, 0, 0, 1, 0)),)
    solution = Solution(physics="jax2d", frame_skip=2, actions=runs)
    return level.replace(solution=solution)


def test_what_is_wrong_with_a_recorded_solution_is_not_taken_for_a_loss(monkeypatch):
    def broken(*_):
        raise KinetixError("broken")

    monkeypatch.setattr(lessons, "_replay", broken)
    with pytest.raises(KinetixError, match="broken"):
        starts_of([solved(rocket(), 40)], monkeypatch)


@pytest.mark.slow
def test_a_win_is_searched_for_at_the_trainings_frame_skip(monkeypatch):
    found = starts_of([rocket()], monkeypatch, solve_level, 4)
    assert found.moments.timestep.max() >= 8


@pytest.mark.slow
def test_levels_whose_win_is_lost_are_named(monkeypatch):
    def lost(level, **_):
        return solved(level, 1).solution

    levels = [solved(rocket(), 40), solved(rocket().replace(name="stays"), 1)]
    assert starts_of(levels, monkeypatch, lost).without == ("stays",)
    with pytest.raises(KinetixError, match="stays: no win that was found is one"):
        starts_of(levels[1:], monkeypatch, lost)


def test_a_level_has_its_share_of_the_starts_however_long_its_win_is(monkeypatch):
    episode = np.repeat([0, 1], [90, 10])
    moments = {"timestep": episode}

    def played(env, wins, *, gamma):
        told = types.SimpleNamespace(episode=episode, count=100)
        return lessons.Replayed(lessons=told, episodes=2, lost=(1,))

    monkeypatch.setattr(starts, "played_again", played)
    monkeypatch.setattr(starts, "_win", lambda level, env: None)
    monkeypatch.setattr(starts, "state_at", lambda lessons, rows: moments)
    levels = [
        SetLevel(name=str(k), level=rocket(), weight=weight) for k, weight in enumerate((3, 5, 1))
    ]
    found = starts.starts_on_the_way(levels, None)
    assert found.without == ("1",)
    reset = starts.beginning_on_the_way(lambda key: {"timestep": jnp.int32(0)}, found, 1.0)
    drawn = jax.vmap(reset)(jax.random.split(jax.random.key(0), 2000))["timestep"]
    assert 0.22 < float(jnp.mean(drawn)) < 0.28


def test_the_share_of_starts_on_the_way_is_a_share():
    with pytest.raises(KinetixError, match="demo_starts"):
        make_config("ppo", values={"demo_starts": 1.5})


def test_a_pull_needs_somebody_who_pulls(tmp_path):
    values = {"teacher_coef": 0.5, "size": "s", "dummy_env": True, "eval_freq": 0}
    config = make_config("ppo", preset="small", values=values)
    with pytest.raises(KinetixError, match="--from"):
        train("ppo", config, tmp_path / "run")


def test_a_slip_of_the_first_command_leaves_nothing_in_the_way(tmp_path):
    for slip in ({"size": "q"}, {"physics": "warp"}):
        with pytest.raises(KinetixError):
            teach.teach(teach.TeachConfig(**{"size": "s"} | slip), 1, tmp_path / "out")
        assert not (tmp_path / "out").exists()
    out = tmp_path / "begun"
    out.mkdir()
    first, second = (teach.TeachConfig(size="s", seed=seed) for seed in (1, 2))
    with writing(out):  # makes the data set
        assert teach._resumed(first, out) == teach._resumed(second, out) == teach.Yield()
    told = json.loads((out / teach.PROGRESS).read_text())
    assert told["settings"]["seed"] == 2


def test_a_teacher_tells_its_result_once(monkeypatch, tmp_path, capsys):
    def shards(config, count, out, *, report, status):
        for won in (1, 2):
            status("searching")
            report(teach.Yield(levels=256 * won, won=won, shards=won))
        return teach.Yield(levels=512, won=2, shards=2)

    monkeypatch.setattr(teach, "teach", shards)
    assert main(["teach", "--size", "s", "--count", "2", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr()
    assert printed.err.startswith("searching\n1 of 256 levels won") and "512" not in printed.err
    assert "2 of 512 levels won" in printed.out


@pytest.mark.parametrize("stop", [KeyboardInterrupt, Terminated])
@pytest.mark.parametrize(("episodes", "kept"), [(0, ""), (7, "7 episodes of this search kept; ")])
def test_an_interrupted_teacher_says_what_is_kept(
    monkeypatch, tmp_path, capsys, stop, episodes, kept
):
    def interrupted(config, count, out, *, report, status):
        if episodes:
            report(teach.Yield(levels=256, won=1, episodes=episodes, shards=1))
        raise stop

    monkeypatch.setattr(teach, "teach", interrupted)
    status = main(["teach", "--size", "s", "--count", "2", "--out", str(tmp_path)])
    assert status == (130 if stop is KeyboardInterrupt else 143)
    told = capsys.readouterr().err
    under_way = f"the same command goes on with the {teach.SHARD} levels under way"
    assert f"stopped: {kept}{under_way}\n" in told


def test_imitation_refuses_options_that_it_does_not_read(tmp_path, capsys):
    words = ["train", "bc", "--data", "s/goalkeeper", "--out", str(tmp_path / "run")]
    assert main([*words, "--ent-coef", "0.1"]) == 2
    assert "Unrecognized or misplaced options" in capsys.readouterr().err
    assert main(["train", "bc", "--help"]) == 0
    told = capsys.readouterr().out
    assert "--label-smoothing" in told and "--ent-coef" not in told


@pytest.mark.slow
def test_a_row_of_imitation_says_what_it_is_about(tmp_path, capsys):
    options = {"minibatch_size": 16, "num_minibatches": 2, "eval_freq": 0}
    options |= {"observation_type": "symbolic_flat", "total_timesteps": 32, "held_out": 0.0}
    flags = [word for k, v in options.items() for word in (f"--{k.replace('_', '-')}", str(v))]
    out, data = str(tmp_path / "run"), tmp_path / "data"
    data.mkdir()
    save_level(load_level("s/goalkeeper"), data / "a.json")
    assert main(["train", "bc", "--data", str(data), "--out", out, *flags]) == 0
    told = capsys.readouterr().err
    assert "1 update of 32 moments\n" in told and "environment" not in told
    (row,) = [line for line in told.splitlines() if line.startswith("1/1  ")]
    assert "agreement 0." in row and "solved" not in row and "return" not in row
    shutil.copy(data / "a.json", data / "b.json")
    for steps, changed in (("64", True), ("96", False)):
        assert main(["train", "bc", "--out", out, "--total-timesteps", steps]) == 0
        told = capsys.readouterr().err
        assert ("the demonstrations have changed" in told) is changed
