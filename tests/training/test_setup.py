"""Parts that a configuration is put together from."""

import dataclasses
import re
import shutil
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import msgspec
import numpy as np
import pytest

from kinetix.agents.agent import Agent, load_agent
from kinetix.agents.card import NormalisationCard
from kinetix.agents.evaluate import capacity_and_key
from kinetix.engine.spec import Features
from kinetix.environment.env import KinetixEnv
from kinetix.environment.params import static_env_params_of
from kinetix.environment.reset import level_state
from kinetix.errors import KinetixError
from kinetix.level.codec import load_document, save_level
from kinetix.level.sets import SetLevel
from kinetix.level.sizes import SIZES
from kinetix.training.config import BcConfig, PpoConfig, ReplayConfig, SflConfig
from kinetix.training.config_warnings import learns_nothing
from kinetix.training.evaluation import TrainingEvaluation, evaluation_levels
from kinetix.training.imitation.starts import Starts
from kinetix.training.settings import make_config, settings_of
from kinetix.training.setup import make_setup
from kinetix.training.start import train
from tests.training.tiny import rocket, tiny_config


def listed(*levels: str) -> dict[str, Any]:
    levels = levels or ("s/first_flight", "s/wheelie")
    return {"size": "s", "level_mode": "list", "levels": levels}


def features_of_training(config: PpoConfig) -> Features:
    return make_setup(config, gradient_steps=1).env.static_env_params.features


def test_a_list_of_levels_is_trained_on_in_a_step_made_for_them() -> None:
    both = features_of_training(PpoConfig(**listed()))
    flight = features_of_training(PpoConfig(**listed("s/first_flight")))
    wheelie = features_of_training(PpoConfig(**listed("s/wheelie")))
    assert (flight.motors, flight.thrusters) == (False, True)
    assert wheelie.motors
    assert (both.motors, both.thrusters) == (True, True)
    assert flight.pairs
    assert wheelie.pairs
    assert set(both.pairs or ()) == {*flight.pairs, *wheelie.pairs}


@pytest.mark.parametrize(
    "config",
    [
        PpoConfig(size="s"),
        PpoConfig(**listed(), permute_state_during_training=True),
        PpoConfig(**listed(), parity="kinetix-3"),
        SflConfig(**listed(), put_eval_levels_in_buffer=True),
        ReplayConfig(**listed(), use_accel=True),
        BcConfig(**listed(), data=("s/goalkeeper",)),
    ],
    ids=["random", "shuffled", "parity", "with evaluation levels", "mutated", "imitation"],
)
def test_where_other_levels_may_come_the_step_can_do_everything(config: PpoConfig) -> None:
    assert features_of_training(config) == Features()


@pytest.mark.parametrize("parity", [None, "kinetix-3"])
def test_controls_are_masked_but_with_parity(parity: Any) -> None:
    game = make_setup(PpoConfig(**listed("s/wheelie"), parity=parity), gradient_steps=1).game
    state = jax.tree.map(lambda x: x[None], game.env.reset_fn(jax.random.key(0)))
    live = game.live_controls(state)
    assert bool(live.all()) is (parity is not None)
    assert bool(live.any())


@pytest.mark.slow
def test_moments_on_the_way_of_a_win_lie_in_other_slots_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def halfway(levels: list[SetLevel], env: KinetixEnv) -> Starts:
        state = level_state(levels[0].level, env.static_env_params)
        state = dataclasses.replace(state, timestep=jnp.int32(5))
        moments = jax.tree.map(lambda x: x[None], state)
        return Starts(moments=moments, odds=np.ones(1), without=("b",))

    monkeypatch.setattr("kinetix.training.setup.starts_on_the_way", halfway)
    config = PpoConfig(**listed("s/wheelie"), demo_starts=0.5, permute_state_during_training=True)
    setup = make_setup(config, gradient_steps=1)
    assert setup.without_starts == ("b",)
    states = jax.vmap(setup.reset_fn)(jax.random.split(jax.random.key(0), 32))
    positions = np.asarray(states.physics.position)
    for begun in (0, 5):
        assert np.ptp(positions[np.asarray(states.timestep) == begun], axis=0).max() > 0.1


def test_files_of_levels_are_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []

    def counted(path: Any) -> Any:
        read.append(str(path))
        return load_document(path)

    monkeypatch.setattr("kinetix.level.sets.gather.load_document", counted)
    monkeypatch.setattr("kinetix.environment.reset.load_document", counted)
    make_setup(PpoConfig(**listed()), gradient_steps=1)
    assert len(read) == 2


