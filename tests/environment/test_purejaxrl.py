"""PureJaxRL's ppo.py as published, with one line changed, learns one of our levels.

It runs where the file is at hand: `PUREJAXRL=…/purejaxrl/ppo.py`, and gymnax 0.0.9 and distrax in
the environment.
"""

import importlib
import os
import sys
from pathlib import Path
from types import ModuleType

import jax
import numpy as np
import pytest

from kinetix import load_from_json_file, make_kinetix_env, make_reset_fn_list_of_levels

PUBLISHED = Path(os.environ.get("PUREJAXRL", "ppo.py"))
LINE = 'env, env_params = gymnax.make(config["ENV_NAME"])'


def our_environment():
    _, static, params = load_from_json_file("s/goalkeeper")
    reset_fn = make_reset_fn_list_of_levels("s/goalkeeper", static)
    return make_kinetix_env("discrete", "symbolic_flat", reset_fn, params, static), params


@pytest.mark.slow
def test_the_published_file_learns_goalkeeper(monkeypatch):
    if not PUBLISHED.is_file():
        pytest.skip("PUREJAXRL names no file")
    for package in ("gymnax", "distrax"):
        pytest.importorskip(package)
    # Its own wrappers.py also imports brax and navix; these are the same classes.
    monkeypatch.setitem(sys.modules, "wrappers", importlib.import_module("gymnax.wrappers.purerl"))
    source = PUBLISHED.read_text()
    assert source.count(LINE) == 1
    module = ModuleType("published_ppo")
    module.__dict__["our_environment"] = our_environment
    exec(source.replace(LINE, "env, env_params = our_environment()"), module.__dict__)
    config = {"LR": 2.5e-4, "NUM_ENVS": 64, "NUM_STEPS": 128, "TOTAL_TIMESTEPS": 5e5}
    config |= {"UPDATE_EPOCHS": 4, "NUM_MINIBATCHES": 4, "GAMMA": 0.99, "GAE_LAMBDA": 0.95}
    config |= {"CLIP_EPS": 0.2, "ENT_COEF": 0.01, "VF_COEF": 0.5, "MAX_GRAD_NORM": 0.5}
    config |= {"ACTIVATION": "tanh", "ENV_NAME": "Kinetix", "ANNEAL_LR": True, "DEBUG": False}
    out = jax.jit(module.make_train(config))(jax.random.PRNGKey(30))
    ended = np.asarray(out["metrics"]["returned_episode"])[-10:]
    won = np.asarray(out["metrics"]["GoalR"])[-10:]
    assert won[ended].mean() >= 0.8
