"""PPO learns a level, SFL finds levels that can be learnt."""

import jax
import numpy as np
import pytest

from kinetix.errors import KinetixError
from kinetix.level.codec import save_level
from kinetix.training.logging import read_metrics
from kinetix.training.run import train
from kinetix.training.settings import make_config
from kinetix.training.trainer import make_trainer
from tests.training.tiny import rocket, sfl_on, tiny_config


@pytest.mark.slow
def test_ppo_learns_an_easy_level(tmp_path):
    """A fixed budget on one level of size s; the last evaluation solves at least 0.8."""
    save_level(rocket(), tmp_path / "rocket.json")
    config = make_config(
        "ppo",
        preset="small",
        values={
            "levels": (str(tmp_path / "rocket.json"),),
            "total_timesteps": 65_536,
            "eval_freq": 1000,
            "eval_num_attempts": 50,
            "checkpoint_save_freq": 1000,
        },
    )
    train("ppo", config, tmp_path / "run")
    assert read_metrics(tmp_path / "run")[-1]["eval/hand_designed_episode_solve_rate"] >= 0.8


@pytest.mark.slow
def test_sfl_trains_on_a_fixed_set_and_measures_what_that_changes(tmp_path):
    trainer = sfl_on(
        tmp_path / "rocket.json",
        train_on_buffer=True,
        train_buffer_size=5,
        log_learnability_before_after=True,
    )
    state = trainer.start()
    reports = []
    for _ in range(3):
        state, metrics = trainer.update(state)
        reports.append({name for name in metrics if name.startswith("sfl/")})
    chosen = {"sfl/buffer_learnability", "sfl/sampled_learnability"}
    before = {"sfl/learnability_before", "sfl/solve_rate_before"}
    after = {"sfl/learnability_after", "sfl/solve_rate_after"}
    assert reports == [chosen | before, set(), chosen | before | after]
    assert state.pool.timestep.shape == (5,)


@pytest.mark.slow
def test_sfl_can_be_given_the_evaluation_levels(tmp_path):
    other = rocket().replace(name="other", gravity=(0.0, -3.0))
    save_level(other, tmp_path / "other.json")
    given = {"put_eval_levels_in_buffer": True, "eval_levels": (str(tmp_path / "other.json"),)}
    trainer = sfl_on(tmp_path / "rocket.json", **given)
    state, _ = trainer.update(trainer.start())
    gravity = np.asarray(state.chosen.levels.world.gravity[:, 1])
    np.testing.assert_allclose(gravity, [-9.81, -9.81, -9.81, -3.0], rtol=1e-3)
    with pytest.raises(KinetixError, match="do not fit a buffer of num_to_save = 4"):
        sfl_on(tmp_path / "rocket.json", **given | {"eval_levels": ("s/first_flight",) * 5})


def test_entities_can_change_their_slots(tmp_path):
    trainer = sfl_on(tmp_path / "rocket.json", permute_state_during_training=True)
    reset = jax.jit(jax.vmap(trainer.setup.reset_fn))
    slots = np.asarray(reset(jax.random.split(jax.random.key(0), 16)).world.bodies.active)
    # The rocket's only circle is the blue ball; it lies in either of the two slots of circles.
    assert {tuple(row) for row in slots[:, 5:]} == {(True, False), (False, True)}
    same = trainer.setup.arranged(
        state := reset(jax.random.split(jax.random.key(0), 16)), jax.random.key(1)
    )
    moved = np.asarray(same.world.bodies.active[:, 5:] != state.world.bodies.active[:, 5:])
    assert moved.any() and not moved.all()


@pytest.mark.slow
def test_sfl_keeps_more_learnable_levels_than_it_samples():
    config = tiny_config(
        "sfl",
        batch_size=128,
        num_to_save=32,
        rollout_steps=128,
        num_steps=8,
        total_timesteps=8 * 8 * 2,
        learnability_correction=False,
        filter_levels=False,
    )
    trainer = make_trainer(config)
    _, metrics = trainer.update(trainer.start())
    assert float(metrics["sfl/buffer_learnability"]) > 2 * float(
        metrics["sfl/sampled_learnability"]
    )
    # Means of episodes are NaN here: none ends within so short a rollout.
    losses = [value for name, value in metrics.items() if name.startswith("loss/")]
    assert np.all(np.isfinite(losses))