def test_levels_are_evaluated_on_as_they_were_when_a_training_began(tmp_path: Path) -> None:
    foreign = Path(__file__).parents[1] / "level" / "fixtures" / "kinetix_env" / "gaps.json"
    save_level(rocket(), tmp_path / "a.json")
    shutil.copy(foreign, tmp_path / "b.json")
    files = [str(path) for path in sorted(tmp_path.iterdir())]
    told = [capacity_and_key(file) for file in files]
    static = static_env_params_of(SIZES["l"])
    states = [level_state(file, static) for file in files]
    levels = evaluation_levels(PpoConfig(size="l", level_mode="list", levels=(str(tmp_path),)))
    shutil.rmtree(tmp_path)
    assert [capacity_and_key(level.source) for level in levels] == told
    for level, state in zip(levels, states, strict=True):
        found = level_state(level.source, static)
        jax.tree.map(np.testing.assert_array_equal, found, state)


@pytest.mark.slow
def test_random_levels_of_an_evaluation_are_random_where_levels_are_listed() -> None:
    asked = {"eval_freq": 1, "eval_sampled_levels": 4, "level_filter_n_steps": 4}
    config = tiny_config("ppo", levels=("s/first_flight",), size="s", **asked)
    evaluation = TrainingEvaluation(make_setup(config, gradient_steps=1))
    positions = [level.source.physics.position for level in evaluation._sampled]  # pyright: ignore
    assert np.ptp(np.stack(positions), axis=0).max() > 0.1


def normalising(frame_skip: int) -> Agent:
    """The agent of one level as if it had been trained with statistics of its observations."""
    agent = load_agent("goalkeeper")
    (width,) = {array.shape[-1] for array in agent._parts.values()}
    statistics = NormalisationCard(
        count=1e6, counts={"": 1e6}, mean={"": [3.0] * width}, variance={"": [4.0] * width}
    )
    environment = msgspec.structs.replace(agent.card.environment, frame_skip=frame_skip)
    card = msgspec.structs.replace(agent.card, environment=environment, normalisation=statistics)
    return Agent(card, agent.params["params"])


def test_what_an_agent_learnt_with_is_taken_over_in_python(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    begun = []

    def run(algorithm: str, config: PpoConfig, out: Path, **_: Any) -> None:
        begun.append(config)
        raise KinetixError("enough")

    monkeypatch.setattr("kinetix.training.start.run_training", run)
    agent = normalising(frame_skip=4)
    for fields in ({}, {"frame_skip": 1}):
        with pytest.raises(KinetixError, match="enough"):
            train("ppo", tmp_path, start_from=agent, levels=("s/goalkeeper",), **fields)
    assert [config.frame_skip for config in begun] == [4, 1]
    assert all(config.rms_norm for config in begun)
    assert begun[0].network == agent.card.network


def test_statistics_of_an_agent_are_not_dropped_in_silence() -> None:
    config = tiny_config("ppo", levels=("s/goalkeeper",))
    agent = normalising(frame_skip=2)
    config = dataclasses.replace(config, network=agent.card.network)
    with pytest.raises(KinetixError, match="normalises what it sees"):
        make_setup(config, gradient_steps=1, teacher=agent)


@pytest.mark.parametrize(
    ("algorithm", "changes", "words"),
    [
        ("dr", {"exploratory_grad_updates": False}, "nothing is learnt"),
        ("ppo", {"critic_warmup": 6}, "critic_warmup = 6 is no less than the 6 updates that learn"),
        ("plr", {"buffer_duplicate_check": True}, "there are 2 levels, and .* = 4 are needed"),
        ("dr", {"buffer_duplicate_check": True}, "^$"),
        ("plr", {}, "^$"),
        ("plr", {"exploratory_grad_updates": False}, "^$"),
        ("ppo", {"critic_warmup": 5}, "^$"),
    ],
)
def test_settings_that_leave_nothing_to_learn_are_told(
    algorithm: str, changes: dict[str, Any], words: str
) -> None:
    levels = {"levels": ("s/first_flight", "s/wheelie")}
    setup = make_setup(tiny_config(algorithm, **levels, **changes), gradient_steps=1)
    assert re.search(words, learns_nothing(setup))


def test_an_agent_that_sees_everything_as_it_is_gets_no_statistics() -> None:
    agent = load_agent("goalkeeper")
    config = tiny_config("ppo", levels=("s/goalkeeper",), rms_norm=True)
    config = dataclasses.replace(config, network=agent.card.network)
    with pytest.raises(KinetixError, match="sees everything as it is"):
        make_setup(config, gradient_steps=1, teacher=agent)


def test_the_size_of_an_agent_that_plays_no_other_is_taken_over() -> None:
    card = make_setup(tiny_config("ppo", size="m"), gradient_steps=1).card
    values = settings_of(card) | {"levels": ("s/goalkeeper",)}
    assert make_config("ppo", preset="small", values=values).size == "m"
    odd = msgspec.structs.replace(card.capacity, polygons=7)
    assert settings_of(card.replace(capacity=odd))["size"] == "7,3,2,2"
    assert "size" not in settings_of(load_agent("general").card)
