"""Fixtures of several files of tests: a finished run, and trainers that are compiled once."""

import pytest

from kinetix.training import run
from tests.training.tiny import tiny_config


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """A run that was never interrupted."""
    out = tmp_path_factory.mktemp("runs") / "whole"
    run.train("ppo", tiny_config("ppo", dummy_env=True), out)
    return out


@pytest.fixture(scope="session")
def trainers():
    """Compiled trainers by configuration."""
    return {}


@pytest.fixture
def shared_trainers(trainers, monkeypatch):
    """Equal configurations share a trainer of PPO, which holds nothing that a run changes."""
    make = run.make_trainer

    def shared(config, teacher=None):
        if teacher is not None or type(config) is not run.PpoConfig:
            return make(config, teacher)
        if config not in trainers:
            trainers[config] = make(config)
        return trainers[config]

    monkeypatch.setattr(run, "make_trainer", shared)
