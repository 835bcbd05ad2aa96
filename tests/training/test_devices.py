"""Training over two (made-up) devices is training over one."""

import json
import os
import subprocess
import sys

import pytest

_PROGRAM = """
import json, sys
import jax
from kinetix.training.trainer import make_trainer
from kinetix.training.settings import make_config

values = json.loads(sys.argv[1])
trainer = make_trainer(make_config("ppo", values=values))
state = trainer.start()
program = trainer._update.lower(state).compile().as_text()
kinds = ("all-gather", "all-to-all", "collective-permute")
moved = sum(program.count(f"{kind}(") for kind in kinds)
rows = []
for _ in range(3):
    state, metrics = trainer.update(state)
    rows.append({name: float(value) for name, value in metrics.items()})
spread = len(state.playing.observation.sharding.device_set)
averaged = program.count("all-reduce(") + program.count("all-reduce-start(")
report = {"spread": spread, "moved": moved, "averaged": averaged, "rows": rows}
print(json.dumps(report | {"devices": jax.device_count()}))
"""

_SCORING = """
import json, sys
from kinetix.training.trainer import make_trainer
from kinetix.training.settings import make_config

trainer = make_trainer(make_config("sfl", values=json.loads(sys.argv[1])))
state = trainer.start()
for _ in range(2):
    state, _ = trainer.update(state)
print(trainer._score_batch._cache_size(), trainer._train._cache_size())
"""

_RESUMING = """
import json, pathlib, sys
import numpy as np
import jax
from kinetix.training.ppo.rollout import as_updates_leave_it
from kinetix.training.trainer import make_trainer
from kinetix.training.settings import make_config

trainer = make_trainer(make_config("ppo", values=json.loads(sys.argv[1])))
places = lambda state: [leaf.sharding for leaf in jax.tree.leaves(state)]
state, _ = trainer.update(trainer.start())
trainer.work.taken()
back = as_updates_leave_it(jax.tree.map(np.asarray, state))
print(places(back) == places(state))
for _ in range(2):
    back, _ = trainer.update(back)
print(*[part.compiled for part in trainer.work.taken()])
"""

_REPLAYING = """
import json, sys
import jax
import numpy as np
from kinetix.training.ppo.rollout import as_updates_leave_it
from kinetix.training.trainer import make_trainer
from kinetix.training.settings import make_config

trainer = make_trainer(make_config("accel", values=json.loads(sys.argv[1])))
state = trainer.start()
for _ in range(8):
    state, _ = trainer.update(state)
state = as_updates_leave_it(jax.tree.map(np.asarray, state))
for _ in range(4):
    state, _ = trainer.update(state)
print(*[step._cache_size() for step in trainer._steps.values()])
"""

_VALUES = {
    "size": "s",
    "num_train_envs": 8,
    "num_steps": 8,
    "num_minibatches": 2,
    "update_epochs": 2,
    "total_timesteps": 1000,
    "observation_type": "symbolic_flat",
    "physics": "jax2d",
    "level_mode": "list",
    "levels": ["s/first_flight"],
    "actor_depth": 1,
    "critic_depth": 1,
    "actor_width": 16,
    "critic_width": 16,
}


def _train(devices, program=_PROGRAM, /, **values):
    flags = f"{os.environ['XLA_FLAGS']} --xla_force_host_platform_device_count={devices}"
    done = subprocess.run(
        [sys.executable, "-c", program, json.dumps(_VALUES | values)],
        env=os.environ | {"XLA_FLAGS": flags, "JAX_PLATFORMS": "cpu"},
        capture_output=True,
        text=True,
        check=False,
    )
    return done


@pytest.mark.slow
def test_two_devices_learn_what_one_learns():
    one, two = (json.loads(_train(devices).stdout) for devices in (1, 2))
    assert (one["devices"], one["spread"]) == (1, 1)
    assert (two["devices"], two["spread"]) == (2, 2)
    # Each plays and learns from its own environments: nothing goes from one to the other but means.
    assert two["moved"] == 0 < two["averaged"]
    # They wait for each other a few times an update, not for each of a network's layers.
    assert two["averaged"] <= 5
    for a, b in zip(one["rows"], two["rows"], strict=True):
        assert a == pytest.approx(b, rel=1e-3, abs=1e-4, nan_ok=True)


@pytest.mark.slow
def test_minibatches_must_have_equal_shares():
    done = _train(2, num_minibatches=8)
    assert done.returncode == 1
    assert "8 parts: 2 devices need a share of each part" in done.stderr


@pytest.mark.slow
def test_environments_must_be_a_multiple_of_the_devices():
    done = _train(3)
    assert done.returncode == 1
    assert "num_train_envs = 8 must be a multiple of the 3 devices" in done.stderr


@pytest.mark.slow
def test_scoring_and_learning_are_compiled_once():
    small = {"batch_size": 8, "num_batches": 2, "rollout_steps": 4, "num_to_save": 8}
    done = _train(2, _SCORING, dummy_env=True, **small)
    assert done.stdout.split() == ["1", "1"], done.stderr


@pytest.mark.slow
def test_each_kind_of_step_of_a_replay_is_compiled_once():
    random = {"level_mode": "random", "levels": [], "dummy_env": True}
    buffer = {"level_buffer_capacity": 16, "minimum_fill_ratio": 0.5, "replay_prob": 0.7}
    done = _train(2, _REPLAYING, **random, **buffer)
    assert done.stdout.split() == ["1", "1", "1"], done.stderr


@pytest.mark.slow
def test_what_resumes_is_compiled_once():
    done = _train(2, _RESUMING, dummy_env=True)
    assert done.stdout.split() == ["True", "False", "False"], done.stderr
