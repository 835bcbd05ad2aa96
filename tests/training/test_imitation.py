"""A teacher's data and imitation: it is found, written, read, played again and learnt from."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.networks.distributions import MultiCategorical
from kinetix.errors import KinetixError
from kinetix.level.codec import load_level
from kinetix.training.config import BcConfig
from kinetix.training.imitation import sources, teach
from kinetix.training.imitation.clone import imitation_loss
from kinetix.training.imitation.lessons import played_again, state_at
from kinetix.training.imitation.records import read_shard, write_shard
from kinetix.training.run import train
from kinetix.training.settings import make_config
from kinetix.training.setup import make_setup

_SOLVED = ("s/goalkeeper", "s/first_flight", "s/hang_on")
_SIZES = ((3, 3, 3, 3, 2, 2),)


@pytest.fixture(scope="module")
def data(tmp_path_factory, monkeypatch_module):
    """A teacher's data of some levels, and what it told."""
    monkeypatch_module.setattr(teach, "SHARD", 16)
    out = tmp_path_factory.mktemp("wins")
    config = teach.TeachConfig(size="s", rounds=2, batch=16, copies=1, physics="fast")
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
    assert told.levels == 16 * told.shards
    assert 0 < told.share <= 1
    assert told.episodes >= told.won
    stored = json.loads((out / teach.PROGRESS).read_text())
    assert stored["yield"]["won"] == told.won


@pytest.mark.slow
def test_a_teacher_goes_on_where_it_stopped_and_refuses_other_settings(data):
    out, config, told = data
    assert teach.teach(config, told.won, out) == told
    with pytest.raises(KinetixError, match="rounds = 2, now it is 3"):
        teach.teach(dataclasses.replace(config, rounds=3), 1000, out)
    (out / "wins_foreign").mkdir(exist_ok=True)
    other = out / "wins_foreign"
    (other / "x.txt").write_text("")
    with pytest.raises(KinetixError, match="holds no data"):
        teach.teach(config, 1, other)
    (other / "x.txt").unlink()
    other.rmdir()


@pytest.mark.slow
def test_shards_come_back_as_they_were(data, tmp_path):
    out, _, told = data
    part = next(sources.gather([str(out)]))
    assert told.episodes >= len(part.episodes) > 0
    path = tmp_path / "copy.npz"
    write_shard(path, part.origin, part.episodes)
    origin, episodes = read_shard(path)
    assert origin == part.origin
    for ours, theirs in zip(episodes, part.episodes, strict=True):
        np.testing.assert_array_equal(ours.actions, theirs.actions)
        assert (ours.number, ours.rounds) == (theirs.number, theirs.rounds)
        for a, b in zip(jax.tree.leaves(ours.state), jax.tree.leaves(theirs.state), strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda arrays: arrays.pop("first"), "'first' is missing"),
        (lambda arrays: arrays.update(action=arrays["action"] + 3), "no action"),
        (lambda arrays: arrays.update(first=arrays["first"][:-1]), "do not belong together"),
        (lambda arrays: arrays.update(about=np.array('{"format": "x"}')), "another format"),
    ],
)
def test_a_damaged_shard_is_told_in_one_sentence(data, tmp_path, change, says):
    out, _, _ = data
    with np.load(next(out.glob("*.npz"))) as stored:
        arrays = dict(stored)
    change(arrays)
    path = tmp_path / "bad.npz"
    np.savez(path, **arrays)
    with pytest.raises(KinetixError, match=says) as told:
        read_shard(path)
    assert str(path) in str(told.value)


@pytest.mark.slow
def test_what_was_won_is_won_again_and_its_moments_are_the_episode(data):
    out, _, _ = data
    origin = sources.origin_of([str(out)])
    episodes = sources.demonstrations([str(out)], origin.static_env_params)
    config = make_config("bc", values={"data": (str(out),), "observation_type": "symbolic_flat"})
    env = make_setup(config, gradient_steps=1).env
    played = played_again(env, episodes, gamma=0.99)
    assert played.lost <= len(episodes) // 4
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


def test_recorded_solutions_are_demonstrations():
    origin = sources.origin_of(_SOLVED)
    episodes = sources.demonstrations(_SOLVED, origin.static_env_params)
    assert len(episodes) == len(_SOLVED)


@pytest.mark.slow
def test_imitation_learns_what_was_done(tmp_path):
    values = {
        "data": _SOLVED,
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
    reports = []
    last = train("bc", config, tmp_path / "run", report=reports.append)
    assert last.is_dir()
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
        ({"data": _SOLVED, "recurrent_model": True}, "recurrent_model"),
        ({"data": _SOLVED, "label_smoothing": 1.5}, "label_smoothing"),
    ],
)
def test_settings_that_cannot_work_are_told_at_once(values, says):
    with pytest.raises(KinetixError, match=says):
        make_config("bc", values=values)


@pytest.mark.slow
def test_episodes_begin_on_the_way_of_the_recorded_solution():
    name = "s/goalkeeper"
    solution = load_level(name).solution
    assert solution is not None
    steps = solution.steps
    config = make_config("ppo", preset="specialist", values={"levels": (name,)})
    reset = make_setup(config, gradient_steps=1).reset_fn
    states = jax.jit(jax.vmap(reset))(jax.random.split(jax.random.key(0), 400))
    begun = np.asarray(states.timestep)
    # Half of them, less those that happen to begin at the start.
    assert 0.35 < (begun > 0).mean() < 0.6
    assert begun.max() < steps
    assert len(np.unique(begun)) > steps // 2
    apart = np.ptp(np.asarray(states.physics.position), axis=0).max()
    assert apart > 0.2


def test_the_share_of_starts_on_the_way_is_a_share():
    with pytest.raises(KinetixError, match="demo_starts"):
        make_config("ppo", values={"demo_starts": 1.5})


def test_a_pull_needs_somebody_who_pulls(tmp_path):
    values = {"teacher_coef": 0.5, "size": "s", "dummy_env": True, "eval_freq": 0}
    config = make_config("ppo", preset="small", values=values)
    with pytest.raises(KinetixError, match="--from"):
        train("ppo", config, tmp_path / "run")
