"""Runs that are killed again and again end as if they had been left alone."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from kinetix.agents.checkpoint import steps_of_run
from kinetix.training.logging import read_metrics
from kinetix.training.settings import make_config
from tests.training.tiny import TINY, same_parameters, without_time


@pytest.mark.slow(seconds=150)
def test_killed_at_random_moments_a_run_ends_the_same(tmp_path):
    """SIGKILL, twenty times; the metrics are those of a run that was left alone."""
    flags = [
        word
        for name, value in (TINY | {"total_timesteps": 8 * 4 * 240}).items()
        if name in make_config("ppo").__dataclass_fields__ or name.endswith(("depth", "width"))
        for word in (f"--{name.replace('_', '-')}", str(value))
    ]

    def command(out):
        train_ppo = [sys.executable, "-m", "kinetix", "train", "ppo", "--dummy-env"]
        return [*train_ppo, "--out", str(out), *flags]

    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run(command(tmp_path / "whole"), check=True, **quiet)
    random = np.random.default_rng(0)
    kills = {"starting": 0, "training": 0}
    saved = 0
    for attempt in range(20):
        process = subprocess.Popen(command(tmp_path / "killed"), **quiet)
        began = len(read_metrics(tmp_path / "killed"))
        # Every fifth dies while it starts and reads what is there; the others train for a while.
        if attempt % 5 == 4:
            time.sleep(float(random.uniform(0, 3)))
        else:
            while process.poll() is None and len(read_metrics(tmp_path / "killed")) <= began:
                time.sleep(0.01)
            time.sleep(float(random.uniform(0, 0.4)))
        assert process.poll() is None, "the run was over before it could be killed"
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        rows = len(read_metrics(tmp_path / "killed"))
        kills["training" if rows > began else "starting"] += 1
        # One checkpoint interval is two updates, and what was saved once is never lost.
        newest = max(steps_of_run(tmp_path / "killed"), default=0) // 32
        assert max(saved, rows - 2) <= newest
        saved = newest
    assert min(kills.values()) > 0
    subprocess.run(command(tmp_path / "killed"), check=True, **quiet)
    whole, killed = (without_time(read_metrics(tmp_path / n)) for n in ("whole", "killed"))
    assert killed == whole
    same_parameters(tmp_path / "whole", tmp_path / "killed")
    card = json.loads((tmp_path / "killed" / "checkpoints" / "7680" / "agent.json").read_text())
    assert card["training"]["environment_steps"] == 7680
