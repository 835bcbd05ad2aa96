"""A training that is killed again and again, beside one that nobody has touched."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np

_TINY = {
    "size": "s",
    "num_train_envs": 8,
    "num_steps": 4,
    "num_minibatches": 2,
    "update_epochs": 2,
    "eval_freq": 0,
    "checkpoint_save_freq": 2,
    "observation_type": "symbolic_flat",
    "physics": "jax2d",
    "actor_depth": 1,
    "critic_depth": 1,
    "actor_width": 16,
    "critic_width": 16,
    "dummy_env": True,
    "anneal_lr": False,
}
_STEPS_AN_UPDATE = 32
_ENDLESS = 1_000_000
_TIMES = ("timing/sps", "timing/seconds")


def write(run: Path, number: int, updates: int = _ENDLESS) -> None:
    """Train, from the last checkpoint if there is one."""
    from kinetix.training.run import train
    from kinetix.training.settings import make_config

    config = make_config("ppo", values=_TINY | {"total_timesteps": updates * _STEPS_AN_UPDATE})
    train("ppo", config, run / "run")


def begun(folder: Path) -> object:
    """Another value after another update."""
    metrics = folder / "run" / "metrics.jsonl"
    return metrics.stat().st_size if metrics.exists() else 0


def read(folder: Path) -> int:
    """Return the updates of the newest checkpoint; at most one interval is lost."""
    from kinetix.agents.agent import load_agent
    from kinetix.agents.checkpoint import steps_of_run
    from kinetix.training.logging import read_metrics

    run = folder / "run"
    newest = max(steps_of_run(run), default=0) // _STEPS_AN_UPDATE
    rows = read_metrics(run)
    assert [row["timing/num_updates"] for row in rows] == list(range(1, len(rows) + 1))
    assert newest <= len(rows) <= newest + 2, (newest, len(rows))
    if newest:
        assert load_agent(run).card.training["environment_steps"] == newest * _STEPS_AN_UPDATE
    return newest


def ends_as_if_it_had_not_been_killed(folder: Path) -> None:
    """Go on to the next checkpoint, and compare with a training from the beginning."""
    updates = read(folder) + 2
    write(folder, 0, updates)
    write(folder / "whole", 0, updates)
    runs = folder / "run", folder / "whole" / "run"
    (killed, rows), (whole, expected) = (_outcome(run) for run in runs)
    assert rows == expected
    assert killed.keys() == whole.keys()
    for name, array in killed.items():
        np.testing.assert_array_equal(array, whole[name])


def _outcome(run: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the parameters and the rows of all updates; the columns agree with the rows."""
    from kinetix.agents.agent import load_agent
    from kinetix.agents.arrays import flatten
    from kinetix.training.logging import read_metrics

    rows = read_metrics(run)
    with (run / "metrics.csv").open(newline="") as file:
        assert len(list(csv.reader(file))) == len(rows) + 1
    rows = [{k: v for k, v in row.items() if k not in _TIMES} for row in rows]
    return dict(flatten(load_agent(run).params["params"])), json.loads(json.dumps(rows))
