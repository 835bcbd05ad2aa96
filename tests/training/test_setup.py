"""Parts that a configuration is put together from."""

from typing import Any

import jax
import pytest

from kinetix.engine.spec import Features
from kinetix.level.codec import load_document
from kinetix.training.config import PpoConfig, ReplayConfig, SflConfig
from kinetix.training.setup import make_setup


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
    ],
    ids=["random", "shuffled", "parity", "with evaluation levels", "mutated"],
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


def test_files_of_levels_are_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []

    def counted(path: Any) -> Any:
        read.append(str(path))
        return load_document(path)

    monkeypatch.setattr("kinetix.level.sets.gather.load_document", counted)
    monkeypatch.setattr("kinetix.environment.reset.load_document", counted)
    make_setup(PpoConfig(**listed()), gradient_steps=1)
    assert len(read) == 2
