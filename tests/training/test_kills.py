"""Runs that are killed again and again end as if they had been left alone."""

import json
import time

import numpy as np
import pytest

from kinetix.agents.checkpoint import steps_of_run
from kinetix.training.logging import read_metrics
from kinetix.training.settings import make_config
from tests import forks
from tests.training.silent_run import run_silently
from tests.training.tiny import TINY, same_parameters, without_time


def _to_its_end(arguments):
    process = forks.start(run_silently, arguments)
    process.join()
    assert process.exitcode == 0


@pytest.mark.slow(seconds=100)
def test_killed_at_random_moments_a_run_ends_the_same(tmp_path):
    """SIGKILL, twenty times; the metrics are those of a run that was left alone."""
    flags = [
        word
        for name, value in (TINY | {"total_timesteps": 8 * 4 * 240}).items()
        if name in make_config("ppo").__dataclass_fields__ or name.endswith(("depth", "width"))
        for word in (f"--{name.replace('_', '-')}", str(value))
    ]

    def command(out):
        return ["train", "ppo", "--dummy-env", "--out", str(out), *flags]

    _to_its_end(command(tmp_path / "whole"))
    random = np.random.default_rng(0)
    kills = {"starting": 0, "training": 0}
    saved = 0
    for attempt in range(20):
        process = forks.start(run_silently, command(tmp_path / "killed"))
        began = len(read_metrics(tmp_path / "killed"))
        # Every fifth dies while it starts and reads what is there; the others train for a while.
        if attempt % 5 == 4:
            time.sleep(float(random.uniform(0, 1.5)))
        else:
            while process.is_alive() and len(read_metrics(tmp_path / "killed")) <= began:
                time.sleep(0.01)
            time.sleep(float(random.uniform(0, 0.4)))
        assert process.is_alive(), "the run was over before it could be killed"
        process.kill()
        process.join()
        rows = len(read_metrics(tmp_path / "killed"))
        kills["training" if rows > began else "starting"] += 1
        # One checkpoint interval is two updates, and what was saved once is never lost.
        newest = max(steps_of_run(tmp_path / "killed"), default=0) // 32
        assert max(saved, rows - 2) <= newest
        saved = newest
    assert min(kills.values()) > 0
    _to_its_end(command(tmp_path / "killed"))
    whole, killed = (without_time(read_metrics(tmp_path / n)) for n in ("whole", "killed"))
    assert killed == whole
    same_parameters(tmp_path / "whole", tmp_path / "killed")
    card = json.loads((tmp_path / "killed" / "checkpoints" / "7680" / "agent.json").read_text())
    assert card["training"]["environment_steps"] == 7680
